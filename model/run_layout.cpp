#include "model/run_layout.h"

#include <cmath>
#include <optional>

#include "model/findings.h"
#include "model/run_columns.h"

namespace grouser {
namespace {

using Shape = std::vector<std::size_t>;

std::string text_of(const Shape& shape) {
  std::string text;
  for (const std::size_t length : shape) text += (text.empty() ? "" : " x ") + std::to_string(length);
  return shape.empty() ? "rows of one value" : "rows of " + text + " values";
}

/// Vectors, quaternions, and deflections along and about three axes.
std::size_t components(const std::string& dataset) {
  if (dataset.ends_with("orientation")) return 4;
  return dataset.ends_with("bushing_deflection") ? 6 : 3;
}

/// Row of a dataset that a run of this vehicle holds; empty for datasets that nobody knows.
std::optional<Shape> expected_row(const RunFolder& run, std::size_t joints, const std::string& dataset) {
  for (const Side side : {Side::left, Side::right}) {
    const auto links = static_cast<std::size_t>(run.vehicle.side(side).track.num_links);
    const std::string name = name_of(side);
    if (dataset.starts_with("/tracks/" + name + "/")) return Shape{links, components(dataset)};
    if (dataset.starts_with("/probes/" + name + "_")) return Shape{components(dataset)};
  }
  if (dataset == "/probes/sprocket_torque" || dataset == "/probes/upper_run_tension") return Shape{k_num_sides};
  if (dataset.ends_with("/time") || dataset.starts_with("/energy/") || dataset.starts_with("/steps/")) return Shape{};
  if (dataset.starts_with("/chassis/")) return Shape{components(dataset)};
  if (dataset.starts_with("/joints/")) return Shape{joints};
  return std::nullopt;
}

void check_times(const RunReader& channels, const std::string& dataset, Findings& findings) {
  if (!channels.has(dataset)) return;
  const std::vector<double> time = channels.read(dataset).values;
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (std::isfinite(time[i]) && (i == 0 || time[i] > time[i - 1])) continue;
    findings.add(dataset, "times that rise from sample to sample", "another one at sample " + std::to_string(i + 1));
    return;
  }
}

}  // namespace

void check_layout(const RunFolder& run) {
  const RunReader& channels = run.channels;
  Findings findings((run.path / "run.h5").string());
  const bool named = channels.has("/joints/names");
  if (!named) findings.add("/joints/names", "the names of the joints", "no such dataset");
  const std::size_t joints = named ? channels.read_names("/joints/names").size() : 0;
  for (const std::string& dataset : channels.datasets()) {
    if (holds_names(dataset)) continue;
    const Shape whole = channels.read_rows(dataset, 0, 0).shape, row(whole.begin() + 1, whole.end());
    const std::optional<Shape> expected = expected_row(run, joints, dataset);
    if (expected && row != *expected) findings.add(dataset, text_of(*expected), text_of(row));
  }
  findings.throw_if_any();
  check_times(channels, "/time", findings);
  check_times(channels, "/probes/time", findings);
  findings.throw_if_any();
}

}  // namespace grouser
