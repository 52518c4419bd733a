#include "simulator/simulate.h"

#include <fmt/format.h>

#include "model/errors.h"
#include "model/folder_lock.h"
#include "model/replace_file.h"
#include "simulator/run_loop.h"

namespace grouser {
namespace {

RunSummary start_summary(const System& system) {
  RunSummary summary;
  const Scenario& scenario = system.scenario;
  summary.name = scenario.name;
  summary.vehicle_name = scenario.vehicle.name;
  summary.bushing_name = scenario.bushing.name;
  summary.provenance = scenario.provenance;
  summary.counts.bodies = system.num_bodies();
  summary.counts.revolute_joints = system.num_revolute_joints();
  summary.counts.bushings = system.num_bushings();
  summary.counts.degrees_of_freedom = system.num_degrees_of_freedom();
  summary.counts.prescribed = system.num_prescribed();
  return summary;
}

/// Should this run be killed, its channels stand beside a summary that says so, not beside that of an earlier run.
void mark_as_running(RunSummary& summary, const std::filesystem::path& folder) {
  summary.status = RunStatus::stopped;
  summary.message = "still running, or killed";
  write_run_summary(summary, folder / "run.json");
}

RunSummary go(RunLoop& run, RunSummary& summary, const std::filesystem::path& folder, const Progress& progress) {
  summary.status = run.go(progress, summary);
  run.finish(summary);
  write_run_summary(summary, folder / "run.json");
  return summary;
}

/// A run that came to its end, well or not, would come to the same end again.
void refuse_ended(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "run.json";
  if (!std::filesystem::exists(file)) return;
  const RunSummary earlier = read_run_summary(file);
  if (earlier.status == RunStatus::stopped) return;
  throw InputError(InputFinding{file.string(), "/status", "a run that was stopped or killed",
                                fmt::format("{}: {}", name_of(earlier.status), earlier.message),
                                "start the run without --resume"});
}

/// Share of the progress bar.
constexpr double k_assembly_share = 0.25;

RunStart assembled(const System& system, const Progress& progress) {
  const Stopwatch watch;
  RunStart start;
  start.assembled = assemble(system, [&](const ProgressReport& r) {
    return !progress || progress({k_assembly_share * r.fraction, r.what});
  });
  start.assembly_wall_time = watch.seconds();
  return start;
}

/// Locks the folder of a run. Throws FileError also where a link stands in the place of what the run makes there,
/// before anything of an earlier run is touched.
FolderLock locked(const std::filesystem::path& folder) {
  FolderLock lock(folder, "run");
  for (const char* name : {"run.h5.part", "run.json.part", "checkpoint.part"}) require_own_file(folder / name);
  require_own(folder / "inputs");
  return lock;
}

/// Throws where what a run from time 0 writes would replace what it was given.
void require_inputs_apart(const Scenario& scenario, const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> made{folder / "run.h5", folder / "run.json", folder / "checkpoint"};
  for (const std::string& name : input_names()) made.push_back(folder / "inputs" / name);
  require_apart(made, scenario.files);
}

/// Throws where the run could not begin, before anything of an earlier run is touched.
void require_place(const Scenario& scenario, const std::filesystem::path& folder) {
  constexpr std::uintmax_t k_least_run = 1 << 20;  // bytes, beside the longest of the inputs
  std::filesystem::create_directories(folder / "inputs");
  require_room(folder / "inputs", scenario.documents.profile.size() + k_least_run);
}

/// From time 0, in a folder that is locked. The checkpoint goes first: none without its run.
RunSummary begin_run(const System& system, const RunStart& start, const std::filesystem::path& folder,
                     const Progress& progress) {
  RunSummary summary = start_summary(system);
  require_place(system.scenario, folder);
  std::filesystem::remove(folder / "checkpoint");
  mark_as_running(summary, folder);
  write_inputs(system.scenario, folder);
  RunLoop run(system, start, folder);
  run.begin();
  return go(run, summary, folder, [&](const ProgressReport& r) {
    return !progress || progress({k_assembly_share + (1.0 - k_assembly_share) * r.fraction, r.what});
  });
}

/// A run that was killed before its first checkpoint: it begun, so there is a summary that says so.
bool only_begun(const std::filesystem::path& folder) {
  return std::filesystem::exists(folder / "run.json") && !std::filesystem::exists(folder / "checkpoint");
}

}  // namespace

RunSummary simulate(const Scenario& scenario, const std::filesystem::path& folder, const Progress& progress) {
  require_inputs_apart(scenario, folder);
  const System system = compile(scenario);
  const RunStart start = assembled(system, progress);
  std::filesystem::create_directories(folder);
  const FolderLock lock = locked(folder);
  return begin_run(system, start, folder, progress);
}

RunSummary resume(const Scenario& scenario, const std::filesystem::path& folder, const Progress& progress) {
  const FolderLock lock = locked(folder);
  refuse_ended(folder);
  if (only_begun(folder)) require_inputs_apart(scenario, folder);
  const System system = compile(scenario);
  if (only_begun(folder)) return begin_run(system, assembled(system, progress), folder, progress);
  RunSummary summary = start_summary(system);
  CheckpointReader checkpoint = read_checkpoint(folder, identity_of(scenario));
  RunStart start;
  start.assembled.state = make_state(system);
  start.kept_rows.resize(ChannelRows(system).tables().size());
  checkpoint(start);
  RunLoop run(system, start, folder);
  run.take(checkpoint);
  mark_as_running(summary, folder);
  return go(run, summary, folder, progress);
}

}  // namespace grouser
