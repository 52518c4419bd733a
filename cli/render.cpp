#include "render/render.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
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
  std::vector<std::string> run_folders;
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

std::string output_folder(const Options& options) {
  return options.folder.empty() ? options.run_folders.front() : options.folder;
}

/// A relative FILE stands in the -o folder when one was asked for, else where any path of a command line does.
fs::path film_file(const Options& options, bool film_named) {
  if (!film_named) return fs::path(output_folder(options)) / options.film;
  return fs::path(options.folder) / options.film;
}

/// Throws InputError for a time that no run has.
void check_times(const std::vector<RunFolder>& runs, const std::vector<double>& times) {
  double end = 0.0;
  for (const RunFolder& run : runs) {
    const std::vector<double> sampled = run.channels.read("/time").values;
    if (!sampled.empty()) end = std::max(end, sampled.back());
  }
  std::vector<InputFinding> findings;
  for (const double time : times) {
    if (time >= 0.0 && time <= end) continue;
    findings.push_back({"--still", "", fmt::format("0 to {} s", end), fmt::format("{}", time), ""});
  }
  if (!findings.empty()) throw InputError(findings);
}

/// Named after its millisecond, and with all its digits where another of `times` has the same.
std::string still_name(double time, const std::vector<double>& times) {
  const auto name = [](double t) { return fmt::format("still_{:.3f}s.png", t + 0.0); };  // -0 is 0
  const bool taken =
      std::ranges::any_of(times, [&](double other) { return other != time && name(other) == name(time); });
  return taken ? fmt::format("still_{}s.png", time) : name(time);
}

/// A name of camera_names(), or a file.
RenderOptions with_camera(RenderOptions render) {
  if (!render.camera.ends_with(".json")) return render;
  render.view = read_camera_view(render.camera);
  return render;
}

Result run(const Options& options, bool film_named, Console& console) {
  std::vector<RunFolder> opened;
  Runs runs;
  for (const std::string& folder : options.run_folders) opened.push_back(open_run_folder(folder));
  for (const RunFolder& each : opened) runs.push_back(&each);
  check_times(opened, options.stills);
  const RenderOptions render = with_camera(options.render);
  const fs::path folder = output_folder(options);
  fs::create_directories(folder);
  Result result;
  const auto made = [&result](const fs::path& file) {
    result.lines.push_back(file.string());
    result.json["outputs"].push_back(file.string());
  };
  if (!options.stills.empty()) {
    for (const double time : options.stills) {
      if (interrupted()) break;
      const fs::path file = folder / still_name(time, options.stills);
      write_png(render_still(runs, time, render), file);
      made(file);
    }
  } else if (options.frames) {
    const int count = render_frames(runs, folder, render, console.progress("render"));
    for (int i = 0; i < count; ++i)
      result.json["outputs"].push_back((folder / fmt::format("frame_{:06}.png", i)).string());
    result.lines.push_back(fmt::format("{} frames in {}", count, folder.string()));
    result.json["frames"] = count;
  } else {
    const fs::path file = film_file(options, film_named);
    if (file.has_parent_path()) fs::create_directories(file.parent_path());
    result.json["frames"] = render_film(runs, file, render, console.progress("render"));
    if (!interrupted()) made(file);
  }
  if (interrupted()) {
    result.code = ExitCode::interrupted;
    if (options.stills.empty()) result.left = "on the way: the same command goes on where it stopped";
  }
  return result;
}

}  // namespace

fs::path still_into(const RunFolder& run, double time, const RenderOptions& options, const fs::path& folder) {
  const fs::path file = folder / still_name(time, {});
  write_png(render_still({&run}, time, options), file);
  return file;
}

Command add_render(CLI::App& root) {
  CLI::App* app = root.add_subcommand("render", "Pictures of a run: a film, its frames, or stills");
  const auto options = std::make_shared<Options>();
  app->add_option("RUN_DIR", options->run_folders, "Folder that `grouser simulate` wrote; several stand side by side")
      ->required();
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
  app->add_option("--fps", options->render.fps, "Pictures a second of the film, 0.001 to 10000")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app->add_option("--speed", options->render.speed,
                  "Seconds of the run in a second of the film, 1e-6 to 1e6; 0.25 is slow motion")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app->add_option("--camera", options->render.camera,
                  fmt::format("Where to look from: {}, or a file grouser.camera/1", fmt::join(camera_names(), ", ")))
      ->type_name("NAME|FILE.json")
      ->check(one_of(camera_names(), ".json"))
      ->capture_default_str();
  app->add_option("--overlay", options->render.overlays,
                  fmt::format("Physics to draw over the picture, by commas: {}", fmt::join(overlay_names(), ", ")))
      ->type_name("NAME,...")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(one_of(overlay_names()));
  return {app, [options, film](Console& console) { return run(*options, film->count() > 0, console); }};
}

}  // namespace grouser::cli
