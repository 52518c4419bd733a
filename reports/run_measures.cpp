#include "reports/run_measures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "model/errors.h"
#include "reports/channels.h"

namespace grouser {
namespace {

/// Rows of /time within a window.
struct RowRange {
  std::size_t first = 0, count = 0;
};

RowRange rows_within(const std::vector<double>& time, const TimeWindow& window) {
  const auto first = std::ranges::lower_bound(time, window.begin), last = std::ranges::upper_bound(time, window.end);
  return {static_cast<std::size_t>(first - time.begin()), static_cast<std::size_t>(last - first)};
}

/// The steady drive without its first third, which still rings from the change of drive; else the whole run.
TimeWindow observed(const RunFolder& run) {
  const std::optional<TimeWindow> steady = steady_window(run);
  if (!steady) return {0.0, run.summary.simulated_time};
  return {steady->begin + (steady->end - steady->begin) / 3.0, steady->end};
}

/// Spans of a track between what it is wrapped round.
enum class Span { upper, ground, sprocket_end, idler_end, none };
constexpr std::array<const char*, 4> k_span_names{"upper run", "under the wheels", "to the sprocket", "to the idler"};

/// Where a point of the track lies, told by its place p in the vehicle frame: beyond the axes of sprocket and idler it
/// is wrapped, above the line between them it belongs to the upper run, below to the span beside or under the wheels.
Span span_at(const RunningGear& gear, const Vector3d& p) {
  const Vector3d &sprocket = gear.sprocket.center, &idler = gear.idler.wheel.center;
  const auto [rear, front] = std::minmax(sprocket.x(), idler.x());
  if (p.x() < rear || p.x() > front) return Span::none;
  const double share = (p.x() - sprocket.x()) / (idler.x() - sprocket.x());
  if (p.z() > sprocket.z() + share * (idler.z() - sprocket.z())) return Span::upper;
  const auto [a, b] = std::minmax(gear.stations.front().wheel.center.x(), gear.stations.back().wheel.center.x());
  if (p.x() >= a && p.x() <= b) return Span::ground;
  return (p.x() > b) == (sprocket.x() > idler.x()) ? Span::sprocket_end : Span::idler_end;
}

struct Mean {
  double sum = 0.0;
  long count = 0;
  void add(double value) { sum += value, ++count; }
};

void add_side(const RunFolder& run, Side side, const RowRange& rows, std::array<Mean, 4>& spans) {
  const RunningGear& gear = run.vehicle.side(side);
  const std::string path = std::string("/tracks/") + name_of(side);
  const Array position = run.channels.read_rows(path + "/link_position", rows.first, rows.count);
  const Array force = run.channels.read_rows(path + "/bushing_force", rows.first, rows.count);
  const Array origin = run.channels.read_rows("/chassis/position", rows.first, rows.count);
  const Array turned = run.channels.read_rows("/chassis/orientation", rows.first, rows.count);
  const auto links = static_cast<std::size_t>(gear.track.num_links);
  for (std::size_t row = 0; row < rows.count; ++row) {
    const auto q = turned.row(row), o = origin.row(row), p = position.row(row), f = force.row(row);
    const Quaterniond to_vehicle = Quaterniond(q[0], q[1], q[2], q[3]).conjugate();
    for (std::size_t i = 0; i < links; ++i) {
      const std::size_t j = (i + 1) % links;  // the bushing lies between link i and the next
      const Vector3d middle(0.5 * (p[3 * i] + p[3 * j]), 0.5 * (p[3 * i + 1] + p[3 * j + 1]),
                            0.5 * (p[3 * i + 2] + p[3 * j + 2]));
      const Span span = span_at(gear, to_vehicle * (middle - Vector3d(o[0], o[1], o[2])));
      if (span != Span::none) spans[static_cast<std::size_t>(span)].add(f[3 * i]);
    }
  }
}

void add_spans(const RunFolder& run, const RowRange& rows, std::vector<Measure>& measures) {
  std::array<Mean, 4> spans;
  for (const Side side : {Side::left, Side::right}) {
    const std::string path = std::string("/tracks/") + name_of(side);
    if (!run.channels.has(path + "/bushing_force") || !run.channels.has(path + "/link_position")) return;
    add_side(run, side, rows, spans);
  }
  for (std::size_t s = 0; s < spans.size(); ++s)
    if (spans[s].count > 0)
      measures.push_back({"spans", k_span_names[s], "N", spans[s].sum / static_cast<double>(spans[s].count)});
}

/// The force that a share of the samples in contact stays below [N]; 0 when nothing was touched.
double contact_quantile(const RunFolder& run, const std::string& partner, double share) {
  std::vector<double> forces;
  for (const Side side : {Side::left, Side::right}) {
    const std::string path = fmt::format("/tracks/{}/contact_force/{}", name_of(side), partner);
    if (!run.channels.has(path)) continue;
    const Array all = run.channels.read(path);
    for (std::size_t i = 0; i + 2 < all.values.size(); i += 3) {
      const double force = std::hypot(all.values[i], all.values[i + 1], all.values[i + 2]);
      if (force > 0.0) forces.push_back(force);
    }
  }
  if (forces.empty()) return 0.0;
  const auto at = forces.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(forces.size() - 1));
  std::ranges::nth_element(forces, at);
  return *at;
}

void add_contacts(const RunFolder& run, std::vector<Measure>& measures) {
  constexpr double k_share = 0.999;
  constexpr std::array<std::pair<const char*, const char*>, 6> k_partners{{{"road_wheel", "road wheels"},
                                                                           {"support_roller", "support rollers"},
                                                                           {"idler", "idler"},
                                                                           {"sprocket", "sprocket"},
                                                                           {"guide", "centre guide"},
                                                                           {"ground", "ground"}}};
  for (const auto& [dataset, name] : k_partners)
    if (const double force = contact_quantile(run, dataset, k_share); force > 0.0)
      measures.push_back({"contacts", name, "N", force});
}

void add_steps(const RunFolder& run, std::vector<Measure>& measures) {
  const RunSummary& summary = run.summary;
  measures.push_back({"step", "mean", "s", summary.steps.mean});
  measures.push_back({"step", "least", "s", summary.steps.min});
  if (summary.simulated_time > 0.0)
    measures.push_back({"cost", "force evaluations a second", "1",
                        static_cast<double>(summary.steps.force_evaluations) / summary.simulated_time});
  if (!run.channels.has("/steps/limit") || !run.channels.has("/steps/limit_names")) return;
  const std::vector<std::string> names = run.channels.read_names("/steps/limit_names");
  const std::vector<double> limits = require_column(run, "/steps/limit");
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto count = std::ranges::count(limits, static_cast<double>(k));
    if (names[k] == "end") continue;  // of the run or of a stretch of the drive: a handful of steps
    std::string name = names[k];
    std::ranges::replace(name, '_', ' ');
    measures.push_back({"limits", name, "1", static_cast<double>(count) / static_cast<double>(limits.size())});
  }
}

/// Sprocket work over the way of the chassis: in a steady drive nothing of it is stored.
void add_resistance(const RunFolder& run, const RowRange& rows, std::vector<Measure>& measures) {
  if (!run.channels.has("/energy/input") || rows.count < 2) return;
  const Array work = run.channels.read_rows("/energy/input", rows.first, rows.count);
  const Array place = run.channels.read_rows("/chassis/position", rows.first, rows.count);
  double way = 0.0;
  for (std::size_t row = 1; row < rows.count; ++row)
    way += std::hypot(place.row(row)[0] - place.row(row - 1)[0], place.row(row)[1] - place.row(row - 1)[1]);
  constexpr double k_way = 1.0;  // m; of a turn on the spot there is none to speak of
  if (way > k_way)
    measures.push_back({"resistance", "rolling resistance", "N", (work.values.back() - work.values.front()) / way});
}

void add_height(const RunFolder& run, const RowRange& rows, std::vector<Measure>& measures) {
  const auto rest = std::ranges::find(run.summary.results, "ride_height_change_m", &RunResult::name);
  if (rest != run.summary.results.end()) measures.push_back({"height", "at rest", "m", rest->value});
  if (run.scenario.terrain.level()) {
    const Array place = run.channels.read_rows("/chassis/position", rows.first, rows.count);
    Mean height;
    for (std::size_t row = 0; row < rows.count; ++row) height.add(place.row(row)[2]);
    if (height.count > 0)
      measures.push_back({"height", "driving", "m", height.sum / static_cast<double>(height.count)});
  }
}

/// Measures that stand in run.json already.
void add_results(const RunSummary& summary, std::vector<Measure>& measures) {
  struct Known {
    const char* result;
    const char* group;
    const char* name;
  };
  constexpr std::array<Known, 10> k_known{{{"largest_tension_N", "tension", "largest"},
                                           {"least_tension_N", "tension", "least"},
                                           {"link_passing_torque_N_m", "torque", "torque at link passing"},
                                           {"bushing_torsion_largest_rad", "twist", "largest"},
                                           {"bushing_torsion_rms_rad", "twist", "rms"},
                                           {"bushing_torsion_moment_largest_N_m", "moment", "largest"},
                                           {"bushing_torsion_moment_rms_N_m", "moment", "rms"},
                                           {"bushing_x_largest_over_identified", "rubber", "x, along the track"},
                                           {"bushing_z_largest_over_identified", "rubber", "z, normal to the link"},
                                           {"bushing_ry_largest_over_identified", "rubber", "ry, hinge"}}};
  for (const Known& known : k_known) {
    const auto result = std::ranges::find(summary.results, known.result, &RunResult::name);
    if (result != summary.results.end()) measures.push_back({known.group, known.name, result->unit, result->value});
  }
}

}  // namespace

const std::vector<MeasureGroup>& measure_groups() {
  static const std::vector<MeasureGroup> groups{
      {"spans", "Mean tension of the spans", "Tension [kN]", 1e-3, false},
      {"tension", "Tension in any bushing", "Tension [kN]", 1e-3, false},
      {"torque", "Sprocket torque at link passing", "Amplitude [kN m]", 1e-3, false},
      {"contacts", "Contact peaks, 99.9 % of samples", "|F| [kN]", 1e-3, false},
      {"step", "Step size", "Step [ms]", 1e3, false},
      {"limits", "What bounded the step", "Share of steps [%]", 100.0, false},
      {"cost", "Cost of a simulated second", "Force evaluations [1000]", 1e-3, false},
      {"resistance", "Rolling resistance", "Force [kN]", 1e-3, false},
      {"residual", "Energy residual over ∫|P| dt", "Fraction [1e-6]", 1e6, false},
      {"height", "Ride height against design", "Height [mm]", 1e3, false},
      {"twist", "Twist of one bushing", "Angle [deg]", 180.0 / k_pi, false},
      {"moment", "Hinge moment of one bushing", "Moment [N m]", 1.0, false},
      {"rubber", "Deflection over what was identified", "Ratio [1]", 1.0, true}};
  return groups;
}

std::vector<Measure> run_measures(const RunFolder& run) {
  const RowRange rows = rows_within(require_column(run, "/time"), observed(run));
  std::vector<Measure> measures;
  add_spans(run, rows, measures);
  add_results(run.summary, measures);
  add_contacts(run, measures);
  add_steps(run, measures);
  add_resistance(run, rows, measures);
  measures.push_back({"residual", "energy residual", "1", run.summary.energy.residual_fraction});
  add_height(run, rows, measures);
  return measures;
}

}  // namespace grouser
