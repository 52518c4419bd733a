#pragma once
#include <Eigen/Core>

#include "model/spline.h"

namespace grouser {

/// Monotone C2 cubic splines on uniform knots over [low, high]: force = sum_j increment_j * I_j(x), increment_j >= 0 in
/// N. I_j are integrated B-splines rising from 0 to 1 (I-splines, Ramsay 1988, Stat. Sci. 3:425), so the curve is
/// monotone by construction; a constant is left out because every test has its own force zero.
///
/// An odd basis over [-reach, reach] ties the increments in mirrored pairs, I_j + I_{K-1-j}: the curve is
/// antisymmetric.
enum class SpringSymmetry { none, odd };
class MonotoneBasis {
 public:
  /// low < high [m or rad]; intervals >= 1. Odd: low = -high.
  MonotoneBasis(double low, double high, int intervals, SpringSymmetry symmetry = SpringSymmetry::none);

  [[nodiscard]] int size() const { return symmetry_ == SpringSymmetry::odd ? (full_size() + 1) / 2 : full_size(); }
  [[nodiscard]] double low() const { return low_; }
  [[nodiscard]] double high() const { return low_ + intervals_ * width_; }
  /// Values of all I_j at x (clamped to the domain) into row[0 .. size()).
  void evaluate(double x, double* row) const;
  /// The same curve as Hermite data at the knots (exact), shifted so that the force at displacement 0 is 0.
  [[nodiscard]] SpringSpline spring(const Eigen::VectorXd& increments) const;
  /// Sum of increment_j I_j at displacement 0 (end tangent outside the domain): what spring() takes off.
  [[nodiscard]] double force_at_rest(const Eigen::VectorXd& increments) const;
  /// Roughness x'Px of the increments: sum of squared second differences (P-spline penalty, Eilers & Marx 1996).
  [[nodiscard]] Eigen::MatrixXd roughness() const;

 private:
  [[nodiscard]] int full_size() const { return intervals_ + 2; }
  [[nodiscard]] Eigen::VectorXd untied(const Eigen::VectorXd& increments) const;
  [[nodiscard]] SpringSpline curve(const Eigen::VectorXd& increments) const;

  double low_, width_;
  int intervals_;
  SpringSymmetry symmetry_;
};

}  // namespace grouser
