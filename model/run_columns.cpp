#include "model/run_columns.h"

#include <utility>

namespace grouser {
namespace {

std::string last_part(const std::string& path) { return path.substr(path.rfind('/') + 1); }
std::string group_of(const std::string& path) { return path.substr(0, path.rfind('/')); }

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
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

}  // namespace

std::vector<RunColumn> columns_of(const RunReader& run, const std::string& dataset) {
  const std::string names_path = group_of(dataset) + "/names";
  const std::vector<std::string> given = run.has(names_path) ? run.read_names(names_path) : std::vector<std::string>();
  const Array head = run.read_rows(dataset, 0, 0);
  std::vector<RunColumn> columns{{dataset, {}, last_part(dataset), ""}};
  for (std::size_t dimension = 1; dimension < head.shape.size(); ++dimension) {
    const std::vector<std::string> entries =
        entry_names(head.shape[dimension], dimension + 1 == head.shape.size(), given);
    std::vector<RunColumn> longer;
    for (const RunColumn& column : columns) {
      for (std::size_t i = 0; i < entries.size(); ++i) {
        RunColumn& entry = longer.emplace_back(column);
        entry.index.push_back(i);
        entry.name += "_" + replaced(entries[i], " ", "_");
      }
    }
    columns = std::move(longer);
  }
  const std::vector<std::string> units = units_of(head.unit);
  const std::size_t entries = head.shape.size() > 1 ? head.shape.back() : 1, share = entries / units.size();
  for (std::size_t i = 0; i < columns.size(); ++i) columns[i].unit = units[i % entries / share];
  return columns;
}

bool holds_names(const std::string& dataset) { return dataset.ends_with("names"); }

std::string flat_name(const std::string& dataset) { return replaced(dataset.substr(1), "/", "_"); }

std::string unit_suffix(const std::string& unit) {
  if (unit.empty() || unit == "1") return "";
  return replaced(replaced(replaced(unit, "^", ""), "/", "_per_"), " ", "_");
}

std::string time_of(const RunReader& run, const std::string& dataset, std::size_t rows) {
  if (last_part(dataset) == "time") return "";
  for (std::string group = group_of(dataset);; group = group_of(group)) {
    const std::string time = group + "/time";
    if (run.has(time) && run.read(time).rows() == rows) return time;
    if (group.empty()) return "";
  }
}

}  // namespace grouser
