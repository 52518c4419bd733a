#include "identification/signal.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace grouser {
namespace {

constexpr double k_pi = std::numbers::pi;
constexpr double k_hysteresis_of_range = 0.02;  // 2 %: the smallest block of a stepped record may be 17 % of the range
constexpr double k_hysteresis_of_noise = 8.0;
constexpr double k_near = 0.05;       // of a swing: how far from its ideal start or end a record may be cut
constexpr double k_full_swing = 0.9;  // of the previous swing: a shorter last swing does not close a cycle

double quantile(std::vector<double> values, double fraction) {
  const auto at = static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

// Index where the signal first reaches `level` on the rising swing a..b; a cut record may miss the level by a little.
std::optional<std::size_t> rising_crossing(const std::vector<double>& x, std::size_t a, std::size_t b, double level,
                                           double swing) {
  if (x[a] >= level) return x[a] - level < k_near * swing ? std::optional(a) : std::nullopt;
  for (std::size_t i = a; i <= b; ++i) {
    if (x[i] >= level) return i;
  }
  return level - x[b] < k_near * swing ? std::optional(b) : std::nullopt;
}

std::vector<CycleSpan> cycles_between_extremes(const std::vector<double>& x, const std::vector<std::size_t>& turns) {
  std::vector<CycleSpan> cycles;
  for (std::size_t k = 0; k + 2 < turns.size(); k += 2) {
    const double out = std::abs(x[turns[k + 1]] - x[turns[k]]), back = std::abs(x[turns[k + 2]] - x[turns[k + 1]]);
    if (back > k_full_swing * out) cycles.push_back({turns[k], turns[k + 2]});
  }
  return cycles;
}

std::vector<CycleSpan> cycles_between_mids(const std::vector<double>& x, const std::vector<std::size_t>& turns) {
  std::vector<std::size_t> starts;
  for (std::size_t k = 0; k + 1 < turns.size(); ++k) {
    if (x[turns[k + 1]] <= x[turns[k]]) continue;
    // The first and last swing are cut by the record: their neighbour knows the middle.
    const std::size_t from = k == 0 && turns.size() > 2 ? 1 : (k + 2 == turns.size() && k > 0 ? k - 1 : k);
    const double level = 0.5 * (x[turns[from]] + x[turns[from + 1]]);
    const double swing = std::abs(x[turns[from + 1]] - x[turns[from]]);
    if (const auto at = rising_crossing(x, turns[k], turns[k + 1], level, swing)) starts.push_back(*at);
  }
  std::vector<CycleSpan> cycles;
  for (std::size_t k = 0; k + 1 < starts.size(); ++k) cycles.push_back({starts[k], starts[k + 1]});
  return cycles;
}

}  // namespace

double noise_level(const std::vector<double>& signal) {
  if (signal.size() < 8) return 0.0;
  std::vector<double> third(signal.size() - 3);
  for (std::size_t i = 0; i < third.size(); ++i) {
    third[i] = std::abs(signal[i + 3] - 3.0 * signal[i + 2] + 3.0 * signal[i + 1] - signal[i]);
  }
  return quantile(std::move(third), 0.5) / (0.6745 * std::sqrt(20.0));
}

std::vector<double> smooth(const std::vector<double>& signal, int window) {
  const int half = window / 2, n = static_cast<int>(signal.size());
  if (half < 2 || n < 2 * half + 1) return signal;
  // Closed form of the quadratic/cubic smoothing weights (Savitzky & Golay 1964).
  std::vector<double> weight(static_cast<std::size_t>(2 * half + 1));
  const double m = half;
  for (int i = -half; i <= half; ++i) {
    weight[static_cast<std::size_t>(i + half)] =
        3.0 * (3.0 * m * m + 3.0 * m - 1.0 - 5.0 * i * i) / ((2.0 * m + 3.0) * (2.0 * m + 1.0) * (2.0 * m - 1.0));
  }
  std::vector<double> result = signal;
  for (int i = half; i < n - half; ++i) {
    double sum = 0.0;
    for (int k = -half; k <= half; ++k) {
      sum += weight[static_cast<std::size_t>(k + half)] * signal[static_cast<std::size_t>(i + k)];
    }
    result[static_cast<std::size_t>(i)] = sum;
  }
  return result;
}

double central_range(const std::vector<double>& signal) { return quantile(signal, 0.995) - quantile(signal, 0.005); }

std::vector<std::size_t> reversals(const std::vector<double>& signal, double hysteresis) {
  std::vector<std::size_t> turns{0};
  std::size_t lowest = 0, highest = 0;
  int direction = 0;  // +1 rising, -1 falling, 0 not yet known
  for (std::size_t i = 1; i < signal.size(); ++i) {
    if (signal[i] > signal[highest]) highest = i;
    if (signal[i] < signal[lowest]) lowest = i;
    if (direction >= 0 && signal[highest] - signal[i] > hysteresis) {
      if (highest != turns.back()) turns.push_back(highest);
      direction = -1;
      lowest = i;
      highest = i;
    } else if (direction <= 0 && signal[i] - signal[lowest] > hysteresis) {
      if (lowest != turns.back()) turns.push_back(lowest);
      direction = 1;
      lowest = i;
      highest = i;
    }
  }
  const std::size_t last = direction > 0 ? highest : (direction < 0 ? lowest : signal.size() - 1);
  if (last != turns.back()) turns.push_back(last);
  return turns;
}

std::vector<CycleSpan> find_cycles(const std::vector<double>& displacement) {
  if (displacement.size() < 8) return {};
  const double range = central_range(displacement);
  const double hysteresis = std::max(k_hysteresis_of_range * range, k_hysteresis_of_noise * noise_level(displacement));
  if (!(range > 0.0)) return {};
  const std::vector<std::size_t> turns = reversals(displacement, hysteresis);
  const auto [lowest, highest] = std::minmax_element(displacement.begin(), displacement.end());
  const double margin = 0.1 * (*highest - *lowest), start = displacement.front();
  const bool starts_at_extreme = start - *lowest < margin || *highest - start < margin;
  return starts_at_extreme ? cycles_between_extremes(displacement, turns) : cycles_between_mids(displacement, turns);
}

SineFit fit_sine(const std::vector<double>& time, const std::vector<double>& signal, CycleSpan range,
                 double first_frequency) {
  const auto n = static_cast<Eigen::Index>(range.end - range.begin + 1);
  const double t0 = time[range.begin], duration = time[range.end] - t0;
  double omega = 2.0 * k_pi * first_frequency;
  Eigen::MatrixXd columns(n, 5);
  Eigen::VectorXd target(n), c = Eigen::VectorXd::Zero(5);
  for (int iteration = 0; iteration < 12; ++iteration) {
    for (Eigen::Index i = 0; i < n; ++i) {
      const std::size_t at = range.begin + static_cast<std::size_t>(i);
      const double t = time[at] - t0, sine = std::sin(omega * t), cosine = std::cos(omega * t);
      columns.row(i) << 1.0, t / duration, cosine, sine, t * (c(3) * cosine - c(2) * sine);
      target(i) = signal[at];
    }
    const Eigen::Index unknowns = iteration == 0 ? 4 : 5;  // the frequency column needs the amplitudes first
    c.head(unknowns) = columns.leftCols(unknowns).colPivHouseholderQr().solve(target);
    if (unknowns == 5) omega += c(4);
    if (unknowns == 5 && std::abs(c(4)) < 1e-9 * omega) break;
  }
  SineFit fit;
  fit.frequency = omega / (2.0 * k_pi);
  fit.amplitude = std::hypot(c(2), c(3));
  const double residual = (target - columns.leftCols(4) * c.head(4)).norm() / std::sqrt(static_cast<double>(n));
  fit.relative_residual = residual / std::max(fit.amplitude / std::sqrt(2.0), 1e-300);
  return fit;
}

}  // namespace grouser
