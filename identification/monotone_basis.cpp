#include "identification/monotone_basis.h"

#include <algorithm>

namespace grouser {

MonotoneBasis::MonotoneBasis(double low, double high, int intervals, SpringSymmetry symmetry)
    : low_(low), width_((high - low) / intervals), intervals_(intervals), symmetry_(symmetry) {}

Eigen::VectorXd MonotoneBasis::untied(const Eigen::VectorXd& increments) const {
  if (symmetry_ == SpringSymmetry::none) return increments;
  Eigen::VectorXd full(full_size());
  for (int j = 0; j < full_size(); ++j) full(j) = increments(std::min(j, full_size() - 1 - j));
  return full;
}

MonotoneBasis::Local MonotoneBasis::local(double x) const {
  const double position = std::clamp((x - low_) / width_, 0.0, static_cast<double>(intervals_));
  const int interval = std::min(static_cast<int>(position), intervals_ - 1);
  const double u = position - interval, v = 1.0 - u;
  return {interval,
          {v * v * v / 6.0, (4.0 - 6.0 * u * u + 3.0 * u * u * u) / 6.0, (4.0 - 6.0 * v * v + 3.0 * v * v * v) / 6.0,
           u * u * u / 6.0}};
}

Eigen::MatrixXd MonotoneBasis::of_increments(const Eigen::MatrixXd& of_bsplines, int pivot) const {
  // I_j is the sum of all B-splines after number j, and all together are 1; an odd basis adds the mirrored one.
  Eigen::MatrixXd full = of_bsplines.bottomRows(full_size());
  for (Eigen::Index j = full.rows() - 2; j >= pivot; --j) full.row(j) += full.row(j + 1);
  for (Eigen::Index j = 0; j < pivot; ++j) {
    full.row(j) = -of_bsplines.row(j);
    if (j > 0) full.row(j) += full.row(j - 1);
  }
  for (Eigen::Index j = 0; symmetry_ == SpringSymmetry::odd && j < full.rows() / 2; ++j) {
    full.row(j) += full.row(full.rows() - 1 - j);
  }
  return full.topRows(size());
}

void MonotoneBasis::evaluate(double x, double* row) const {
  const Local here = local(x);
  Eigen::VectorXd bsplines = Eigen::VectorXd::Zero(num_bsplines());
  for (int k = 0; k < 4; ++k) bsplines(here.first + k) = here.value[static_cast<std::size_t>(k)];
  Eigen::Map<Eigen::VectorXd>(row, size()) = of_increments(bsplines);
}

SpringSpline MonotoneBasis::curve(const Eigen::VectorXd& tied) const {
  const Eigen::VectorXd increments = untied(tied);
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
  if (symmetry_ == SpringSymmetry::none) return spring;
  for (std::size_t i = 0, j = spring.force.size() - 1; i <= j && j < spring.force.size(); ++i, --j) {
    spring.displacement[i] = -spring.displacement[j];  // to the last bit, so that a run can hold its mirror symmetry
    spring.force[i] = -spring.force[j];
    spring.slope[i] = spring.slope[j];
    if (i == j) spring.displacement[i] = spring.force[i] = 0.0;
  }
  return spring;
}

Eigen::MatrixXd MonotoneBasis::roughness() const {
  Eigen::MatrixXd difference = Eigen::MatrixXd::Zero(std::max(full_size() - 2, 0), full_size());
  for (Eigen::Index i = 0; i < difference.rows(); ++i) {
    difference(i, i) = 1.0;
    difference(i, i + 1) = -2.0;
    difference(i, i + 2) = 1.0;
  }
  if (symmetry_ == SpringSymmetry::none) return difference.transpose() * difference;
  Eigen::MatrixXd tied = Eigen::MatrixXd::Zero(difference.rows(), size());
  for (int j = 0; j < full_size(); ++j) tied.col(std::min(j, full_size() - 1 - j)) += difference.col(j);
  return tied.transpose() * tied;
}

}  // namespace grouser
