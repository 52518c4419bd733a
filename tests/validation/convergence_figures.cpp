#include "tests/validation/convergence_figures.h"

#include <fmt/format.h>

#include <cmath>

namespace grouser::validation {
namespace {

constexpr int k_tolerance_hue = 0, k_fixed_hue = 1;

/// A line with a dot at each of its points.
void add_dotted(Panel& panel, const std::string& name, const std::vector<double>& x, const std::vector<double>& y,
                int hue) {
  Series line{name, x, y};
  line.hue = hue;
  Series dots{"", x, y, SeriesStyle::points, 5.0f};
  dots.hue = hue;
  panel.series.push_back(line);
  panel.series.push_back(dots);
}

std::vector<double> mean_steps(const std::vector<Rung>& rungs) {
  std::vector<double> steps;
  for (const Rung& rung : rungs) steps.push_back(1e6 * rung.mean_step());
  return steps;
}

std::array<double, 2> range_of(const Ladder& ladder) {
  double low = 1e9, high = 0.0;
  for (const auto* rungs : {&ladder.tolerances, &ladder.fixed_steps}) {
    for (const double step : mean_steps(*rungs)) low = std::min(low, step), high = std::max(high, step);
  }
  return {low / 1.15, high * 1.15};
}

/// One quantity over the mean step, in its own unit, with the allowance about the reference as a band.
Panel quantity_panel(const Ladder& ladder, const std::string& name) {
  const int q = index_of_quantity(name);
  const Quantity& quantity = quantities()[static_cast<std::size_t>(q)];
  const auto values = [&](const std::vector<Rung>& rungs) {
    std::vector<double> y;
    for (const Rung& rung : rungs) y.push_back(quantity.scale * rung.mean(q));
    return y;
  };
  Panel panel;
  panel.title = name;
  panel.x_label = "Mean step in cruise h [µs]";
  panel.y_label = fmt::format("[{}]", quantity.unit);
  panel.log_x = true;
  panel.x_range = range_of(ladder);
  const double reference = quantity.scale * ladder.reference().mean(q);
  const double allowance = ladder.allowance(ladder.tolerance(ladder.chosen), q);
  panel.bands.push_back({fmt::format("{:g} %, and scatter", 100.0 * limit_of(quantity.kind)),
                         {(*panel.x_range)[0], (*panel.x_range)[1]},
                         {reference * (1.0 - allowance), reference * (1.0 - allowance)},
                         {reference * (1.0 + allowance), reference * (1.0 + allowance)}});
  panel.bands.back().hue = 2;
  add_dotted(panel, "tolerance", mean_steps(ladder.tolerances), values(ladder.tolerances), k_tolerance_hue);
  add_dotted(panel, "fixed step", mean_steps(ladder.fixed_steps), values(ladder.fixed_steps), k_fixed_hue);
  panel.marks.push_back({1e6 * ladder.tolerance(ladder.chosen).mean_step(), true, ladder.chosen});
  const double reach = std::abs(reference) * std::max(2.5 * allowance, 0.02);
  panel.y_range = {{reference - reach, reference + reach}};
  return panel;
}

Figure grid_of(const Ladder& ladder, const std::string& name, const std::string& title,
               const std::vector<std::string>& shown) {
  Figure figure;
  figure.name = name;
  figure.title = title;
  figure.columns = 2;
  figure.width = 900;
  figure.height = 290 * static_cast<int>((shown.size() + 1) / 2);
  for (const std::string& quantity : shown) figure.panels.push_back(quantity_panel(ladder, quantity));
  return figure;
}

/// y = c h^2 through the last point.
Series square_law(const std::vector<double>& x, double at_x, double at_y) {
  Series law{"h^{2}", {x.front(), x.back()}, {}, SeriesStyle::dashed};
  for (const double h : law.x) law.y.push_back(at_y * (h / at_x) * (h / at_x));
  law.hue = 7;
  return law;
}

}  // namespace

Figure figure_fluctuation(const Ladder& ladder) {
  return grid_of(ladder, "convergence_fluctuation", "What fluctuates at link passing, over the step",
                 {"Sprocket torque, line at link passing", "Tension of the rear span, line at link passing",
                  "Tension of the front span, line at link passing", "Sprocket torque, rms about its mean"});
}

Figure figure_means_and_peaks(const Ladder& ladder) {
  return grid_of(
      ladder, "convergence_tension", "Mean tensions and peaks, over the step",
      {"Tension of the upper run, cruise", "Distance", "Peak tension, cruise", "Peak force on road wheels, cruise"});
}

Figure figure_residual(const Ladder& ladder) {
  const auto residuals = [](const std::vector<Rung>& rungs) {
    std::vector<double> y;
    for (const Rung& rung : rungs) y.push_back(rung.average(&Measures::residual_fraction));
    return y;
  };
  Figure figure;
  figure.name = "convergence_energy";
  figure.title = "Energy residual over the integral of |sprocket power|";
  figure.width = 640;
  figure.height = 340;
  Panel panel;
  panel.x_label = "Mean step in cruise h [µs]";
  panel.y_label = "Residual [1]";
  panel.log_x = panel.log_y = true;
  panel.x_range = range_of(ladder);
  const std::vector<double> x = mean_steps(ladder.fixed_steps), y = residuals(ladder.fixed_steps);
  add_dotted(panel, "tolerance", mean_steps(ladder.tolerances), residuals(ladder.tolerances), k_tolerance_hue);
  add_dotted(panel, "fixed step", x, y, k_fixed_hue);
  panel.series.push_back(square_law(x, x.back(), y.back()));
  panel.marks.push_back({k_residual_limit, false, "limit"});
  figure.panels.push_back(panel);
  return figure;
}

Figure figure_step_size(const Ladder& ladder, const System& system, const std::string& fine) {
  Figure figure;
  figure.name = "convergence_step_size";
  figure.title = "Step size over the drive";
  figure.width = 900;
  figure.height = 480;
  figure.share_x = true;
  Panel steps;
  steps.y_label = "Mean step h [µs]";
  int hue = 0;
  for (const std::string& name : {ladder.chosen, fine}) {
    Series series{"tolerance " + name, {}, {}, SeriesStyle::steps};
    for (const TenthOfSteps& tenth : ladder.tolerance(name).runs.front().steps) {
      series.x.push_back(tenth.time);
      series.y.push_back(1e6 * tenth.mean);
    }
    series.hue = hue++;
    steps.series.push_back(series);
  }
  const DriveTable& table = system.scenario.drive[0];
  Panel speed;
  speed.x_label = "Time t [s]";
  speed.y_label = "Track speed [km/h]";
  Series drive{"", table.time, {}};
  for (const double rate : table.speed) drive.y.push_back(3.6 * rate * system.tracks[0].speed_per_sprocket_rate);
  drive.hue = 2;
  speed.series.push_back(drive);
  figure.panels = {steps, speed};
  return figure;
}

Figure figure_trajectory(const TrajectoryErrors& errors) {
  Figure figure;
  figure.name = "convergence_trajectory";
  figure.title = "Links against a Runge-Kutta run, from cruise";
  figure.width = 640;
  figure.height = 360;
  Panel panel;
  panel.x_label = "Fixed step h [µs]";
  panel.y_label = "Largest error of a position [µm]";
  panel.log_x = panel.log_y = true;
  std::vector<double> h;
  for (const double step : errors.steps) h.push_back(1e6 * step);
  for (std::size_t w = 0; w < errors.windows.size(); ++w) {
    std::vector<double> um;
    for (const double e : errors.error[w]) um.push_back(1e6 * e);
    add_dotted(panel, fmt::format("after {:g} ms", 1e3 * errors.windows[w]), h, um, static_cast<int>(w));
  }
  panel.series.push_back(square_law(h, h.back(), 1e6 * errors.error.front().back()));
  figure.panels.push_back(panel);
  return figure;
}

}  // namespace grouser::validation
