#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/channels.h"
#include "reports/number_text.h"
#include "reports/run_figures.h"

namespace grouser {
namespace {

/// Mean step in windows of time, weighted by steps: what the eye cannot take from the dense curve.
Series mean_of(const Series& steps, double duration) {
  constexpr std::size_t k_windows = 170;
  std::vector<double> sum(k_windows, 0.0), count(k_windows, 0.0);
  for (std::size_t i = 0; i < steps.x.size(); ++i) {
    const double window = steps.x[i] / std::max(duration, 1e-9) * k_windows;
    const auto w = static_cast<std::size_t>(std::clamp(window, 0.0, k_windows - 1.0));
    sum[w] += steps.y[i];
    count[w] += 1.0;
  }
  Series mean{.name = "mean", .x = {}, .y = {}, .width = 2.2f};
  for (std::size_t w = 0; w < k_windows; ++w) {
    if (count[w] == 0.0) continue;
    mean.x.push_back((static_cast<double>(w) + 0.5) * duration / k_windows);
    mean.y.push_back(sum[w] / count[w]);
  }
  return mean;
}

}  // namespace

Figure figure_step_size(const RunFolder& run) {
  Panel step = time_panel("Step size", "Step h [ms]");
  step.series.push_back({.name = "accepted steps",
                         .x = require_column(run, "/steps/time"),
                         .y = scaled(require_column(run, "/steps/size"), 1e3),
                         .width = 1.0f});
  step.series.push_back(mean_of(step.series.front(), run.summary.simulated_time));
  Panel speed = time_panel("Vehicle speed", "Speed v [m/s]");
  speed.series.push_back({.name = "", .x = require_column(run, "/time"), .y = forward_speed(run)});
  return stacked_figure(
      "step_size", "Step size of the integrator",
      "Every accepted step of the variable-step integrator over time, with the speed of the vehicle (the paper's "
      "Fig. 4): contacts at speed ask for smaller steps.",
      {std::move(step), std::move(speed)});
}

Figure figure_step_limits(const RunFolder& run) {
  const std::vector<double> time = require_column(run, "/steps/time");
  const std::vector<double> limit = require_column(run, "/steps/limit");
  (void)require_channel(run, "/steps/size");
  std::vector<std::string> names;
  if (run.channels.has("/steps/limit_names")) names = run.channels.read_names("/steps/limit_names");
  const auto code = [](double value) { return static_cast<std::size_t>(std::max(0.0, value)); };
  const std::size_t num_codes = std::max(names.size(), code(*std::ranges::max_element(limit)) + 1);
  for (std::size_t i = names.size(); i < num_codes; ++i) names.push_back(fmt::format("limit {}", i));

  const double end = std::max(time.back(), 1e-9);
  constexpr std::size_t k_bins = 120;
  std::vector<std::vector<double>> count(num_codes, std::vector<double>(k_bins, 0.0));
  std::vector<double> total(k_bins, 0.0), center(k_bins);
  for (std::size_t i = 0; i < std::min(time.size(), limit.size()); ++i) {
    const auto bin = std::min(k_bins - 1, static_cast<std::size_t>(std::max(0.0, time[i]) / end * k_bins));
    count[code(limit[i])][bin] += 1.0;
    total[bin] += 1.0;
  }
  for (std::size_t bin = 0; bin < k_bins; ++bin) center[bin] = (static_cast<double>(bin) + 0.5) * end / k_bins;
  Panel panel = time_panel("", "Share of steps [%]");
  panel.y_range = {{0.0, 100.0}};
  for (std::size_t i = 0; i < num_codes; ++i) {
    if (std::ranges::all_of(count[i], [](double c) { return c == 0.0; })) continue;
    Series series{.name = names[i], .x = center, .y = {}};
    for (std::size_t bin = 0; bin < k_bins; ++bin)
      series.y.push_back(total[bin] > 0.0 ? 100.0 * count[i][bin] / total[bin] : std::nan(""));
    panel.series.push_back(std::move(series));
  }
  return stacked_figure("step_limits", "What bounded the steps",
                        fmt::format("Share of the accepted steps by what bounded them, in windows of {}.",
                                    quantity_text(end / k_bins, "s", 2)),
                        {std::move(panel)}, 240);
}

Figure figure_step_histogram(const RunFolder& run) {
  const std::vector<double> size = scaled(require_column(run, "/steps/size"), 1e3);
  const double high = std::max(*std::ranges::max_element(size), 1e-12);
  Panel panel{.title = "Accepted steps"};
  panel.x_label = "Step h [ms]";
  panel.y_label = "Share of steps [%]";
  panel.x_range = {{0.0, high}};
  panel.series.push_back(histogram(panel.title, size, 0.0, high, 80));
  return stacked_figure("step_histogram", "Distribution of the step size",
                        "The accepted steps of the whole run by their size.", {std::move(panel)}, 200);
}

}  // namespace grouser
