#include "render/render.h"

#include <fmt/format.h>

#include <charconv>
#include <memory>

#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/stages.h"
#include "cli/usage.h"
#include "model/errors.h"

namespace grouser::cli {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string run_folder;
  std::string folder;
  std::string film = "film.mp4";
  bool frames = false;
  std::vector<double> stills;
  std::string size = "1280x720";
  RenderOptions render;
};

/// WIDTHxHEIGHT; both even, because the film's chroma has half the resolution. An empty text is agreement.
std::string read_size(const std::string& text, int& width, int& height) {
  const char* end = text.data() + text.size();
  const auto [cross, bad_width] = std::from_chars(text.data(), end, width);
  if (bad_width == std::errc() && cross != end && *cross == 'x') {
    const auto [rest, bad_height] = std::from_chars(cross + 1, end, height);
    const auto fits = [](int size) { return size >= 16 && size <= 8192 && size % 2 == 0; };
    if (bad_height == std::errc() && rest == end && fits(width) && fits(height)) return "";
  }
  return "expected WIDTHxHEIGHT, even numbers from 16 to 8192, found " + text;
}

/// A relative FILE stands in the -o folder when one was asked for, else where any path of a command line does.
fs::path film_file(const Options& options, bool film_named) {
  if (!film_named) return fs::path(options.folder.empty() ? options.run_folder : options.folder) / options.film;
  return fs::path(options.folder) / options.film;
}

/// Throws InputError for a time that the run does not have.
void check_times(const RunFolder& run, const std::vector<double>& times) {
  const std::vector<double> sampled = run.channels.read("/time").values;
  const double end = sampled.empty() ? 0.0 : sampled.back();
  std::vector<InputFinding> findings;
  for (const double time : times) {
    if (time >= 0.0 && time <= end) continue;
    findings.push_back({"--still", "", fmt::format("0 to {:g} s", end), fmt::format("{:g}", time), ""});
  }
  if (!findings.empty()) throw InputError(findings);
}

Result run(const Options& options, bool film_named, Console& console) {
  const RunFolder opened = open_run_folder(options.run_folder);
  check_times(opened, options.stills);
  const fs::path folder = options.folder.empty() ? options.run_folder : options.folder;
  fs::create_directories(folder);
  Result result;
  const auto made = [&result](const fs::path& file) {
    result.lines.push_back(file.string());
    result.json["outputs"].push_back(file.string());
  };
  if (!options.stills.empty()) {
    for (const double time : options.stills) made(still_into(opened, time, options.render, folder));
  } else if (options.frames) {
    const int count = render_frames(opened, folder, options.render, console.progress("render"));
    for (int i = 0; i < count; ++i)
      result.json["outputs"].push_back((folder / fmt::format("frame_{:06}.png", i)).string());
    result.lines.push_back(fmt::format("{} frames in {}", count, folder.string()));
    result.json["frames"] = count;
  } else {
    const fs::path file = film_file(options, film_named);
    if (file.has_parent_path()) fs::create_directories(file.parent_path());
    result.json["frames"] = render_film(opened, file, options.render, console.progress("render"));
    if (!interrupted()) made(file);
  }
  if (interrupted()) result.code = ExitCode::interrupted;
  return result;
}

}  // namespace

fs::path still_into(const RunFolder& run, double time, const RenderOptions& options, const fs::path& folder) {
  const fs::path file = folder / fmt::format("still_{:.3f}s.png", time);
  write_png(render_still(run, time, options), file);
  return file;
}

Command add_render(CLI::App& root) {
  CLI::App* app = root.add_subcommand("render", "Pictures of a run: a film, its frames, or stills");
  const auto options = std::make_shared<Options>();
  app->add_option("RUN_DIR", options->run_folder, "Folder that `grouser simulate` wrote")->required();
  app->add_option("-o,--output", options->folder, "Folder of the pictures [RUN_DIR]")->type_name("DIR");
  CLI::Option* film = app->add_option("--film", options->film,
                                      "Film to write; this is also what happens without --film, "
                                      "--frames and --still, into the output folder")
                          ->type_name("FILE.mp4")
                          ->check(ending_in(".mp4"))
                          ->capture_default_str();
  CLI::Option* frames = app->add_flag("--frames", options->frames, "Numbered pictures: frame_000000.png and so on");
  CLI::Option* still = app->add_option("--still", options->stills, "Picture at time T [s] of the run; may be repeated")
                           ->type_name("T")
                           ->allow_extra_args(false);
  film->excludes(frames)->excludes(still);
  frames->excludes(still);
  app->add_option("--size", options->size, "Pixels")
      ->type_name("WIDTHxHEIGHT")
      ->capture_default_str()
      ->check(CLI::Validator(
          [options](std::string& text) { return read_size(text, options->render.width, options->render.height); }, ""));
  app->add_option("--fps", options->render.fps, "Pictures a second of the run")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app->add_option("--camera", options->render.camera, "Where to look from")
      ->check(CLI::IsMember(camera_names()))
      ->capture_default_str();
  return {app, [options, film](Console& console) { return run(*options, film->count() > 0, console); }};
}

}  // namespace grouser::cli
