#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <memory>

#include "cli/command.h"
#include "cli/stages.h"
#include "cli/usage.h"
#include "model/replace_file.h"
#include "model/run_columns.h"

namespace grouser::cli {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string run_folder;
  std::string format = "csv";
  std::string folder;
};

std::string joined(const std::vector<std::string>& words, const char* separator) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : separator) + word;
  return text;
}

/// "velocity_x_m_per_s".
std::string heading(const std::string& name, const std::string& unit) {
  const std::string suffix = unit_suffix(unit);
  return suffix.empty() ? name : name + "_" + suffix;
}

/// Values that 32 bits hold were stored so: their shortest form is the one of 32 bits.
bool single_precision(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(),
                     [](double v) { return v != v || static_cast<double>(static_cast<float>(v)) == v; });
}

std::string csv_of(const RunReader& run, const std::string& path) {
  if (holds_names(path)) return "name\n" + joined(run.read_names(path), "\n") + "\n";
  const Array array = run.read(path);
  const std::string time_path = time_of(run, path, array.rows());
  const Array time = time_path.empty() ? Array{} : run.read(time_path);
  std::string text = time_path.empty() ? "" : heading("time", time.unit) + ",";
  std::vector<std::string> headings;
  for (const RunColumn& column : columns_of(run, path)) headings.push_back(heading(column.name, column.unit));
  text += joined(headings, ",") + "\n";
  const bool single = single_precision(array.values);
  const auto out = std::back_inserter(text);
  for (std::size_t i = 0; i < array.rows(); ++i) {
    const char* separator = "";
    if (!time_path.empty()) {
      fmt::format_to(out, "{}", time.values[i]);
      separator = ",";
    }
    for (const double value : array.row(i)) {
      single ? fmt::format_to(out, "{}{}", separator, static_cast<float>(value))
             : fmt::format_to(out, "{}{}", separator, value);
      separator = ",";
    }
    text += '\n';
  }
  return text;
}

Result run(const Options& options, Console& console) {
  const RunFolder opened = open_run_folder(options.run_folder);
  const fs::path folder = options.folder.empty() ? fs::path(options.run_folder) / "csv" : fs::path(options.folder);
  if (options.folder.empty()) require_own(folder);
  fs::create_directories(folder);
  const Progress progress = console.progress("export");
  const std::vector<std::string> datasets = opened.channels.datasets();
  Result result;
  for (std::size_t i = 0; i < datasets.size(); ++i) {
    const fs::path file = folder / (flat_name(datasets[i]) + ".csv");
    write_whole(file, csv_of(opened.channels, datasets[i]));
    result.lines.push_back(file.string());
    result.json["outputs"].push_back(file.string());
    if (!progress({static_cast<double>(i + 1) / static_cast<double>(datasets.size()), datasets[i]})) {
      result.code = ExitCode::interrupted;
      result.left = fmt::format("after {} of {} files", i + 1, datasets.size());
      break;
    }
  }
  return result;
}

}  // namespace

Command add_export(CLI::App& root) {
  CLI::App* app =
      root.add_subcommand("export", "The channels of a run for other programs: one CSV file a dataset of run.h5");
  const auto options = std::make_shared<Options>();
  app->add_option("RUN_DIR", options->run_folder, "Folder that `grouser simulate` wrote")->required();
  app->add_option("--format", options->format, "File format")->check(one_of({"csv"}))->capture_default_str();
  app->add_option("-o,--output", options->folder, "Folder of the files [RUN_DIR/csv]")->type_name("DIR");
  app->footer(
      "Columns are name_unit, the first one is the time; tracks_left_link_position.csv holds "
      "/tracks/left/link_position.");
  return {app, [options](Console& console) { return run(*options, console); }};
}

}  // namespace grouser::cli
