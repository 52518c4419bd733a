#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "cli/result.h"
#include "identification/identify.h"
#include "model/replay.h"
#include "model/run.h"
#include "render/render.h"

/// The stages of the pipeline with their files; one subcommand each, and `demo` runs them all.
namespace grouser::cli {

/// rig.json -> folder/bushing.json, fit.json, report.html, report.json.
[[nodiscard]] IdentifyResult identify_into(const std::filesystem::path& rig_file, const std::filesystem::path& folder,
                                           int threads, const Progress& progress);

/// rig.json and bushing.json -> folder/rig.json with its CSV files, replay.json, report.html, report.json.
ReplayRecord rig_into(const std::filesystem::path& rig_file, const std::filesystem::path& bushing_file,
                      const std::filesystem::path& folder, const Progress& progress);

/// What `grouser simulate` was asked to drive.
struct SimulateRequest {
  std::string scenario_file;
  std::string vehicle_file, bushing_file;  ///< empty = as the scenario says
  std::vector<std::string> set;            ///< "path=value"
  std::string folder;                      ///< of the run; empty = named after the scenario
};
/// Reads the scenario with its replacements; its provenance holds the command that repeats the run.
[[nodiscard]] Scenario read_request(const SimulateRequest& request);
[[nodiscard]] ExitCode exit_code(RunStatus status);

/// open_run, with what is missing named: throws FileError for a folder without run.json or run.h5.
[[nodiscard]] RunFolder open_run_folder(const std::filesystem::path& folder);

/// folder/still_<time>s.png. Returns the file.
[[nodiscard]] std::filesystem::path still_into(const RunFolder& run, double time, const RenderOptions& options,
                                               const std::filesystem::path& folder);

/// Throws FileError where a link stands in the place of a result's folder, or another's file in that of its report:
/// before the work, of the results that demo makes at names of its own.
void require_own_result(const std::filesystem::path& folder);

/// What `demo --study` knows.
[[nodiscard]] std::vector<std::string> study_names();
/// Runs of one scenario that differ in what the study varies, side by side in processes of their own:
/// folder/NAME/<case>/ with run and report, folder/NAME/report.html over all of them, and folder/index.html anew.
[[nodiscard]] Result run_study(const std::string& name, const std::filesystem::path& data,
                               const std::filesystem::path& folder, Console& console);

/// One line on a run: what came out, with what a user must know of it; why it did not complete is the error's to say.
[[nodiscard]] std::string headline(const RunSummary& summary);
/// And one on what the machine took for it.
[[nodiscard]] std::string speed(const RunSummary& summary);

}  // namespace grouser::cli
