#include "reports/fit_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "model/geometry.h"
#include "reports/loop_points.h"
#include "reports/number_text.h"

namespace grouser {
namespace {

constexpr int k_blue = 0, k_orange = 1;                     // entries of the palette: measured, computed
constexpr int k_tile_width = 300, k_wide_tile_width = 400;  // CSS pixels of one small multiple

std::vector<double> times(std::vector<double> values, double factor) {
  for (double& value : values) value *= factor;
  return values;
}

/// Lays the panels out as small multiples of one size.
Figure multiples(const std::string& name, const std::string& title, const std::string& caption,
                 std::vector<Panel> panels, int tile_width, int tile_height, int columns) {
  Figure figure{.name = name, .title = title, .caption = caption, .panels = std::move(panels)};
  figure.columns = columns;
  const int count = static_cast<int>(figure.panels.size());
  figure.width = tile_width * columns;
  figure.height = tile_height * ((count + columns - 1) / columns);
  return figure;
}

}  // namespace

std::string force_label(Axis axis, const AxisUnits& units) {
  return (is_rotation(axis) ? "Torque [" : "Force [") + units.force + "]";
}

std::string displacement_label(Axis axis, const AxisUnits& units) {
  return (is_rotation(axis) ? "Angle [" : "Displacement [") + units.displacement + "]";
}

AxisUnits units_of(Axis axis) {
  if (is_rotation(axis)) {
    const double degree = k_pi / 180.0;
    return {.displacement = "deg",
            .force = "kN m",
            .stiffness = "kN m/rad",
            .energy = "J",
            .displacement_scale = 1.0 / degree,
            .force_scale = 1e-3,
            .stiffness_scale = 1e-3};
  }
  return {.displacement = "mm",
          .force = "kN",
          .stiffness = "kN/mm",
          .energy = "J",
          .displacement_scale = 1e3,
          .force_scale = 1e-3,
          .stiffness_scale = 1e-6};
}

std::string axis_title(Axis axis) {
  static constexpr std::array<const char*, k_num_axes> k_meanings{
      "radial, along the track", "axial, along the pin", "radial, normal to the link",
      "swing about the track",   "torsion, the hinge",   "swing about the normal"};
  return std::string(name_of(axis)) + " · " + k_meanings[static_cast<std::size_t>(index_of(axis))];
}

// ---------------------------------------------------------------------------------------------------------- each test

std::optional<Figure> figure_loops(const std::vector<const TestFit*>& tests, const std::string& law) {
  std::vector<Panel> panels;
  for (const TestFit* test : tests) {
    if (test->curve.displacement.empty()) continue;
    const AxisUnits units = units_of(test->axis);
    const std::vector<double> x = times(test->curve.displacement, units.displacement_scale);
    Panel panel{.title = test->name,
                .x_label = displacement_label(test->axis, units),
                .y_label = force_label(test->axis, units)};
    // Wide and under the thin line of the law: where the law leaves the measurement, it leaves the wide line.
    if (!test->prediction)
      panel.series.push_back({.name = "measured",
                              .x = x,
                              .y = times(test->curve.force, units.force_scale),
                              .width = 3.8f,
                              .hue = k_blue,
                              .opacity = 0.45f});
    if (!left_out(*test))
      panel.series.push_back(
          {.name = law, .x = x, .y = times(test->curve.fitted, units.force_scale), .width = 1.3f, .hue = k_orange});
    panels.push_back(std::move(panel));
  }
  if (panels.empty()) return std::nullopt;
  const bool few = panels.size() <= 2;  // and then there is room
  return multiples(std::string("loops_") + name_of(tests.front()->axis), "Every test",
                   "Measured force over displacement of the last cycle used at each amplitude, and the response of "
                   "the law over it.",
                   std::move(panels), few ? k_wide_tile_width : k_tile_width, few ? 300 : 225, few ? 2 : 3);
}

std::optional<Figure> figure_residuals(const std::vector<const TestFit*>& tests) {
  std::vector<Panel> panels;
  double largest = 0.0;
  for (const TestFit* test : tests) {
    const LoopCurve& curve = test->curve;
    if (curve.displacement.empty() || left_out(*test) || test->prediction) continue;
    const AxisUnits units = units_of(test->axis);
    const auto [low, high] = std::ranges::minmax(curve.force);
    Series residual{.name = "measured − law",
                    .x = times(curve.displacement, units.displacement_scale),
                    .width = 1.1f,
                    .hue = k_blue};
    for (std::size_t i = 0; i < curve.force.size(); ++i) {
      residual.y.push_back(high > low ? 100.0 * (curve.force[i] - curve.fitted[i]) / (high - low) : 0.0);
      largest = std::fmax(largest, std::abs(residual.y.back()));
    }
    panels.push_back({.title = test->name,
                      .x_label = displacement_label(test->axis, units),
                      .y_label = "Residual [%]",
                      .series = {std::move(residual)},
                      .zero_lines = true});
  }
  if (panels.empty()) return std::nullopt;
  const double reach = largest > 0.0 ? 1.1 * largest : 1.0;
  for (Panel& panel : panels) panel.y_range = {-reach, reach};
  return multiples(std::string("residuals_") + name_of(tests.front()->axis), "Residuals",
                   "Measured less computed force, in per cent of the force range of the test; one scale for all tests "
                   "of the axis. Noise is a haze about zero; a shape is what the law misses.",
                   std::move(panels), k_tile_width, 165, 3);
}

// ---------------------------------------------------------------------------------- over frequency and over amplitude

namespace {

/// A quantity of a cell of the campaign's grid and of a measured loop, in the units of the plot.
struct Quantity {
  std::string label;
  double scale = 1.0;
  Interval ResponsePoint::*of_law;
  double (*of_loop)(const LoopMeasures&);
};

/// The campaign's grid with what the law answers and what was measured on it.
struct Grid {
  Axis axis = Axis::x;
  std::vector<ResponsePoint> cells;
  std::vector<LoopPoint> loops;
  std::vector<double> amplitudes, frequencies;
};

/// Finds the amplitudes and frequencies of what the grid holds.
Grid with_levels(Grid grid) {
  const auto gather = [&](double ResponsePoint::*of_cell, double LoopPoint::*of_loop) {
    std::vector<double> values;
    for (const ResponsePoint& cell : grid.cells) values.push_back(cell.*of_cell);
    for (const LoopPoint& loop : grid.loops) values.push_back(loop.*of_loop);
    return levels_of(std::move(values));
  };
  grid.amplitudes = gather(&ResponsePoint::amplitude, &LoopPoint::amplitude);
  grid.frequencies = gather(&ResponsePoint::frequency, &LoopPoint::frequency);
  return grid;
}

Grid grid_of(const AxisFit& axis, const std::vector<const TestFit*>& tests) {
  Grid grid{axis.axis, axis.responses, loop_points(tests), {}, {}};
  if (grid.cells.empty())  // a fit without intervals still has the law's response to every loop
    for (const LoopPoint& loop : grid.loops) {
      const auto exact = [](double value) { return Interval{value, value, value}; };
      const LoopMeasures& law = loop.fitted;
      grid.cells.push_back({loop.amplitude, loop.frequency, exact(law.dissipated_energy), exact(stiffness_of(law)),
                            exact(law.loss_stiffness), exact(loss_factor_of(law))});
    }
  return with_levels(std::move(grid));
}

enum class Over { frequency, amplitude };

/// Whether the campaign says anything of how a quantity runs over this.
bool varies(const Grid& grid, Over over) {
  return (over == Over::frequency ? grid.frequencies : grid.amplitudes).size() > 1;
}

/// The level as it was asked of the rig: two digits.
std::string level_text(double level) { return number_text(std::stod(fmt::format("{:.1e}", level)), 2); }

std::string group_name(const Grid& grid, Over over, std::size_t group) {
  if (over == Over::frequency)
    return level_text(units_of(grid.axis).displacement_scale * grid.amplitudes[group]) + " " +
           units_of(grid.axis).displacement;
  return grid.frequencies[group] > 0.0 ? level_text(grid.frequencies[group]) + " Hz" : "rate unknown";
}

/// Places of one curve along the axis of the plot, and the cells or loops that stand there.
template <typename Item>
std::vector<std::pair<double, const Item*>> curve_of(const Grid& grid, const std::vector<Item>& items, Over over,
                                                     std::size_t group) {
  std::vector<std::pair<double, const Item*>> curve;
  for (const Item& item : items) {
    const bool by_frequency = over == Over::frequency;
    if (level_index(by_frequency ? grid.amplitudes : grid.frequencies,
                    by_frequency ? item.amplitude : item.frequency) != group)
      continue;
    const double x = by_frequency ? item.frequency : units_of(grid.axis).displacement_scale * item.amplitude;
    if (x > 0.0) curve.emplace_back(x, &item);
  }
  std::ranges::stable_sort(curve, {}, &std::pair<double, const Item*>::first);
  return curve;
}

Panel empty_panel(const Grid& grid, Over over, const std::string& y_label) {
  return {
      .title = over == Over::frequency ? "Over frequency" : "Over amplitude",
      .x_label = over == Over::frequency ? "Frequency [Hz]" : "Amplitude [" + units_of(grid.axis).displacement + "]",
      .y_label = y_label,
      .log_x = true};
}

std::size_t num_groups(const Grid& grid, Over over) {
  return (over == Over::frequency ? grid.amplitudes : grid.frequencies).size();
}

/// Line and band of the law and measured points, one colour for each value of the other quantity.
Panel quantity_panel(const Grid& grid, Over over, const Quantity& quantity) {
  Panel panel = empty_panel(grid, over, quantity.label);
  for (std::size_t group = 0; group < num_groups(grid, over); ++group) {
    const int hue = static_cast<int>(group);
    const std::string name = group_name(grid, over, group);
    Band band{.hue = hue};
    Series law{.name = name, .width = 1.5f, .hue = hue};
    for (const auto& [x, cell] : curve_of(grid, grid.cells, over, group)) {
      const Interval& interval = cell->*quantity.of_law;
      law.x.push_back(x);
      law.y.push_back(quantity.scale * interval.value);
      band.x.push_back(x);
      band.low.push_back(quantity.scale * interval.low);
      band.high.push_back(quantity.scale * interval.high);
    }
    Series measured{.style = SeriesStyle::points, .width = 2.4f, .hue = hue};
    for (const auto& [x, loop] : curve_of(grid, grid.loops, over, group)) {
      measured.x.push_back(x);
      measured.y.push_back(quantity.scale * quantity.of_loop(loop->measured));
    }
    panel.bands.push_back(std::move(band));
    panel.series.push_back(std::move(law));
    panel.series.push_back(std::move(measured));
  }
  return panel;
}

/// The measured loops' deviation from the law over amplitude in per cent, and the law's band there: of all frequencies
/// the widest, for bands of about one width would only hide one another.
Panel deviation_panel(const Grid& grid, const Quantity& quantity) {
  constexpr int k_grey = 7;
  Panel panel = empty_panel(grid, Over::amplitude, "Measured − law [%]");
  panel.zero_lines = true;
  Band band{.name = "95 % interval, widest", .hue = k_grey};
  for (std::size_t level = 0; level < grid.amplitudes.size(); ++level) {
    double low = 0.0, high = 0.0;
    for (const ResponsePoint& cell : grid.cells) {
      const Interval& interval = cell.*quantity.of_law;
      if (level_index(grid.amplitudes, cell.amplitude) != level || interval.value <= 0.0) continue;
      low = std::fmin(low, 100.0 * (interval.low / interval.value - 1.0));
      high = std::fmax(high, 100.0 * (interval.high / interval.value - 1.0));
    }
    band.x.push_back(units_of(grid.axis).displacement_scale * grid.amplitudes[level]);
    band.low.push_back(low);
    band.high.push_back(high);
  }
  panel.bands.push_back(std::move(band));
  for (std::size_t group = 0; group < num_groups(grid, Over::amplitude); ++group) {
    Series measured{.name = group_name(grid, Over::amplitude, group),
                    .style = SeriesStyle::points,
                    .width = 2.4f,
                    .hue = static_cast<int>(group)};
    for (const auto& [x, loop] : curve_of(grid, grid.loops, Over::amplitude, group)) {
      const double law = quantity.of_loop(loop->fitted);
      if (law <= 0.0) continue;
      measured.x.push_back(x);
      measured.y.push_back(100.0 * (quantity.of_loop(loop->measured) / law - 1.0));
    }
    panel.series.push_back(std::move(measured));
  }
  return panel;
}

}  // namespace

std::optional<Figure> figure_stiffness(const AxisFit& axis, const std::vector<const TestFit*>& tests) {
  const Grid grid = grid_of(axis, tests);
  const AxisUnits units = units_of(axis.axis);
  const Quantity stiffness{"Stiffness [" + units.stiffness + "]", units.stiffness_scale,
                           &ResponsePoint::storage_stiffness, stiffness_of};
  const Quantity loss{"Loss factor [1]", 1.0, &ResponsePoint::loss_factor, loss_factor_of};
  std::vector<Panel> panels;
  for (const Over over : {Over::frequency, Over::amplitude})
    if (varies(grid, over))
      for (const Quantity* quantity : {&stiffness, &loss}) panels.push_back(quantity_panel(grid, over, *quantity));
  if (panels.empty()) return std::nullopt;
  return multiples(std::string("stiffness_") + name_of(axis.axis), "Stiffness and loss factor",
                   "Storage stiffness and loss factor: the law (line) with its 95 % band, and the measured loops "
                   "(points).",
                   std::move(panels), k_wide_tile_width, 260, 2);
}

std::optional<Figure> figure_energy(const AxisFit& axis, const std::vector<const TestFit*>& tests) {
  const Grid grid = grid_of(axis, tests);
  if (!varies(grid, Over::amplitude)) return std::nullopt;
  const Quantity energy{"Energy a cycle [J]", 1.0, &ResponsePoint::energy,
                        [](const LoopMeasures& loop) { return loop.dissipated_energy; }};
  std::vector<Panel> panels{quantity_panel(grid, Over::amplitude, energy), deviation_panel(grid, energy)};
  panels[0].log_y = true;
  panels[0].title = "Dissipated energy";
  panels[1].title = "Its deviation from the law";
  return multiples(std::string("energy_") + name_of(axis.axis), "Energy over amplitude",
                   "Energy turned into heat in a cycle: the law (line) with its 95 % band, and the measured loops "
                   "(points); beside it what the logarithmic scale hides.",
                   std::move(panels), k_wide_tile_width, 260, 2);
}

std::optional<Figure> figure_gain(const std::vector<const TestFit*>& tests) {
  Grid plain;
  for (const TestFit* test : tests)  // a test has one gain, whatever amplitudes it ran through
    if (!left_out(*test) && test->kind == TestKind::cyclic && test->gain != 0.0)
      plain.loops.push_back({test, test->amplitude, test->frequency, {}, {}});
  if (plain.loops.empty()) return std::nullopt;
  plain.axis = tests.front()->axis;
  const Grid grid = with_levels(std::move(plain));
  std::vector<Panel> panels;
  for (const Over over : {Over::frequency, Over::amplitude}) {
    if (!varies(grid, over)) continue;
    Panel panel = empty_panel(grid, over, "Gain residual [%]");
    panel.zero_lines = true;
    for (std::size_t group = 0; group < num_groups(grid, over); ++group) {
      Series series{.name = group_name(grid, over, group),
                    .style = SeriesStyle::points,
                    .width = 2.4f,
                    .hue = static_cast<int>(group)};
      for (const auto& [x, loop] : curve_of(grid, grid.loops, over, group)) {
        series.x.push_back(x);
        series.y.push_back(100.0 * loop->test->gain);
      }
      panel.series.push_back(std::move(series));
    }
    panels.push_back(std::move(panel));
  }
  if (panels.empty()) return std::nullopt;
  return multiples(std::string("gain_") + name_of(grid.axis), "Gain residual of each test",
                   "By how much the measured force of a test is larger than the law’s as a whole. A trend over "
                   "frequency says that a Maxwell branch is missing, one over amplitude that a friction stop is; "
                   "scatter is remounting of the specimen.",
                   std::move(panels), k_wide_tile_width, 220, 2);
}

// ------------------------------------------------------------------------------------------------- law as a whole

namespace {

Panel band_panel(const std::vector<BandPoint>& points, const std::string& title, Axis axis, const std::string& y_label,
                 double y_scale) {
  const AxisUnits units = units_of(axis);
  Panel panel{.title = title, .x_label = displacement_label(axis, units), .y_label = y_label};
  Band band{.name = "95 % interval", .hue = k_blue};
  Series line{.name = "identified", .width = 1.8f, .hue = k_blue};
  for (const BandPoint& point : points) {
    band.x.push_back(units.displacement_scale * point.x);
    band.low.push_back(y_scale * point.low);
    band.high.push_back(y_scale * point.high);
    line.x.push_back(units.displacement_scale * point.x);
    line.y.push_back(y_scale * point.value);
  }
  panel.bands.push_back(std::move(band));
  panel.series.push_back(std::move(line));
  return panel;
}

/// The band by itself: beside forces of the whole range it is no wider than the line.
Panel interval_panel(const std::vector<BandPoint>& points, const std::string& title, Axis axis,
                     const std::string& y_label, double y_scale) {
  std::vector<BandPoint> about_zero;
  for (const BandPoint& point : points)
    about_zero.push_back({point.x, 0.0, point.low - point.value, point.high - point.value});
  Panel panel = band_panel(about_zero, title, axis, y_label, y_scale);
  panel.series.front().width = 1.0f;
  return panel;
}

std::vector<Mark> limit_marks(const AxisFit& axis) {
  const double scale = units_of(axis.axis).displacement_scale;
  std::vector<Mark> marks;
  if (axis.preset != 0.0) marks.push_back({scale * axis.preset, true, "preset"});
  if (axis.clearance) {
    marks.push_back({scale * axis.clearance->low, true, "play"});
    marks.push_back({scale * axis.clearance->high, true, "play"});
  }
  for (const HardStop& stop : axis.hard_stops) marks.push_back({scale * stop.at, true, "stop"});
  return marks;
}

}  // namespace

std::optional<Figure> figure_backbone(const AxisFit& axis) {
  if (axis.backbone.empty()) return std::nullopt;
  const AxisUnits units = units_of(axis.axis);
  std::vector<Panel> panels{
      band_panel(axis.backbone, "Backbone", axis.axis, force_label(axis.axis, units), units.force_scale)};
  std::string caption = "What the data determine, with 95 % bands";
  if (!axis.tangent.empty()) {
    panels.push_back(band_panel(axis.tangent, "Tangent stiffness", axis.axis, "Stiffness [" + units.stiffness + "]",
                                units.stiffness_scale));
    caption += fmt::format("; the tangent is taken over a window of ±{} {}",
                           number_text(units.displacement_scale * axis.tangent_window, 3), units.displacement);
  }
  for (Panel& panel : panels) panel.marks = limit_marks(axis);
  panels.insert(panels.begin() + 1, interval_panel(axis.backbone, "Interval of the backbone", axis.axis,
                                                   force_label(axis.axis, units), units.force_scale));
  return multiples(std::string("backbone_") + name_of(axis.axis), "Backbone and tangent stiffness", caption + ".",
                   std::move(panels), k_tile_width, 235, 3);
}

std::optional<Figure> figure_selection(const AxisFit& axis) {
  if (axis.selection.size() < 2) return std::nullopt;
  Panel panel{.title = "", .x_label = "Friction stops and Maxwell branches", .y_label = "Left-out error [%]"};
  Series plain{.name = "tried", .style = SeriesStyle::points, .width = 2.0f, .hue = k_blue};
  Series growing{.name = "tried, yield grows with strain", .style = SeriesStyle::points, .width = 2.0f, .hue = 2};
  Series chosen{.name = "chosen", .style = SeriesStyle::points, .width = 3.6f, .hue = k_orange};
  for (const LawCandidate& candidate : axis.selection) {
    Series& series = candidate.chosen ? chosen : candidate.strain_dependent_yield ? growing : plain;
    series.x.push_back(candidate.stops + candidate.branches);
    series.y.push_back(100.0 * candidate.left_out_error);
  }
  for (Series* series : {&plain, &growing, &chosen})
    if (!series->x.empty()) panel.series.push_back(std::move(*series));
  return multiples(std::string("selection_") + name_of(axis.axis), "Size of the law",
                   "Error on tests that the law was not fitted to, over the number of its elements: too few miss the "
                   "rubber, too many follow the noise, and each costs time in every step of a run.",
                   {std::move(panel)}, k_wide_tile_width, 260, 1);
}

}  // namespace grouser
