#include "reports/gain_trend.h"

#include <Eigen/Dense>
#include <cmath>

#include "reports/loop_points.h"

namespace grouser {
namespace {

/// Two-sided 95 % quantile of Student's t, Cornish-Fisher expansion of the normal one (Abramowitz & Stegun 26.7.5);
/// within 1 % from three degrees of freedom on.
double student_95(double freedom) {
  constexpr double z = 1.959964, z3 = z * z * z, z5 = z3 * z * z;
  return z + (z3 + z) / (4.0 * freedom) + (5.0 * z5 + 16.0 * z3 + 3.0 * z) / (96.0 * freedom * freedom) +
         (3.0 * z5 * z * z + 19.0 * z5 + 17.0 * z3 - 15.0 * z) / (384.0 * freedom * freedom * freedom);
}

bool vary(const std::vector<const TestFit*>& tests, double TestFit::*quantity) {
  std::vector<double> values;
  for (const TestFit* test : tests) values.push_back(test->*quantity);
  return levels_of(values).size() > 1;
}

}  // namespace

GainTrends gain_trends(const std::vector<const TestFit*>& tests) {
  std::vector<const TestFit*> loops;
  for (const TestFit* test : tests)
    if (!left_out(*test) && test->kind == TestKind::cyclic && test->frequency > 0.0 && test->amplitude > 0.0)
      loops.push_back(test);
  const bool over_frequency = vary(loops, &TestFit::frequency), over_amplitude = vary(loops, &TestFit::amplitude);
  const auto rows = static_cast<Eigen::Index>(loops.size()),
             unknowns = Eigen::Index{1} + over_frequency + over_amplitude;
  if (unknowns == 1 || rows < unknowns + 3) return {};
  Eigen::MatrixXd columns = Eigen::MatrixXd::Ones(rows, unknowns);
  Eigen::VectorXd gain(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const TestFit& loop = *loops[static_cast<std::size_t>(i)];
    if (over_frequency) columns(i, 1) = std::log10(loop.frequency);
    if (over_amplitude) columns(i, unknowns - 1) = std::log10(loop.amplitude);
    gain(i) = loop.gain;
  }
  const auto freedom = static_cast<double>(rows - unknowns);
  const Eigen::MatrixXd inverse = (columns.transpose() * columns).inverse();
  const Eigen::VectorXd slopes = inverse * (columns.transpose() * gain);
  const double variance = (gain - columns * slopes).squaredNorm() / freedom;
  const auto trend = [&](Eigen::Index k) {
    return Trend{slopes(k), student_95(freedom) * std::sqrt(variance * inverse(k, k))};
  };
  GainTrends found;
  if (over_frequency) found.frequency = trend(1);
  if (over_amplitude) found.amplitude = trend(unknowns - 1);
  return found;
}

}  // namespace grouser
