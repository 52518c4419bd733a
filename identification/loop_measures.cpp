#include "identification/loop_measures.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace grouser {
namespace {

constexpr double k_pi = std::numbers::pi;
constexpr std::size_t k_samples_for_all = 24;  // fewer samples carry the first harmonic only

}  // namespace

LoopMeasures loop_measures(const std::vector<double>& displacement, const std::vector<double>& force,
                           const std::vector<double>& force_for_range, CycleSpan span, double frequency) {
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
  measures.secant_stiffness = (first_force[x_high - first] - first_force[x_low - first]) / (2.0 * amplitude);
  measures.loss_factor = area / (pi_squared_amplitude * measures.effective_stiffness);
  if (frequency > 0.0) measures.equivalent_damping = area / (2.0 * k_pi * frequency * pi_squared_amplitude);
  return measures;
}

Harmonics fit_harmonics(const std::vector<double>& time, const std::vector<double>& signal, CycleSpan span,
                        double frequency) {
  constexpr int most = 2 + 2 * Harmonics::k_count;
  const int count = span.end - span.begin < k_samples_for_all ? 1 : Harmonics::k_count, unknowns = 2 + 2 * count;
  const double omega = 2.0 * k_pi * frequency, t0 = time[span.begin], duration = time[span.end] - t0;
  Eigen::Matrix<double, most + 1, most + 1> moments = Eigen::Matrix<double, most + 1, most + 1>::Zero();
  Eigen::Matrix<double, most + 1, 1> row = Eigen::Matrix<double, most + 1, 1>::Zero();
  for (std::size_t i = span.begin; i <= span.end; ++i) {
    const double t = time[i] - t0;
    const std::complex<double> turn = std::polar(1.0, omega * t);
    std::complex<double> power = 1.0;
    row(0) = 1.0;
    row(1) = t / duration;
    for (int k = 0; k < count; ++k) {
      power *= turn;
      row(2 + 2 * k) = power.real();
      row(3 + 2 * k) = -power.imag();  // Re (a + i b) exp(i w t) = a cos(w t) - b sin(w t)
    }
    row(most) = signal[i] - signal[span.begin];
    moments.selfadjointView<Eigen::Lower>().rankUpdate(row);
  }
  const Eigen::MatrixXd all = moments.selfadjointView<Eigen::Lower>();
  const Eigen::VectorXd target = all.col(most).head(unknowns);
  const Eigen::VectorXd c = all.topLeftCorner(unknowns, unknowns).ldlt().solve(target);
  Harmonics result;
  result.offset = c(0) + signal[span.begin];
  result.drift = c(1) / duration;
  for (int k = 0; k < count; ++k) result.amplitude[static_cast<std::size_t>(k)] = {c(2 + 2 * k), c(3 + 2 * k)};
  result.residual = std::sqrt(std::max(0.0, all(most, most) - target.dot(c)) / all(0, 0));
  return result;
}

std::complex<double> dynamic_stiffness(const std::vector<double>& time, const std::vector<double>& displacement,
                                       const std::vector<double>& force, CycleSpan span, double frequency) {
  const std::complex<double> x = fit_harmonics(time, displacement, span, frequency).amplitude[0];
  return std::abs(x) > 0.0 ? fit_harmonics(time, force, span, frequency).amplitude[0] / x : 0.0;
}

}  // namespace grouser
