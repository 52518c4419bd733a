#include "reports/fit_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>

#include "model/geometry.h"
#include "reports/number_text.h"

namespace grouser {
namespace {

constexpr Rgb k_measured{0.38f, 0.52f, 0.68f};  // reads on a light and on a dark page

std::vector<double> times(const std::vector<double>& values, double factor) {
  std::vector<double> scaled_values = values;
  for (double& value : scaled_values) value *= factor;
  return scaled_values;
}

Panel band_panel(const std::vector<BandPoint>& points, const std::string& title, const AxisUnits& units,
                 const std::string& y_label, double y_scale) {
  Panel panel;
  panel.title = title;
  panel.x_label = "Displacement [" + units.displacement + "]";
  panel.y_label = y_label;
  Band band{.name = "95 % interval", .x = {}, .low = {}, .high = {}, .color = {}};
  Series line{.name = "identified", .x = {}, .y = {}, .width = 1.8f};
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

using Measure = std::function<double(const LoopMeasures&)>;

/// Measured points and fitted lines of one measure over one test quantity, a pair of series for each value of the
/// other.
Panel measure_panel(const std::vector<const TestFit*>& tests, bool over_frequency, bool named, const AxisUnits& units,
                    const std::string& y_label, const Measure& measure) {
  Panel panel;
  panel.x_label = over_frequency ? "Frequency [Hz]" : "Amplitude [" + units.displacement + "]";
  panel.y_label = y_label;
  panel.title = over_frequency ? "By amplitude" : "By frequency";
  panel.log_x = true;
  // Stated amplitudes and frequencies are met only nearly: two digits tell the groups apart.
  std::map<double, std::vector<const TestFit*>> groups;
  for (const TestFit* test : tests)
    groups[std::stod(
               fmt::format("{:.1e}", over_frequency ? units.displacement_scale * test->amplitude : test->frequency))]
        .push_back(test);
  static constexpr std::array<Rgb, 6> k_colors{{{0.16f, 0.47f, 0.78f},
                                                {0.87f, 0.42f, 0.10f},
                                                {0.15f, 0.60f, 0.38f},
                                                {0.71f, 0.30f, 0.52f},
                                                {0.62f, 0.50f, 0.05f},
                                                {0.42f, 0.40f, 0.85f}}};
  std::size_t number = 0;
  for (auto& [value, group] : groups) {
    std::ranges::sort(group, {}, [&](const TestFit* t) { return over_frequency ? t->frequency : t->amplitude; });
    const Rgb color = k_colors[number++ % k_colors.size()];
    Series measured{.name = named ? number_text(value, 2) + " " + (over_frequency ? units.displacement : "Hz") : "",
                    .x = {},
                    .y = {},
                    .style = SeriesStyle::points,
                    .width = 3.2f,
                    .color = color};
    Series fitted{.name = "", .x = {}, .y = {}, .style = SeriesStyle::line, .width = 1.5f, .color = color};
    for (const TestFit* test : group) {
      const double x = over_frequency ? test->frequency : units.displacement_scale * test->amplitude;
      measured.x.push_back(x);
      measured.y.push_back(measure(test->measured));
      fitted.x.push_back(x);
      fitted.y.push_back(measure(test->fitted));
    }
    panel.series.push_back(std::move(fitted));
    panel.series.push_back(std::move(measured));
  }
  return panel;
}

}  // namespace

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

std::optional<Figure> figure_loops(const FitRecord& fit, Axis axis) {
  const AxisUnits units = units_of(axis);
  Figure figure;
  bool unnamed_fit = true;
  for (const TestFit& test : fit.tests) {
    if (test.axis != axis || test.curve.displacement.empty()) continue;
    Panel panel;
    const bool used = test.cycles_used > 0;
    panel.title = used ? test.name : test.name + " (left out of the fit)";
    panel.x_label = "Displacement [" + units.displacement + "]";
    panel.y_label = (is_rotation(axis) ? "Torque [" : "Force [") + units.force + "]";
    const bool first = figure.panels.empty();  // one legend serves all
    Series measured{.name = first ? "measured" : "",
                    .x = {},
                    .y = {},
                    .style = SeriesStyle::points,
                    .width = 2.4f,
                    .color = k_measured};
    constexpr std::size_t k_points = 44;  // more would hide the fit
    const std::size_t stride = std::max<std::size_t>(1, test.curve.displacement.size() / k_points);
    for (std::size_t i = 0; i < test.curve.displacement.size(); i += stride) {
      measured.x.push_back(units.displacement_scale * test.curve.displacement[i]);
      measured.y.push_back(units.force_scale * test.curve.force[i]);
    }
    panel.series.push_back(std::move(measured));
    if (used)
      panel.series.push_back({.name = unnamed_fit ? "fit" : "",
                              .x = times(test.curve.displacement, units.displacement_scale),
                              .y = times(test.curve.fitted, units.force_scale),
                              .width = 1.3f,
                              .color = Rgb{0.87f, 0.36f, 0.08f}});
    unnamed_fit = unnamed_fit && !used;
    figure.panels.push_back(std::move(panel));
  }
  if (figure.panels.empty()) return std::nullopt;
  figure.name = std::string("loops_") + name_of(axis);
  figure.title = "Fit over measurement";
  figure.caption =
      "Every test of the axis: measured loop (points) with the response of the fitted law over it (line), cycles used "
      "in the fit.";
  figure.columns = std::min<int>(3, static_cast<int>(figure.panels.size()));
  const int rows = (static_cast<int>(figure.panels.size()) + figure.columns - 1) / figure.columns;
  figure.width = figure.columns == 1 ? 640 : 1000;
  figure.height = 60 + (figure.columns == 1 ? 340 : 250) * rows;
  return figure;
}

std::optional<Figure> figure_backbone(const AxisFit& axis) {
  if (axis.backbone.empty()) return std::nullopt;
  const AxisUnits units = units_of(axis.axis);
  Figure figure;
  figure.name = std::string("backbone_") + name_of(axis.axis);
  figure.title = "Backbone and tangent stiffness";
  figure.caption = "What the data determine, with 95 % bands.";
  figure.panels.push_back(band_panel(axis.backbone, "Backbone", units,
                                     (is_rotation(axis.axis) ? "Torque [" : "Force [") + units.force + "]",
                                     units.force_scale));
  if (!axis.tangent.empty()) {
    figure.panels.push_back(band_panel(axis.tangent, "Tangent stiffness", units, "Stiffness [" + units.stiffness + "]",
                                       units.stiffness_scale));
    figure.caption =
        fmt::format("What the data determine, with 95 % bands; the tangent is taken over a window of ±{} {}.",
                    number_text(units.displacement_scale * axis.tangent_window, 3), units.displacement);
  }
  figure.columns = static_cast<int>(figure.panels.size());
  figure.width = figure.columns == 1 ? 640 : 1000;
  figure.height = 360;
  return figure;
}

std::optional<Figure> figure_dynamic_stiffness(const FitRecord& fit, Axis axis) {
  std::vector<const TestFit*> tests;
  for (const TestFit& test : fit.tests)
    if (test.axis == axis && test.kind == TestKind::cyclic && test.cycles_used > 0 && test.frequency > 0.0 &&
        test.amplitude > 0.0)
      tests.push_back(&test);
  if (tests.size() < 2) return std::nullopt;
  const AxisUnits units = units_of(axis);
  const Measure stiffness = [&](const LoopMeasures& loop) { return units.stiffness_scale * loop.effective_stiffness; };
  const Measure loss = [](const LoopMeasures& loop) { return loop.loss_factor; };
  Figure figure;
  figure.name = std::string("dynamic_stiffness_") + name_of(axis);
  figure.title = "Stiffness and loss factor";
  figure.caption =
      "Effective stiffness and loss factor of every loop: measured (points) and fitted (lines), over frequency and "
      "over amplitude.";
  for (const bool over_frequency : {true, false}) {
    figure.panels.push_back(
        measure_panel(tests, over_frequency, true, units, "Stiffness [" + units.stiffness + "]", stiffness));
    figure.panels.push_back(measure_panel(tests, over_frequency, false, units, "Loss factor [1]", loss));
  }
  figure.columns = 2;
  figure.width = 1000;
  figure.height = 620;
  return figure;
}

}  // namespace grouser
