#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <memory>

#include "cli/command.h"
#include "cli/stages.h"
#include "model/run.h"

namespace grouser::cli {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string run_folder;
  std::string format = "csv";
  std::string folder;
};

std::string last_part(const std::string& path) { return path.substr(path.rfind('/') + 1); }
std::string group_of(const std::string& path) { return path.substr(0, path.rfind('/')); }
/// Datasets of words end so: /joints/names, /steps/limit_names.
bool holds_names(const std::string& path) { return path.ends_with("names"); }

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

std::string joined(const std::vector<std::string>& words, const char* separator) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : separator) + word;
  return text;
}

/// "N m/rad" -> "_N_m_per_rad": the spelling of the rig's columns, so that the same reader understands it.
std::string unit_suffix(const std::string& unit) {
  if (unit.empty() || unit == "1") return "";
  return "_" + replaced(replaced(replaced(unit, "^", ""), "/", "_per_"), " ", "_");
}

/// "m, rad": the first half of the last dimension's entries in m, the second in rad.
std::vector<std::string> units_of(const std::string& unit) {
  const std::size_t comma = unit.find(", ");
  if (comma == std::string::npos) return {unit};
  return {unit.substr(0, comma), unit.substr(comma + 2)};
}

/// Names of the entries along one dimension: those that the file gives, components of vectors, else the index.
std::vector<std::string> entry_names(std::size_t count, bool last, const std::vector<std::string>& given) {
  if (count == given.size()) return given;
  if (last && count == 2) return {"left", "right"};
  if (last && count == 3) return {"x", "y", "z"};
  if (last && count == 4) return {"w", "x", "y", "z"};
  if (last && count == 6) return {"x", "y", "z", "rx", "ry", "rz"};
  std::vector<std::string> names(count);
  for (std::size_t i = 0; i < count; ++i) names[i] = std::to_string(i);
  return names;
}

/// One column name for every value of a row, in the order of storage.
std::vector<std::string> column_names(const Array& array, const std::string& path,
                                      const std::vector<std::string>& given) {
  std::vector<std::string> columns{last_part(path)};
  for (std::size_t dimension = 1; dimension < array.shape.size(); ++dimension) {
    std::vector<std::string> longer;
    for (const std::string& column : columns) {
      for (const std::string& entry : entry_names(array.shape[dimension], dimension + 1 == array.shape.size(), given)) {
        longer.push_back(column + "_" + replaced(entry, " ", "_"));
      }
    }
    columns = std::move(longer);
  }
  const std::vector<std::string> units = units_of(array.unit);
  const std::size_t entries = array.shape.size() > 1 ? array.shape.back() : 1, share = entries / units.size();
  for (std::size_t i = 0; i < columns.size(); ++i) columns[i] += unit_suffix(units[i % entries / share]);
  return columns;
}

/// The dataset `time` that belongs to a dataset: the nearest one up its groups with as many rows. Empty: it is a time,
/// or none fits.
std::string time_of(const RunReader& run, const std::string& path, std::size_t rows) {
  if (last_part(path) == "time") return "";
  for (std::string group = group_of(path);; group = group_of(group)) {
    const std::string time = group + "/time";
    if (run.has(time) && run.read(time).rows() == rows) return time;
    if (group.empty()) return "";
  }
}

/// Values that 32 bits hold were stored so: their shortest form is the one of 32 bits.
bool single_precision(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(),
                     [](double v) { return v != v || static_cast<double>(static_cast<float>(v)) == v; });
}

std::string csv_of(const RunReader& run, const std::string& path) {
  if (holds_names(path)) return "name\n" + joined(run.read_names(path), "\n") + "\n";
  const std::vector<std::string> names =
      run.has(group_of(path) + "/names") ? run.read_names(group_of(path) + "/names") : std::vector<std::string>();
  const Array array = run.read(path);
  const std::string time_path = time_of(run, path, array.rows());
  const Array time = time_path.empty() ? Array{} : run.read(time_path);
  std::string text = time_path.empty() ? "" : "time" + unit_suffix(time.unit) + ",";
  text += joined(column_names(array, path, names), ",") + "\n";
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
  fs::create_directories(folder);
  const Progress progress = console.progress("export");
  const std::vector<std::string> datasets = opened.channels.datasets();
  Result result;
  for (std::size_t i = 0; i < datasets.size(); ++i) {
    const fs::path file = folder / (replaced(datasets[i].substr(1), "/", "_") + ".csv");
    write_whole(file, csv_of(opened.channels, datasets[i]));
    result.lines.push_back(file.string());
    result.json["outputs"].push_back(file.string());
    if (!progress({static_cast<double>(i + 1) / static_cast<double>(datasets.size()), datasets[i]})) {
      result.code = ExitCode::interrupted;
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
  app->add_option("--format", options->format, "File format")->check(CLI::IsMember({"csv"}))->capture_default_str();
  app->add_option("-o,--output", options->folder, "Folder of the files [RUN_DIR/csv]")->type_name("DIR");
  app->footer(
      "Columns are name_unit, the first one is the time; tracks_left_link_position.csv holds "
      "/tracks/left/link_position.");
  return {app, [options](Console& console) { return run(*options, console); }};
}

}  // namespace grouser::cli
