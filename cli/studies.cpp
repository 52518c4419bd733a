#include <algorithm>

#include "cli/processes.h"
#include "cli/stages.h"
#include "reports/report.h"
#include "simulator/simulate.h"

namespace grouser::cli {
namespace {

namespace fs = std::filesystem;

/// One run of a study: its folder, its scenario in the data folder, and what it replaces there.
struct Case {
  std::string name, scenario;
  std::vector<std::string> set;
  double weight;  ///< share of the work, measured
};

struct Study {
  std::string name;
  std::vector<Case> cases;
};

std::vector<Study> studies() {
  Study stiffness{"stiffness", {}};
  for (const auto& [factor, weight] : {std::pair{"0.25", 1.0}, {"0.5", 1.0}, {"1", 1.05}, {"2", 1.15}, {"4", 1.35}})
    stiffness.cases.push_back(
        {std::string("x") + factor, "run_a.json", {std::string("bushing_scale=") + factor}, weight});
  const Study connection{"connection",
                         {{"single_pin", "run_a.json", {}, 1.0}, {"double_pin", "run_a_double_pin.json", {}, 3.4}}};
  return {stiffness, connection};
}

Study study_called(const std::string& name) {
  const std::vector<Study> all = studies();
  return *std::ranges::find(all, name, &Study::name);
}

SimulateRequest request_of(const Case& each, const fs::path& data, const fs::path& folder) {
  SimulateRequest request;
  request.scenario_file = (data / "scenarios" / each.scenario).string();
  request.folder = (folder / each.name).string();
  request.set = each.set;
  return request;
}

/// A run and its own report. A run that failed is reported too: the comparison shows how.
ExitCode drive(const SimulateRequest& request, Console& console, const Progress& tell) {
  const RunSummary summary = simulate(read_request(request), request.folder, part_of(tell, 0.0, 0.9));
  if (summary.status == RunStatus::failed) console.error(request.folder + ": " + summary.message);
  if (summary.status != RunStatus::stopped) write_report({request.folder}, fs::path(request.folder) / "report.html");
  return exit_code(summary.status);
}

}  // namespace

std::vector<std::string> study_names() {
  std::vector<std::string> names;
  for (const Study& study : studies()) names.push_back(study.name);
  return names;
}

Result run_study(const std::string& name, const fs::path& given_data, const fs::path& folder, Console& console) {
  const Study study = study_called(name);
  const fs::path data = fs::proximate(given_data), own = folder / name;
  fs::create_directories(own);
  require_own_result(own);
  for (const Case& each : study.cases) require_own_result(own / each.name);
  Result result;
  std::vector<Job> jobs;
  std::vector<fs::path> runs;
  for (const Case& each : study.cases) {
    const SimulateRequest request = request_of(each, data, own);
    runs.emplace_back(request.folder);
    jobs.push_back(guarded(each.weight, console,
                           [request, &console](const Progress& tell) { return drive(request, console, tell); }));
  }
  const Progress progress = console.progress("study of " + name);
  result.code = run_in_processes(jobs, part_of(progress, 0.0, 0.97));
  if (result.code == ExitCode::interrupted) result.left = "on the way: what was computed stands in " + own.string();
  const bool all_ran = std::ranges::all_of(runs, [](const fs::path& run) { return fs::exists(run / "report.json"); });
  if (result.code != ExitCode::done && (result.code != ExitCode::numerical_failure || !all_ran)) return result;
  write_report(runs, own / "report.html");
  write_index(folder);
  static_cast<void>(progress({1.0, "index"}));
  for (const fs::path& run : runs)
    result.lines.push_back(run.filename().string() + ": " + headline(read_run_summary(run / "run.json")));
  for (const fs::path& made : {own / "report.html", folder / "index.html"}) {
    result.lines.push_back(made.string());
    result.json["outputs"].push_back(made.string());
  }
  return result;
}

}  // namespace grouser::cli
