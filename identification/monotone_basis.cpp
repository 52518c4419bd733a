#include "identification/monotone_basis.h"

#include <algorithm>

namespace grouser {

MonotoneBasis::MonotoneBasis(double low, double high, int intervals)
    : low_(low), width_((high - low) / intervals), intervals_(intervals) {}

void MonotoneBasis::evaluate(double x, double* row) const {
  const double position = std::clamp((x - low_) / width_, 0.0, static_cast<double>(intervals_));
  const int interval = std::min(static_cast<int>(position), intervals_ - 1);
  const double u = position - interval, v = 1.0 - u;
  const double b1 = (4.0 - 6.0 * u * u + 3.0 * u * u * u) / 6.0;  // second, third, fourth B-spline of the interval
  const double b2 = (4.0 - 6.0 * v * v + 3.0 * v * v * v) / 6.0;
  const double b3 = u * u * u / 6.0;
  std::fill(row, row + interval, 1.0);
  row[interval] = b1 + b2 + b3;
  row[interval + 1] = b2 + b3;
  row[interval + 2] = b3;
  std::fill(row + interval + 3, row + size(), 0.0);
}

SpringSpline MonotoneBasis::curve(const Eigen::VectorXd& increments) const {
  SpringSpline spring;
  double settled = 0.0;  // sum of the increments that are complete at this knot
  for (int i = 0; i <= intervals_; ++i) {
    spring.displacement.push_back(low_ + i * width_);
    spring.force.push_back(settled + 5.0 / 6.0 * increments(i) + 1.0 / 6.0 * increments(i + 1));
    spring.slope.push_back((increments(i) + increments(i + 1)) / (2.0 * width_));
    settled += increments(i);
  }
  return spring;
}

double MonotoneBasis::force_at_rest(const Eigen::VectorXd& increments) const {
  return grouser::evaluate(curve(increments), 0.0).force;
}

SpringSpline MonotoneBasis::spring(const Eigen::VectorXd& increments) const {
  SpringSpline spring = curve(increments);
  const double at_rest = grouser::evaluate(spring, 0.0).force;
  for (double& force : spring.force) force -= at_rest;
  return spring;
}

Eigen::MatrixXd MonotoneBasis::roughness() const {
  Eigen::MatrixXd difference = Eigen::MatrixXd::Zero(std::max(size() - 2, 0), size());
  for (Eigen::Index i = 0; i < difference.rows(); ++i) {
    difference(i, i) = 1.0;
    difference(i, i + 1) = -2.0;
    difference(i, i + 2) = 1.0;
  }
  return difference.transpose() * difference;
}

}  // namespace grouser
