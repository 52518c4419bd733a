#include "identification/loop_measures.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace grouser {
namespace {

constexpr double k_pi = std::numbers::pi;
constexpr double k_margin = 3.0;               // standard deviations
constexpr std::size_t k_samples_for_all = 24;  // fewer samples carry the first harmonic only

// Over the samples whose displacement lies in low..high.
double mean_force(const std::vector<double>& displacement, const std::vector<double>& force, CycleSpan span, double low,
                  double high) {
  double sum = 0.0, count = 0.0;
  for (std::size_t i = span.begin; i <= span.end; ++i) {
    if (displacement[i] < low || displacement[i] > high) continue;
    sum += force[i];
    count += 1.0;
  }
  return sum / count;
}

// Harmonics of signals that share their clock.
template <std::size_t N>
std::array<Harmonics, N> fit_together(const std::vector<double>& time,
                                      const std::array<const std::vector<double>*, N>& signals, CycleSpan span,
                                      double frequency) {
  constexpr int most = 2 + 2 * Harmonics::k_count, width = most + static_cast<int>(N);
  const int count = span.end - span.begin < k_samples_for_all ? 1 : Harmonics::k_count, unknowns = 2 + 2 * count;
  const double omega = 2.0 * k_pi * frequency, t0 = time[span.begin], duration = time[span.end] - t0;
  Eigen::Matrix<double, width, width> moments = Eigen::Matrix<double, width, width>::Zero();
  Eigen::Matrix<double, width, 1> row = Eigen::Matrix<double, width, 1>::Zero();
  for (std::size_t i = span.begin; i <= span.end; ++i) {
    const double t = time[i] - t0, cosine = std::cos(omega * t), sine = std::sin(omega * t);
    row(0) = 1.0;
    row(1) = t / duration;
    row(2) = cosine;
    row(3) = -sine;  // Re (a + i b) exp(i w t) = a cos(w t) - b sin(w t)
    for (int k = 2; k < 2 * count; k += 2) {
      row(2 + k) = row(k) * cosine + row(k + 1) * sine;
      row(3 + k) = row(k + 1) * cosine - row(k) * sine;
    }
    for (std::size_t s = 0; s < N; ++s) row(most + static_cast<int>(s)) = (*signals[s])[i] - (*signals[s])[span.begin];
    moments.template selfadjointView<Eigen::Lower>().rankUpdate(row);
  }
  const Eigen::MatrixXd all = moments.template selfadjointView<Eigen::Lower>();
  const Eigen::LDLT<Eigen::MatrixXd> solver(all.topLeftCorner(unknowns, unknowns));
  std::array<Harmonics, N> results;
  for (std::size_t s = 0; s < N; ++s) {
    const int at = most + static_cast<int>(s);
    const Eigen::VectorXd target = all.col(at).head(unknowns), c = solver.solve(target);
    Harmonics& result = results[s];
    result.offset = c(0) + (*signals[s])[span.begin];
    result.drift = c(1) / duration;
    for (int k = 0; k < count; ++k) result.amplitude[static_cast<std::size_t>(k)] = {c(2 + 2 * k), c(3 + 2 * k)};
    result.residual = std::sqrt(std::max(0.0, all(at, at) - target.dot(c)) / all(0, 0));
  }
  return results;
}

}  // namespace

LoopMeasures loop_measures(const std::vector<double>& displacement, const std::vector<double>& force,
                           const std::vector<double>& force_for_range, CycleSpan span, double frequency, double noise) {
  const auto first = displacement.begin() + static_cast<std::ptrdiff_t>(span.begin);
  const auto [x_low, x_high] =
      std::minmax_element(first, first + static_cast<std::ptrdiff_t>(span.end - span.begin) + 1);
  const auto first_force = force_for_range.begin() + static_cast<std::ptrdiff_t>(span.begin);
  const auto [f_low, f_high] =
      std::minmax_element(first_force, first_force + static_cast<std::ptrdiff_t>(span.end - span.begin) + 1);
  const double amplitude = 0.5 * (*x_high - *x_low);
  double area = 0.5 * (force[span.begin] + force[span.end]) * (displacement[span.begin] - displacement[span.end]);
  for (std::size_t i = span.begin + 1; i <= span.end; ++i) {
    area += 0.5 * (force[i] + force[i - 1]) * (displacement[i] - displacement[i - 1]);
  }
  LoopMeasures measures;
  measures.dissipated_energy = area;
  if (!(amplitude > 0.0)) return measures;
  const double pi_squared_amplitude = k_pi * amplitude * amplitude;
  measures.effective_stiffness = (*f_high - *f_low) / (2.0 * amplitude);
  const double margin = k_margin * noise;
  measures.secant_stiffness = (mean_force(displacement, force_for_range, span, *x_high - margin, *x_high) -
                               mean_force(displacement, force_for_range, span, *x_low, *x_low + margin)) /
                              (2.0 * amplitude);
  if (measures.effective_stiffness > 0.0) {
    measures.loss_factor = area / (pi_squared_amplitude * measures.effective_stiffness);
  }
  if (frequency > 0.0) measures.equivalent_damping = area / (2.0 * k_pi * frequency * pi_squared_amplitude);
  return measures;
}

Harmonics fit_harmonics(const std::vector<double>& time, const std::vector<double>& signal, CycleSpan span,
                        double frequency) {
  return fit_together<1>(time, {&signal}, span, frequency)[0];
}

std::complex<double> dynamic_stiffness(const std::vector<double>& time, const std::vector<double>& displacement,
                                       const std::vector<double>& force, CycleSpan span, double frequency) {
  const auto [x, f] = fit_together<2>(time, {&displacement, &force}, span, frequency);
  return std::abs(x.amplitude[0]) > 0.0 ? f.amplitude[0] / x.amplitude[0] : 0.0;
}

}  // namespace grouser
