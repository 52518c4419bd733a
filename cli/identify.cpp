#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <thread>

#include "cli/command.h"
#include "cli/stages.h"
#include "model/errors.h"
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
  if (identified.fit.synthetic) {
    result.lines.push_back("synthetic rig data: " + identified.fit.synthetic_note);
    result.json["synthetic"] = identified.fit.synthetic_note;
  }
  for (const char* name : {"bushing.json", "fit.json", "report.html"}) {
    const std::string file = (fs::path(options.folder) / name).string();
    result.lines.push_back(file);
    result.json["outputs"].push_back(file);
  }
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
  IdentifyResult result;
  try {
    result = identify(rig, {.threads = threads}, progress);
  } catch (...) {
    std::error_code ignored;
    if (made) fs::remove(folder, ignored);  // still empty
    throw;
  }
  write_bushing(result.bushing, folder / "bushing.json");
  write_fit(result.fit, folder / "fit.json");
  write_report({folder}, folder / "report.html");
  return result;
}

Command add_identify(CLI::App& root) {
  CLI::App* app =
      root.add_subcommand("identify", "Rig measurements become a bushing: RIG.json -> bushing.json, fit.json");
  const auto options = std::make_shared<Options>();
  app->add_option("RIG.json", options->rig_file, "The campaign: grouser.rig/1 and the CSV files that it names")
      ->required();
  app->add_option("-o,--output", options->folder, "Folder of bushing.json, fit.json and report.html")
      ->type_name("DIR")
      ->capture_default_str();
  app->add_option("--threads", options->threads, "Threads; the result is the same for any number")
      ->check(CLI::PositiveNumber)
      ->type_name("N");
  return {app, [options](Console& console) { return run(*options, console); }};
}

}  // namespace grouser::cli
