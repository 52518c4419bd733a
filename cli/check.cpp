#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/stages.h"
#include "model/check.h"
#include "model/errors.h"
#include "model/run.h"

namespace grouser::cli {
namespace {

namespace fs = std::filesystem;

/// "ok" and what was read; throws otherwise.
std::string check(const fs::path& file) {
  if (file.extension() == ".csv" && fs::exists(file)) {
    throw InputError(InputFinding{file.string(), "", "a JSON file or a run folder", "a CSV file",
                                  "CSV files are checked through the rig.json that names them"});
  }
  if (!fs::is_directory(file)) return check_file(file);
  const RunFolder run = open_run_folder(file);
  return fmt::format("ok: run folder of {}, {} channels", run.summary.name, run.channels.datasets().size());
}

/// Every file is checked, whatever the ones before it hold; the worst exit code stands.
Result run(const std::vector<std::string>& files, Console& console) {
  Result all;
  for (const std::string& file : files) {
    Result one = guard(console, [&] {
      Result right;
      right.json["content"] = check(file);
      right.lines.push_back(file + ": " + right.json["content"].get<std::string>());
      return right;
    });
    nlohmann::ordered_json entry{{"file", file}, {"ok", one.code == ExitCode::done}};
    entry.update(one.json);
    all.json["files"].push_back(entry);
    all.lines.insert(all.lines.end(), one.lines.begin(), one.lines.end());
    all.code = std::max(all.code, one.code);
    if (interrupted()) {
      all.code = ExitCode::interrupted;
      break;
    }
  }
  return all;
}

}  // namespace

Command add_check(CLI::App& root) {
  CLI::App* app = root.add_subcommand("check", "Read any input file; print ok, or every error with its place");
  const auto files = std::make_shared<std::vector<std::string>>();
  app->add_option("FILE", *files, "rig, bushing, fit, vehicle, scenario or run file (JSON), or a run folder")
      ->required();
  app->footer("A rig or scenario file is checked together with the files that it names.");
  return {app, [files](Console& console) { return run(*files, console); }};
}

}  // namespace grouser::cli
