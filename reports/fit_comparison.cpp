#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "reports/figure_block.h"
#include "reports/fit_figures.h"
#include "reports/loop_points.h"
#include "reports/number_text.h"
#include "reports/pages.h"

namespace grouser {
namespace {

using nlohmann::json;

/// A fit and its part on one axis; the first of a list is what the others are compared with.
struct Compared {
  std::string name;
  const AxisFit* axis;
};

std::vector<Compared> fits_with(const std::vector<FitFolder>& fits, Axis axis) {
  std::vector<Compared> found;
  for (const FitFolder& folder : fits)
    for (const AxisFit& fit : folder.fit.axes)
      if (fit.axis == axis) found.push_back({folder.fit.specimen, &fit});
  return found;
}

/// Line and band of every fit, a colour each.
Panel overlay(const std::vector<Compared>& fits, std::vector<BandPoint> AxisFit::*points, const std::string& title,
              const std::string& y_label, double x_scale, double y_scale, const std::string& x_label) {
  Panel panel{.title = title, .x_label = x_label, .y_label = y_label};
  for (std::size_t i = 0; i < fits.size(); ++i) {
    Band band{.hue = static_cast<int>(i)};
    Series line{.name = fits[i].name, .width = 1.5f, .hue = static_cast<int>(i)};
    for (const BandPoint& point : fits[i].axis->*points) {
      band.x.push_back(x_scale * point.x);
      band.low.push_back(y_scale * point.low);
      band.high.push_back(y_scale * point.high);
      line.x.push_back(x_scale * point.x);
      line.y.push_back(y_scale * point.value);
    }
    panel.bands.push_back(std::move(band));
    panel.series.push_back(std::move(line));
  }
  return panel;
}

/// A response of every fit over frequency, at the amplitude nearest to the middle of the first fit's.
Panel response_overlay(const std::vector<Compared>& fits, Interval ResponsePoint::*of, const std::string& y_label,
                       double y_scale) {
  const AxisUnits units = units_of(fits.front().axis->axis);
  std::vector<double> amplitudes;
  for (const ResponsePoint& cell : fits.front().axis->responses) amplitudes.push_back(cell.amplitude);
  amplitudes = levels_of(amplitudes);
  const double amplitude = amplitudes[amplitudes.size() / 2];
  Panel panel{.title = "At " + number_text(units.displacement_scale * amplitude, 2) + " " + units.displacement,
              .x_label = "Frequency [Hz]",
              .y_label = y_label,
              .log_x = true};
  for (std::size_t i = 0; i < fits.size(); ++i) {
    Band band{.hue = static_cast<int>(i)};
    Series line{.name = fits[i].name, .width = 1.5f, .hue = static_cast<int>(i)};
    for (const ResponsePoint& cell : fits[i].axis->responses) {
      if (cell.frequency <= 0.0 || levels_of({cell.amplitude, amplitude}).size() > 1) continue;
      const Interval& interval = cell.*of;
      band.x.push_back(cell.frequency);
      band.low.push_back(y_scale * interval.low);
      band.high.push_back(y_scale * interval.high);
      line.x.push_back(cell.frequency);
      line.y.push_back(y_scale * interval.value);
    }
    panel.bands.push_back(std::move(band));
    panel.series.push_back(std::move(line));
  }
  return panel;
}

Figure overlay_figure(const std::vector<Compared>& fits) {
  const Axis axis = fits.front().axis->axis;
  const AxisUnits units = units_of(axis);
  const std::string x_label = displacement_label(axis, units);
  Figure figure{.name = std::string("compare_") + name_of(axis),
                .title = "Axis " + axis_title(axis),
                .caption = "Lines with their 95 % bands; where bands lie apart, the specimens differ."};
  figure.panels.push_back(overlay(fits, &AxisFit::backbone, "Backbone", force_label(axis, units),
                                  units.displacement_scale, units.force_scale, x_label));
  figure.panels.push_back(overlay(fits, &AxisFit::tangent, "Tangent stiffness", "Stiffness [" + units.stiffness + "]",
                                  units.displacement_scale, units.stiffness_scale, x_label));
  if (!fits.front().axis->responses.empty()) {
    figure.panels.push_back(response_overlay(fits, &ResponsePoint::storage_stiffness,
                                             "Stiffness [" + units.stiffness + "]", units.stiffness_scale));
    figure.panels.push_back(response_overlay(fits, &ResponsePoint::loss_factor, "Loss factor [1]", 1.0));
  }
  figure.columns = 2;
  figure.width = 800;
  figure.height = 260 * static_cast<int>((figure.panels.size() + 1) / 2);
  return figure;
}

/// One line of the table: both values, their difference, and the half width of the interval of that difference, for
/// independent errors the root of the sum of squares.
json difference(const std::string& label, const std::string& against, const Interval& first, const Interval& other,
                double scale, const std::string& unit) {
  const auto half = [](const Interval& interval) { return 0.5 * (interval.high - interval.low); };
  const double change = other.value / first.value - 1.0;
  const double width = std::hypot(half(first), half(other)) / std::abs(first.value);
  const bool differ = std::abs(change) > width;
  return {{"label", label},
          {"against", against},
          {"first", {{"value", first.value}, {"text", number_text(scale * first.value, 3) + " " + unit}}},
          {"other", {{"value", other.value}, {"text", number_text(scale * other.value, 3) + " " + unit}}},
          {"change", {{"value", change}, {"text", signed_percent_text(change)}}},
          {"width", {{"value", width}, {"text", "± " + percent_text(width, 2)}}},
          {"differ", differ},
          {"verdict", differ ? "differ" : "within their intervals"}};
}

std::optional<Interval> at(const std::vector<BandPoint>& points, double x) {
  if (points.empty() || x < points.front().x || x > points.back().x) return std::nullopt;
  const auto after = std::ranges::lower_bound(points, x, {}, &BandPoint::x);
  if (after == points.begin()) return Interval{after->value, after->low, after->high};
  const BandPoint &a = *std::prev(after), &b = *after;
  const double share = (x - a.x) / (b.x - a.x);
  const auto between = [share](double from, double to) { return from + share * (to - from); };
  return Interval{between(a.value, b.value), between(a.low, b.low), between(a.high, b.high)};
}

/// Backbone at both ends and halfway of the first fit's reach.
void add_backbone(json& rows, const Compared& first, const Compared& other) {
  if (first.axis->backbone.empty()) return;
  const AxisUnits units = units_of(first.axis->axis);
  const double low = first.axis->backbone.front().x, high = first.axis->backbone.back().x;
  for (const double x : {low, 0.5 * low, 0.5 * high, high}) {
    const std::optional<Interval> a = at(first.axis->backbone, x), b = at(other.axis->backbone, x);
    if (x == 0.0 || !a || !b || a->value == 0.0) continue;
    rows.push_back(
        difference(fmt::format("Backbone at {} {}", number_text(units.displacement_scale * x, 2), units.displacement),
                   other.name, *a, *b, units.force_scale, units.force));
  }
}

/// Responses at the cells that both fits hold.
void add_responses(json& rows, const Compared& first, const Compared& other) {
  const AxisUnits units = units_of(first.axis->axis);
  for (const ResponsePoint& a : first.axis->responses)
    for (const ResponsePoint& b : other.axis->responses) {
      if (levels_of({a.amplitude, b.amplitude}).size() > 1 || levels_of({a.frequency, b.frequency}).size() > 1)
        continue;
      const std::string cell = fmt::format(" at {} {}, {} Hz", number_text(units.displacement_scale * a.amplitude, 2),
                                           units.displacement, number_text(a.frequency, 2));
      const auto add = [&](const char* name, const Interval& x, const Interval& y, double scale,
                           const std::string& unit) {
        if (x.value > 0.0) rows.push_back(difference(name + cell, other.name, x, y, scale, unit));
      };
      add("Storage stiffness", a.storage_stiffness, b.storage_stiffness, units.stiffness_scale, units.stiffness);
      add("Loss factor", a.loss_factor, b.loss_factor, 1.0, "");
      add("Energy", a.energy, b.energy, 1.0, "J");
    }
}

}  // namespace

json fit_comparison_facts(const std::vector<FitFolder>& fits, const std::string& id, int level) {
  json facts{{"id", id}, {"figure_level", level + 1}, {"axes", json::array()}};
  facts["first"] = fits.front().fit.specimen;
  for (int i = 0; i < k_num_axes; ++i) {
    const std::vector<Compared> compared = fits_with(fits, static_cast<Axis>(i));
    if (compared.size() < 2) continue;
    json axis{{"figure", figure_block(overlay_figure(compared), id + "-" + name_of(static_cast<Axis>(i)))},
              {"rows", json::array()}};
    for (std::size_t k = 1; k < compared.size(); ++k) {
      add_backbone(axis["rows"], compared.front(), compared[k]);
      add_responses(axis["rows"], compared.front(), compared[k]);
    }
    const auto differ = std::ranges::count_if(axis["rows"], [](const json& row) { return row["differ"].get<bool>(); });
    axis["summary"] =
        fmt::format("{} of {} responses differ by more than their intervals together", differ, axis["rows"].size());
    axis["has_rows"] = !axis["rows"].empty();
    facts["axes"].push_back(axis);
  }
  return facts;
}

}  // namespace grouser
