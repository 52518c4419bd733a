#include "reports/report.h"

#include <memory>

#include "cli/command.h"

namespace grouser::cli {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::vector<std::string> folders;
  std::string file;
};

Result run(const Options& options) {
  const fs::path file =
      options.file.empty() ? fs::path(options.folders.front()) / "report.html" : fs::path(options.file);
  if (!options.file.empty() && file.has_parent_path()) fs::create_directories(file.parent_path());
  write_report({options.folders.begin(), options.folders.end()}, file);
  Result result;
  for (const fs::path& made : {file, fs::path(file).replace_extension(".json")}) {
    result.lines.push_back(made.string());
    result.json["outputs"].push_back(made.string());
  }
  return result;
}

}  // namespace

Command add_report(CLI::App& root) {
  CLI::App* app =
      root.add_subcommand("report", "One self-contained HTML file over fits and runs; several runs are compared");
  const auto options = std::make_shared<Options>();
  app->add_option("DIR", options->folders, "Fit folders and run folders, in any mix")->required();
  app->add_option("-o,--output", options->file,
                  "Report, with the same numbers in a .json beside it [report.html in the first DIR]")
      ->type_name("FILE.html");
  return {app, [options](Console&) { return run(*options); }};
}

}  // namespace grouser::cli
