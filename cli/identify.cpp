#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <thread>

#include "cli/command.h"
#include "cli/stages.h"
#include "model/bushing_draws.h"
#include "model/errors.h"
#include "model/folder_lock.h"
#include "model/replace_file.h"
#include "reports/fit_checks.h"
#include "reports/report.h"

namespace grouser::cli {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string rig_file;
  std::string folder = "out/identification";
  int threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
};

std::string test_line(const TestFit& test) {
  return fmt::format("{:<3} {:<28} {:>2} of {:>2} cycles  nrmse {:6.3f} %  R^2 {:.5f}", name_of(test.axis), test.name,
                     test.cycles_used, test.cycles, 100.0 * test.nrmse, test.r_squared);
}

std::string correction_line(const AppliedCorrection& correction) {
  return fmt::format("corrected {}: {}{}", correction.code, correction.test.empty() ? "" : correction.test + ": ",
                     correction.text);
}

/// The report's checks as a table: a line a quantity, a column an axis, the verdict last.
std::vector<std::string> check_lines(const nlohmann::json& checks) {
  const auto line = [](const std::string& label, const std::string& limit, const std::vector<std::string>& cells) {
    return fmt::format("{:<54} {:>12}  {}", label, limit, fmt::join(cells, " "));
  };
  const auto cell = [](const std::string& text) { return fmt::format("{:>12}", text); };
  std::vector<std::string> names, verdicts, lines;
  for (const auto& axis : checks["axes"]) {
    names.push_back(cell(axis["name"]));
    verdicts.push_back(cell(axis["pass"].get<bool>() ? "pass" : "FAIL"));
  }
  lines.push_back(line("", "limit", names));
  for (const auto& row : checks["rows"]) {
    std::vector<std::string> values;
    for (const auto& each : row["cells"]) {
      values.push_back(cell(each["text"].get<std::string>() + (each["pass"].get<bool>() ? "" : " !")));
    }
    lines.push_back(line(row["label"], row["limit"], values));
  }
  lines.push_back(line("Verdict", "", verdicts));
  return lines;
}

void add_checks(const FitRecord& fit, Result& result) {
  const nlohmann::json checks = axis_checks(fit), campaign = campaign_checks(fit);
  for (const std::string& line : check_lines(checks)) result.lines.push_back(line);
  for (const auto& check : campaign) {
    result.lines.push_back(fmt::format("{} {}: {} ({})", check["pass"].get<bool>() ? "pass" : "FAIL",
                                       check["label"].get<std::string>(), check["text"].get<std::string>(),
                                       check["limit"].get<std::string>()));
  }
  result.json["checks"] = {{"axes", checks["axes"]}, {"rows", checks["rows"]}, {"campaign", campaign}};
}

void add_outputs(const Options& options, std::size_t draws, Result& result) {
  const fs::path folder = options.folder;
  for (const char* name : {"bushing.json", "fit.json", "report.html"}) {
    result.lines.push_back((folder / name).string());
    result.json["outputs"].push_back((folder / name).string());
  }
  if (draws == 0) return;
  result.lines.push_back(fmt::format("{}: {} bushings as likely as this one", (folder / "draws").string(), draws));
  result.json["outputs"].push_back((folder / "draws").string());
}

Result run(const Options& options, Console& console) {
  const IdentifyResult identified =
      identify_into(options.rig_file, options.folder, options.threads, console.progress("identify"));
  Result result;
  for (const TestFit& test : identified.fit.tests) {
    result.lines.push_back(test_line(test));
    result.json["tests"].push_back({{"name", test.name},
                                    {"axis", name_of(test.axis)},
                                    {"cycles_used", test.cycles_used},
                                    {"nrmse", test.nrmse},
                                    {"r_squared", test.r_squared}});
  }
  result.json["warnings"] = nlohmann::ordered_json::array();
  for (const FitWarning& warning : identified.fit.warnings) {
    console.note("warning: " + (warning.test.empty() ? "" : warning.test + ": ") + warning.text);
    result.json["warnings"].push_back({{"code", warning.code}, {"test", warning.test}, {"text", warning.text}});
  }
  result.json["corrections"] = nlohmann::ordered_json::array();
  for (const AppliedCorrection& correction : identified.fit.corrections) {
    result.lines.push_back(correction_line(correction));
    result.json["corrections"].push_back(
        {{"code", correction.code}, {"test", correction.test}, {"text", correction.text}});
  }
  add_checks(identified.fit, result);
  if (identified.fit.synthetic) {
    result.lines.push_back("synthetic rig data: " + identified.fit.synthetic_note);
    result.json["synthetic"] = identified.fit.synthetic_note;
  }
  add_outputs(options, identified.draws.size(), result);
  return result;
}

}  // namespace

IdentifyResult identify_into(const fs::path& rig_file, const fs::path& folder, int threads, const Progress& progress) {
  RigRecord rig = read_rig(rig_file);
  rig.provenance.command = "grouser identify " + rig_file.string() + " -o " + folder.string();
  if (fs::exists(folder) && !fs::is_directory(folder)) {
    throw FileError(folder.string() + ": expected a folder for the output, found a file");
  }
  // Before the long work: a folder that cannot be made should not cost a fit.
  const bool made = fs::create_directories(folder);
  const FolderLock lock(folder, "identification");
  std::vector<fs::path> read{rig_file};
  for (const RigTest& test : rig.tests) read.push_back(rig_file.parent_path() / test.file);
  require_apart({folder / "bushing.json", folder / "fit.json", folder / "report.html", folder / "report.json"}, read);
  require_only_draws(folder / "draws");
  require_place_of_report(folder / "report.html");
  IdentifyResult result;
  try {
    result = identify(rig, {.threads = threads}, progress);
  } catch (...) {
    std::error_code ignored;
    if (made) fs::remove(folder, ignored);  // still empty
    throw;
  }
  BushingDraws draws(result.draws, folder / "draws");
  write_bushing(result.bushing, folder / "bushing.json");
  write_fit(result.fit, folder / "fit.json");
  draws.publish();
  write_report({folder}, folder / "report.html");
  return result;
}

Command add_identify(CLI::App& root) {
  CLI::App* app =
      root.add_subcommand("identify", "Rig measurements become a bushing: RIG.json -> bushing.json, fit.json, draws/");
  const auto options = std::make_shared<Options>();
  app->add_option("RIG.json", options->rig_file, "The campaign: grouser.rig/1 and the CSV files that it names")
      ->required();
  app->add_option("-o,--output", options->folder, "Folder of bushing.json, fit.json, draws/ and report.html")
      ->type_name("DIR")
      ->capture_default_str();
  app->add_option("--threads", options->threads, "Threads; the result is the same for any number")
      ->check(CLI::PositiveNumber)
      ->type_name("N");
  return {app, [options](Console& console) { return run(*options, console); }};
}

}  // namespace grouser::cli
