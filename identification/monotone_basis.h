#pragma once
#include <Eigen/Core>
#include <array>

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
  [[nodiscard]] int intervals() const { return intervals_; }

  /// The cubic B-splines that do not vanish at a point: numbers first .. first + 3 of num_bsplines().
  struct Local {
    int first = 0;
    std::array<double, 4> value{};
  };
  [[nodiscard]] int num_bsplines() const { return intervals_ + 3; }
  /// B-splines at x (clamped to the domain): 4 numbers a sample where the increments need size().
  [[nodiscard]] Local local(double x) const;
  /// Turns sums over the B-splines (num_bsplines() rows) into sums over the increments' curves I_j (size() rows). I_j
  /// with j < `pivot` are shifted down by 1, a constant that no test can see: a curve that has risen before the data
  /// begin is then exactly 0 and not 1 - round-off.
  [[nodiscard]] Eigen::MatrixXd of_increments(const Eigen::MatrixXd& of_bsplines, int pivot = 0) const;

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
