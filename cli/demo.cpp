#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>

#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/processes.h"
#include "cli/stages.h"
#include "cli/usage.h"
#include "model/replace_file.h"
#include "reports/report.h"
#include "simulator/simulate.h"

namespace grouser::cli {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string folder = "out/demo";
  std::string data = GROUSER_TEST_DATA;
  std::string study;  ///< empty: the pipeline
};

/// A picture of the report: where the run stands (fraction of its time) and from where it is seen.
struct StillPlan {
  double fraction;
  const char* camera;
};
constexpr StillPlan k_stills[] = {{0.0, "side"}, {0.65, "chase"}, {0.7, "sprocket"}};

/// film.mp4, stills and report of a run folder.
ExitCode show(const fs::path& folder, const Progress& progress) {
  const RunFolder run = open_run(folder);
  static_cast<void>(render_film(run, folder / "film.mp4", {}, part_of(progress, 0.0, 0.95)));
  if (interrupted()) return ExitCode::interrupted;
  for (const StillPlan& still : k_stills) {
    RenderOptions options;
    options.camera = still.camera;
    static_cast<void>(still_into(run, still.fraction * run.summary.simulated_time, options, folder));
  }
  write_report({folder}, folder / "report.html");
  return ExitCode::done;
}

/// The stages one after the other; the jobs of a stage side by side, so that no run is timed while the other one is
/// filmed.
ExitCode make_parts(const fs::path& data, const fs::path& folder, Console& console, const Progress& progress) {
  const fs::path fitted = folder / "identification";
  std::vector<Job> identify, drive, film;
  identify.push_back(guarded(1.0, console, [&](const Progress& tell) {
    const fs::path rig = data / "rig" / "reference" / "rig.json";
    static_cast<void>(identify_into(rig, fitted, 2, part_of(tell, 0.0, 0.9)));
    rig_into(rig, fitted / "bushing.json", folder / "virtual_rig", part_of(tell, 0.9, 1.0));
    return ExitCode::done;
  }));
  for (const auto& [name, weight] : {std::pair{"run_a", 17.0}, std::pair{"run_b", 6.0}}) {  // seconds of run and film
    SimulateRequest request;
    request.scenario_file = (data / "scenarios" / (std::string(name) + ".json")).string();
    request.folder = (folder / name).string();
    request.bushing_file = (fitted / "bushing.json").string();
    const fs::path run = folder / name;
    drive.push_back(guarded(weight, console, [request, run, &console](const Progress& tell) {
      const RunSummary summary = simulate(read_request(request), run, tell);
      if (summary.status == RunStatus::failed) console.error(run.string() + ": " + summary.message);
      return exit_code(summary.status);
    }));
    film.push_back(guarded(weight, console, [run](const Progress& tell) { return show(run, tell); }));
  }
  constexpr double k_identified = 0.02, k_driven = 0.12, k_filmed = 0.97;  // shares of the wall time, measured
  ExitCode code = run_in_processes(identify, part_of(progress, 0.0, k_identified));
  if (code == ExitCode::done) code = run_in_processes(drive, part_of(progress, k_identified, k_driven));
  // A run that failed is shown too: the film says how.
  if (code == ExitCode::done || code == ExitCode::numerical_failure) {
    const ExitCode shown = run_in_processes(film, part_of(progress, k_driven, k_filmed));
    if (code == ExitCode::done) code = shown;
  }
  return code;
}

Result run(const Options& options, Console& console) {
  const fs::path folder = options.folder;
  // Relative where it can be: provenance should not name the machine's folders.
  const fs::path data = fs::proximate(options.data);
  fs::create_directories(folder);
  require_place_of_report(folder / "report.html");
  for (const char* name : {"identification", "virtual_rig", "run_a", "run_b"}) require_own_result(folder / name);
  Result result;
  {
    const Progress progress = console.progress("demo");
    result.code = make_parts(data, folder, console, progress);
    if (result.code == ExitCode::interrupted) {
      result.left = "on the way: what was computed stands in " + folder.string();
      return result;
    }
    const bool both_ran = fs::exists(folder / "run_a" / "run.json") && fs::exists(folder / "run_b" / "run.json");
    if (result.code == ExitCode::done || (result.code == ExitCode::numerical_failure && both_ran)) {
      write_report({folder / "identification", folder / "run_a", folder / "run_b"}, folder / "report.html");
      write_index(folder);
      static_cast<void>(progress({1.0, "index"}));
    }
  }
  for (const char* name : {"run_a", "run_b"}) {
    const fs::path summary = folder / name / "run.json";
    if (!fs::exists(summary)) continue;
    const RunSummary run = read_run_summary(summary);
    result.lines.insert(result.lines.end(), {headline(run), speed(run)});
  }
  if (fs::exists(folder / "index.html")) {
    result.lines.push_back((folder / "index.html").string());
    result.json["outputs"] = {(folder / "index.html").string(), (folder / "report.json").string()};
  }
  return result;
}

}  // namespace

void require_own_result(const fs::path& folder) {
  require_own(folder);
  require_place_of_report(folder / "report.html");
}

Command add_demo(CLI::App& root) {
  CLI::App* app =
      root.add_subcommand("demo", "The whole pipeline on the synthetic reference data; ends with an index.html");
  const auto options = std::make_shared<Options>();
  app->add_option("-o,--output", options->folder, "Folder of index.html, identification, virtual_rig, run_a and run_b")
      ->type_name("DIR")
      ->capture_default_str();
  app->add_option("--data", options->data, "Folder with rig, vehicles and scenarios [test_data of the sources]")
      ->type_name("DIR");
  app->add_option(
         "--study", options->study,
         fmt::format("Instead of the pipeline: run A with every stiffness of the bushings, or with single and double "
                     "pins, compared in DIR/NAME/report.html: {}",
                     fmt::join(study_names(), ", ")))
      ->check(one_of(study_names()))
      ->type_name("NAME");
  return {app, [options](Console& console) {
            return options->study.empty() ? run(*options, console)
                                          : run_study(options->study, options->data, options->folder, console);
          }};
}

}  // namespace grouser::cli
