#include "simulator/integrator.h"

#include <cmath>
#include <limits>

namespace grouser {

StepWeights step_weights(double beta, double h, double previous_h) {
  const double r = h / previous_h, lag = (beta - 0.5) * r;
  return {h, h * (1.0 + 0.5 * r), -0.5 * h * r, h * h * (0.5 + lag), -h * h * lag};
}

ErrorWeights error_weights(double beta, double h, double previous_h) {
  const double r = h / previous_h;
  return {r, h * (2.0 * r + 3.0) / (6.0 * (1.0 + r)), std::abs(beta - 2.0 / 3.0) * h * h};
}

double stable_step(double beta, double s2, double s1) {
  const double a = (4.0 * beta - 3.0) * s2;
  if (a <= 0.0) return s1 > 0.0 ? 1.0 / s1 : std::numeric_limits<double>::infinity();
  // 2 c / (b + sqrt(b^2 + a c)): no cancellation for small a.
  return 2.0 / (s1 + std::sqrt(s1 * s1 + a));
}

}  // namespace grouser
