#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "reports/channels.h"
#include "reports/number_text.h"
#include "reports/run_figures.h"

namespace grouser {
namespace {

/// One term of the energy book and the name that a reader knows it by.
struct Term {
  const char* dataset;
  const char* name;
};
constexpr std::array<Term, 5> k_stored{{{"kinetic", "kinetic"},
                                        {"gravity", "gravity"},
                                        {"bushing", "bushings"},
                                        {"suspension", "suspension"},
                                        {"contact", "contacts"}}};
constexpr std::array<Term, 6> k_lost{{{"bushing_loss", "bushings"},
                                      {"contact_loss", "contact damping"},
                                      {"friction_loss", "wheel and sprocket friction"},
                                      {"ground_loss", "ground friction"},
                                      {"suspension_loss", "suspension"},
                                      {"tensioner_loss", "tensioner"}}};

/// Series over time in `scale` units for the terms that the run holds; `change`: counted from t = 0.
template <std::size_t N>
std::vector<Series> term_series(const RunFolder& run, const std::vector<double>& time, const std::array<Term, N>& terms,
                                double scale, bool change) {
  std::vector<Series> all;
  for (const Term& term : terms) {
    const std::string path = std::string("/energy/") + term.dataset;
    if (!run.channels.has(path)) continue;
    std::vector<double> values = run.channels.read_column(path, {});
    const double start = change && !values.empty() ? values.front() : 0.0;
    for (double& value : values) value = scale * (value - start);
    all.push_back({.name = term.name, .x = time, .y = std::move(values), .width = 1.2f});
  }
  return all;
}

Series sum_of(const std::string& name, const std::vector<double>& time, const std::vector<Series>& terms) {
  Series sum{.name = name, .x = time, .y = std::vector<double>(time.size(), 0.0)};
  for (const Series& term : terms)
    for (std::size_t i = 0; i < std::min(sum.y.size(), term.y.size()); ++i) sum.y[i] += term.y[i];
  return sum;
}

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

/// Running integral of |sprocket power| of both sides [J] at the times of the samples, trapezoid over the probes' finer
/// times.
std::vector<double> power_integral(const RunFolder& run, const std::vector<double>& time) {
  const std::vector<double> fine = require_column(run, "/probes/time");
  const std::vector<double> left = sprocket_torque(run, Side::left), right = sprocket_torque(run, Side::right);
  const std::vector<double> left_rate = sprocket_rate(run, Side::left), right_rate = sprocket_rate(run, Side::right);
  const auto power = [&](std::size_t i) {
    return std::abs(left[i] * table_value(time, left_rate, fine[i])) +
           std::abs(right[i] * table_value(time, right_rate, fine[i]));
  };
  std::vector<double> integral(time.size(), 0.0);
  double sum = 0.0;
  std::size_t i = 1;
  for (std::size_t row = 0; row < time.size(); ++row) {
    for (; i < fine.size() && fine[i] <= time[row]; ++i)
      sum += 0.5 * (power(i) + power(i - 1)) * (fine[i] - fine[i - 1]);
    integral[row] = sum;
  }
  return integral;
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

Figure figure_energy(const RunFolder& run) {
  const std::vector<double> time = require_column(run, "/time");
  constexpr double k_mega = 1e-6;
  const std::vector<Series> stored = term_series(run, time, k_stored, k_mega, true);
  std::vector<Series> lost = term_series(run, time, k_lost, k_mega, false);
  Panel balance = time_panel("Balance", "Energy [MJ]");
  balance.series.push_back(
      {.name = "sprocket work", .x = time, .y = scaled(require_column(run, "/energy/input"), k_mega)});
  balance.series.push_back(sum_of("stored", time, stored));
  balance.series.push_back(sum_of("dissipated", time, lost));
  balance.series.push_back({.name = "residual",
                            .x = time,
                            .y = scaled(require_column(run, "/energy/residual"), k_mega),
                            .style = SeriesStyle::dashed});
  Panel losses = time_panel("Dissipated, by cause", "Energy [MJ]");
  losses.series = std::move(lost);
  std::vector<Panel> panels{std::move(balance)};
  if (!losses.series.empty()) panels.push_back(std::move(losses));
  return stacked_figure(
      "energy", "Energy balance",
      "Work of the sprockets against the energy stored since t = 0 and the energy dissipated, and where it goes.",
      std::move(panels));
}

Figure figure_energy_residual(const RunFolder& run) {
  const std::vector<double> time = require_column(run, "/time");
  const std::vector<double> residual = require_column(run, "/energy/residual");
  const std::vector<double> work = power_integral(run, time);
  Panel absolute = time_panel("Residual", "Residual [J]");
  absolute.series.push_back({.name = "residual", .x = time, .y = residual});
  Panel share = time_panel("Share of the integral of |sprocket power|", "Share [10⁻³]");
  Series fraction{.name = "residual / ∫|P| dt", .x = time, .y = {}};
  // At the very start both are nearly nothing and their ratio says nothing.
  for (std::size_t i = 0; i < time.size(); ++i)
    fraction.y.push_back(work[i] > 1e-2 * work.back() ? 1e3 * residual[i] / work[i] : std::nan(""));
  double reach = 1.25;
  for (const double value : fraction.y) reach = std::max(reach, std::isfinite(value) ? 1.1 * std::abs(value) : 0.0);
  share.series.push_back(std::move(fraction));
  share.marks = {{1.0, false, "limit"}, {-1.0, false, ""}};
  share.y_range = {{-reach, reach}};
  return stacked_figure(
      "energy_residual", "Energy residual",
      "Input less stored less dissipated energy. Hidden chatter of a contact shows here before it shows anywhere "
      "else; a residual above one in a thousand fails the run.",
      {std::move(absolute), std::move(share)}, 170);
}

}  // namespace grouser
