#include "reports/report.h"

#include <fmt/format.h>

#include <memory>

#include "cli/command.h"
#include "cli/stages.h"
#include "cli/usage.h"
#include "model/errors.h"
#include "model/replace_file.h"

namespace grouser::cli {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::vector<std::string> folders;
  std::string file;
  bool list_channels = false;
  std::string against;
  std::vector<std::string> channels;
  ReportOptions report;
};

Result list_channels(const Options& options) {
  Result result;
  for (const std::string& folder : options.folders)
    for (const ChannelEntry& entry : run_channels(folder)) {
      result.lines.push_back(fmt::format("{:<42} {:<8} {}", entry.name, entry.unit, entry.meaning));
      result.json["channels"].push_back({{"name", entry.name}, {"unit", entry.unit}, {"meaning", entry.meaning}});
    }
  return result;
}

/// Where the report goes when nobody says: a comparison with a measurement stands beside the run's own report.
fs::path report_file(const Options& options) {
  if (!options.file.empty()) return options.file;
  const std::string name =
      options.against.empty() ? "report.html" : "against_" + fs::path(options.against).stem().string() + ".html";
  return fs::path(options.folders.front()) / name;
}

/// COLUMN=CHANNEL, at the last equals sign: columns of a logger are called as they like.
std::pair<std::string, std::string> taken_apart(const std::string& assignment) {
  const std::size_t equals = assignment.rfind('=');
  return {assignment.substr(0, equals), assignment.substr(equals + 1)};
}

Result run(const Options& options, Console& console) {
  if (options.list_channels) return list_channels(options);
  const fs::path file = report_file(options);
  if (!options.file.empty() && file.has_parent_path()) fs::create_directories(file.parent_path());
  if (!options.against.empty()) require_apart({file}, {options.against});
  ReportOptions report = options.report;
  if (report.from >= report.to)
    throw InputError(
        {"--from", "", fmt::format("a time before --to, {} s", report.to), fmt::format("{} s", report.from), ""});
  report.against = options.against;
  report.progress = console.progress("report");
  for (const std::string& channel : options.channels) report.channels.push_back(taken_apart(channel));
  Result result;
  for (const ChannelVerdict& verdict : write_report({options.folders.begin(), options.folders.end()}, file, report)) {
    const std::string of = options.folders.size() > 1 ? verdict.run + ", " : "";
    result.lines.push_back(
        fmt::format("{} {}{}: {}", verdict.pass ? "pass" : "FAIL", of, verdict.channel, verdict.text));
    result.json["channels"].push_back(
        {{"run", verdict.run}, {"channel", verdict.channel}, {"pass", verdict.pass}, {"verdict", verdict.text}});
  }
  for (const fs::path& made : {file, fs::path(file).replace_extension(".json")}) {
    result.lines.push_back(made.string());
    result.json["outputs"].push_back(made.string());
  }
  return result;
}

void add_comparison_options(CLI::App& app, Options& options) {
  constexpr const char* k_group = "Comparison";
  CLI::Option* against =
      app.add_option("--against", options.against, "Measured channels that the runs are held against")
          ->type_name("FILE.csv")
          ->group(k_group);
  app.add_option("--channel", options.channels,
                 "Column of FILE.csv that measures a channel (or time); -CHANNEL where its sign is the other one; once "
                 "given, no other columns are compared")
      ->type_name("COLUMN=[-]CHANNEL")
      ->check(CLI::Validator(
          [](const std::string& text) {
            return text.find('=') == std::string::npos ? "expected COLUMN=CHANNEL, found " + text : std::string();
          },
          ""))
      ->needs(against)
      ->group(k_group);
  app.add_option("--shift", options.report.shift, "Added to the measured time [s]")
      ->type_name("SECONDS")
      ->check(finite_number())
      ->needs(against)
      ->group(k_group);
  app.add_option("--from", options.report.from, "Compare from this time of the run on [s]")
      ->type_name("SECONDS")
      ->check(finite_number())
      ->group(k_group);
  app.add_option("--to", options.report.to, "Compare up to this time of the run [s]")
      ->type_name("SECONDS")
      ->check(finite_number())
      ->group(k_group);
  app.add_option("--limit", options.report.limits,
                 "What a channel must reach, in place of the standing limit: iso=0.6, nrmse=0.2, lag_ms=20, "
                 "correlation=none")
      ->type_name("NAME=VALUE")
      ->check(CLI::Validator([](const std::string& text) { return limit_problem(text); }, ""))
      ->group(k_group);
  app.add_flag("--list-channels", options.list_channels, "Print the channels of the runs and what they are")
      ->group(k_group);
}

}  // namespace

Command add_report(CLI::App& root) {
  CLI::App* app =
      root.add_subcommand("report", "One self-contained HTML file over fits and runs; several runs are compared");
  const auto options = std::make_shared<Options>();
  app->add_option("DIR", options->folders, "Fit folders and run folders, in any mix")->required();
  app->add_option("-o,--output", options->file,
                  "Report, with the same numbers in a .json beside it [report.html in the first DIR; with --against "
                  "against_FILE.html]")
      ->type_name("FILE.html")
      ->check(ending_in(".html"));
  add_comparison_options(*app, *options);
  return {app, [options](Console& console) { return run(*options, console); }};
}

}  // namespace grouser::cli
