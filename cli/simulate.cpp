#include "simulator/simulate.h"

#include <fmt/format.h>

#include <memory>

#include "cli/command.h"
#include "cli/stages.h"
#include "model/errors.h"

namespace grouser::cli {
namespace {

namespace fs = std::filesystem;

struct Options {
  SimulateRequest request;
  int threads = 1;
  bool resume = false;
};

/// `path=value` of --set; the parser has made sure of the sign.
std::map<std::string, std::string> replacements(const std::vector<std::string>& set) {
  std::map<std::string, std::string> replaced;
  for (const std::string& each : set) replaced[each.substr(0, each.find('='))] = each.substr(each.find('=') + 1);
  return replaced;
}

std::string kept(const fs::path& folder, const RunSummary& summary) {
  return fmt::format("at {:.4f} s of the run, which is kept: the same command with --resume goes on from {}",
                     summary.simulated_time, folder.string());
}

/// What stands in the folder from another run before this one, which did not replace it.
void tell_of_leftovers(const fs::path& folder, Console& console) {
  for (const char* name : {"film.mp4", "csv", "report.html"}) {
    if (!fs::exists(folder / name)) continue;
    console.note(fmt::format("{} is of the run that was here before; it stayed as it was", (folder / name).string()));
  }
}

Result run(const Options& options, Console& console) {
  const Scenario scenario = read_request(options.request);
  const fs::path folder = options.request.folder.empty() ? fs::path(options.request.scenario_file).stem()
                                                         : fs::path(options.request.folder);
  const Progress progress = console.progress("simulate");
  const RunSummary summary = options.resume ? resume(scenario, folder, progress) : simulate(scenario, folder, progress);

  if (!options.resume) tell_of_leftovers(folder, console);

  Result result;
  result.code = exit_code(summary.status);
  if (summary.status == RunStatus::failed) console.error(folder.string() + ": " + summary.message);
  if (summary.status == RunStatus::stopped) result.left = kept(folder, summary);
  result.lines.push_back(headline(summary));
  result.lines.push_back(speed(summary));
  result.lines.push_back(fmt::format("{} bodies, {} revolute joints, {} bushings, {} degrees of freedom",
                                     summary.counts.bodies, summary.counts.revolute_joints, summary.counts.bushings,
                                     summary.counts.degrees_of_freedom));
  for (const RunCheck& check : summary.checks) {
    result.lines.push_back(fmt::format("{} {}: {:.5g}{} ({})", check.pass ? "pass" : "FAIL", check.name, check.value,
                                       check.unit == "1" ? "" : " " + check.unit, check.limit));
  }
  for (const char* name : {"run.h5", "run.json"}) {
    result.lines.push_back((folder / name).string());
    result.json["outputs"].push_back((folder / name).string());
  }
  result.json["run"] = nlohmann::ordered_json::parse(read_whole(folder / "run.json"));
  return result;
}

}  // namespace

Scenario read_request(const SimulateRequest& request) {
  Scenario scenario =
      read_scenario(request.scenario_file, {request.vehicle_file, request.bushing_file, replacements(request.set)});
  std::string& command = scenario.provenance.command;
  command = "grouser simulate " + request.scenario_file;
  if (!request.folder.empty()) command += " -o " + request.folder;
  if (!request.vehicle_file.empty()) command += " --vehicle " + request.vehicle_file;
  if (!request.bushing_file.empty()) command += " --bushing " + request.bushing_file;
  for (const std::string& each : request.set) command += " --set " + each;
  return scenario;
}

RunFolder open_run_folder(const fs::path& folder) {
  if (!fs::exists(folder / "run.json")) throw FileError(folder.string() + ": not a run folder: run.json is missing");
  if (!fs::exists(folder / "run.h5")) throw FileError(folder.string() + ": run.h5 is missing");
  return open_run(folder);
}

ExitCode exit_code(RunStatus status) {
  switch (status) {
    case RunStatus::completed:
      return ExitCode::done;
    case RunStatus::stopped:
      return ExitCode::interrupted;
    case RunStatus::failed:
      return ExitCode::numerical_failure;
  }
  return ExitCode::numerical_failure;
}

std::string headline(const RunSummary& summary) {
  const bool completed = summary.status == RunStatus::completed;
  return fmt::format("{} {}: {}", summary.name, name_of(summary.status),
                     completed ? summary.message : fmt::format("{:.3f} s simulated", summary.simulated_time));
}

std::string speed(const RunSummary& summary) {
  const double real_time_factor = summary.simulated_time > 0.0 ? summary.wall_time / summary.simulated_time : 0.0;
  return fmt::format("took {:.3g} s, {:.3g} wall seconds a simulated second, {} steps; assembled in {:.3g} s",
                     summary.wall_time, real_time_factor, summary.steps.accepted, summary.assembly_wall_time);
}

Command add_simulate(CLI::App& root) {
  CLI::App* app = root.add_subcommand("simulate", "A vehicle drives a scenario: SCENARIO.json -> run.h5, run.json");
  const auto options = std::make_shared<Options>();
  app->add_option("SCENARIO.json", options->request.scenario_file,
                  "Vehicle, bushing, terrain, drive, output: grouser.scenario/1")
      ->required();
  app->add_option("-o,--output", options->request.folder, "Run folder [./NAME of NAME.json]")->type_name("DIR");
  app->add_option("--vehicle", options->request.vehicle_file, "Drive this vehicle instead of the scenario's")
      ->type_name("FILE");
  app->add_option("--bushing", options->request.bushing_file, "Use this bushing instead of the scenario's")
      ->type_name("FILE");
  app->add_option("--set", options->request.set, "Replace a value of the scenario, e.g. duration_s=2; may be repeated")
      ->type_name("PATH=VALUE")
      ->allow_extra_args(false)
      ->check(CLI::Validator(
          [](std::string& text) {
            return text.find('=') == std::string::npos || text.front() == '=' ? "expected path=value, found " + text
                                                                              : std::string();
          },
          "", "path=value"));
  app->add_option("--threads", options->threads,
                  "Taken as in other commands, and without effect: a run of one vehicle is stepped by one thread")
      ->check(CLI::PositiveNumber)
      ->type_name("N")
      ->capture_default_str();
  app->add_flag(
      "--resume", options->resume,
      "Go on with a run that was stopped or killed, from its last checkpoint or, before the first one, from its "
      "beginning; every channel is the same to the byte");
  app->footer("A run that fails or is interrupted keeps what it computed, with its reason in run.json.");
  return {app, [options](Console& console) { return run(*options, console); }};
}

}  // namespace grouser::cli
