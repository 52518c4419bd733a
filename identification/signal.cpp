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
constexpr double k_near = 0.05;  // of a swing: how far from its ideal start or end a record may be cut
constexpr std::size_t k_quantile_samples = 20000;
constexpr double k_full_swing = 0.9;  // of the previous swing: a shorter last swing does not close a cycle

// Enough for a quantile within 1 % of its own value: all of a short record, some of a long one. They lie at irregular
// distances (golden section), so that no period of the record is met in step.
template <typename Visit>
void visit_some(std::size_t size, Visit visit) {
  if (size <= k_quantile_samples) {
    for (std::size_t i = 0; i < size; ++i) visit(i);
    return;
  }
  const double stride = static_cast<double>(size) / static_cast<double>(k_quantile_samples);
  for (std::size_t k = 0; k < k_quantile_samples; ++k) {
    const double golden = 0.6180339887498949 * static_cast<double>(k), jitter = golden - std::floor(golden);
    visit(std::min(static_cast<std::size_t>((static_cast<double>(k) + jitter) * stride), size - 1));
  }
}

double quantile(std::vector<double>& values, double fraction) {
  if (values.empty()) return 0.0;
  const auto at = static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

// Closed form of the quadratic/cubic smoothing weights over 2 half + 1 samples (Savitzky & Golay 1964).
std::vector<double> smoothing_weights(int half) {
  const double m = half;
  std::vector<double> weights;
  for (int i = -half; i <= half; ++i) {
    weights.push_back(3.0 * (3.0 * m * m + 3.0 * m - 1.0 - 5.0 * i * i) /
                      ((2.0 * m + 3.0) * (2.0 * m + 1.0) * (2.0 * m - 1.0)));
  }
  return weights;
}

// Index where the signal first reaches `level` on the rising swing a..b; a cut record may miss the level by a little.
std::optional<std::size_t> rising_crossing(std::span<const double> x, std::size_t a, std::size_t b, double level,
                                           double swing) {
  if (x[a] >= level) return x[a] - level < k_near * swing ? std::optional(a) : std::nullopt;
  for (std::size_t i = a; i <= b; ++i) {
    if (x[i] >= level) return i;
  }
  return level - x[b] < k_near * swing ? std::optional(b) : std::nullopt;
}

std::vector<CycleSpan> cycles_between_extremes(std::span<const double> x, const std::vector<std::size_t>& turns) {
  std::vector<CycleSpan> cycles;
  for (std::size_t k = 0; k + 2 < turns.size(); k += 2) {
    const double out = std::abs(x[turns[k + 1]] - x[turns[k]]), back = std::abs(x[turns[k + 2]] - x[turns[k + 1]]);
    if (back > k_full_swing * out) cycles.push_back({turns[k], turns[k + 2]});
  }
  return cycles;
}

std::vector<CycleSpan> cycles_between_mids(std::span<const double> x, const std::vector<std::size_t>& turns) {
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

double noise_level(std::span<const double> signal) {
  if (signal.size() < 8) return 0.0;
  std::vector<double> third;
  visit_some(signal.size() - 3, [&](std::size_t i) {
    third.push_back(std::abs(signal[i + 3] - 3.0 * signal[i + 2] + 3.0 * signal[i + 1] - signal[i]));
  });
  return quantile(third, 0.5) / (0.6745 * std::sqrt(20.0));
}

double median_step(std::span<const double> signal) {
  std::vector<double> steps;
  if (signal.size() > 1) {
    visit_some(signal.size() - 1, [&](std::size_t i) { steps.push_back(std::abs(signal[i + 1] - signal[i])); });
  }
  return quantile(steps, 0.5);
}

double central_range(std::span<const double> signal) {
  std::vector<double> values;
  visit_some(signal.size(), [&](std::size_t i) { values.push_back(signal[i]); });
  return quantile(values, 0.995) - quantile(values, 0.005);
}

std::vector<double> smooth(const std::vector<double>& signal, int window, const std::vector<std::size_t>& kept) {
  const int widest = window / 2, n = static_cast<int>(signal.size());
  if (widest < 2 || n < 2 * widest + 1) return signal;
  std::vector<std::vector<double>> weights;
  for (int half = 0; half <= widest; ++half) weights.push_back(smoothing_weights(half));
  std::vector<double> result = signal;
  auto next = kept.begin();
  int before = 0, after = next == kept.end() ? n - 1 : static_cast<int>(*next);
  for (int i = 0; i < n; ++i) {
    if (i > after) {
      before = after;
      after = ++next == kept.end() ? n - 1 : static_cast<int>(*next);
    }
    const int half = std::min({widest, i - before, after - i});
    if (half < 2) continue;
    if (half < widest && kept.empty()) continue;  // the record's ends
    double sum = 0.0;
    for (int k = -half; k <= half; ++k) {
      sum += weights[static_cast<std::size_t>(half)][static_cast<std::size_t>(k + half)] *
             signal[static_cast<std::size_t>(i + k)];
    }
    result[static_cast<std::size_t>(i)] = sum;
  }
  return result;
}

std::vector<std::size_t> reversals(std::span<const double> signal, double hysteresis) {
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

std::vector<std::size_t> turning_points(std::span<const double> displacement) {
  const double range = central_range(displacement);
  return reversals(displacement,
                   std::max(k_hysteresis_of_range * range, k_hysteresis_of_noise * noise_level(displacement)));
}

std::vector<CycleSpan> find_cycles(std::span<const double> displacement) {
  if (displacement.size() < 8 || !(central_range(displacement) > 0.0)) return {};
  const std::vector<std::size_t> turns = turning_points(displacement);
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
  Eigen::Matrix<double, 5, 1> c =
      Eigen::Matrix<double, 5, 1>::Zero();  // offset, drift, cosine, sine, d omega * duration
  for (int iteration = 0; iteration < 12; ++iteration) {
    Eigen::Matrix<double, 6, 6> moments = Eigen::Matrix<double, 6, 6>::Zero();
    for (std::size_t i = range.begin; i <= range.end; ++i) {
      const double t = (time[i] - t0) / duration, sine = std::sin(omega * (time[i] - t0)),
                   cosine = std::cos(omega * (time[i] - t0));
      Eigen::Matrix<double, 6, 1> row;
      row << 1.0, t, cosine, sine, t * (c(3) * cosine - c(2) * sine), signal[i] - signal[range.begin];
      moments.selfadjointView<Eigen::Lower>().rankUpdate(row);
    }
    const int unknowns = iteration == 0 ? 4 : 5;  // the frequency column needs the amplitudes first
    const Eigen::MatrixXd all = moments.selfadjointView<Eigen::Lower>();
    const Eigen::VectorXd target = all.col(5).head(unknowns);
    c.head(unknowns) = all.topLeftCorner(unknowns, unknowns).ldlt().solve(target);
    if (unknowns == 5) omega += c(4) / duration;
    if (unknowns == 5 && std::abs(c(4)) < 1e-9 * omega * duration) break;
  }
  double square = 0.0;
  for (std::size_t i = range.begin; i <= range.end; ++i) {
    const double t = time[i] - t0;
    const double model = c(0) + c(1) * t / duration + c(2) * std::cos(omega * t) + c(3) * std::sin(omega * t);
    square += std::pow(signal[i] - signal[range.begin] - model, 2);
  }
  SineFit fit;
  fit.frequency = omega / (2.0 * k_pi);
  fit.amplitude = std::hypot(c(2), c(3));
  fit.relative_residual = std::sqrt(square / static_cast<double>(n)) / std::max(fit.amplitude / std::sqrt(2.0), 1e-300);
  return fit;
}

}  // namespace grouser
