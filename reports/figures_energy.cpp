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
