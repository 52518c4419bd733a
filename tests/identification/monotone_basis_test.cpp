#include "identification/monotone_basis.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

namespace grouser {
namespace {

Eigen::VectorXd random_increments(const MonotoneBasis& basis, unsigned seed) {
  std::mt19937 random(seed);
  std::exponential_distribution<double> size;
  Eigen::VectorXd increments(basis.size());
  for (double& value : increments) value = size(random) < 0.7 ? 0.0 : size(random);
  return increments;
}

double along(const MonotoneBasis& basis, const Eigen::VectorXd& increments, double x) {
  Eigen::VectorXd row(basis.size());
  basis.evaluate(x, row.data());
  return row.dot(increments);
}

TEST(MonotoneBasis, NeverFallsForAnyNonNegativeIncrements) {
  const MonotoneBasis basis(-0.5e-3, 1.0e-3, 14);
  for (unsigned seed = 0; seed < 50; ++seed) {
    const SpringSpline spring = basis.spring(random_increments(basis, seed));
    for (double x = -0.6e-3; x < 1.1e-3; x += 1e-6) ASSERT_GE(evaluate(spring, x).slope, -1e-9 / 1e-3);
  }
}

TEST(MonotoneBasis, IsTheSameCurveAsItsHermiteForm) {
  const MonotoneBasis basis(-2.0, 3.0, 7);
  const Eigen::VectorXd increments = random_increments(basis, 3);
  const SpringSpline spring = basis.spring(increments);
  EXPECT_NEAR(evaluate(spring, 0.0).force, 0.0, 1e-14);
  for (double x = -2.0; x <= 3.0; x += 0.01) {
    EXPECT_NEAR(evaluate(spring, x).force, along(basis, increments, x) - basis.force_at_rest(increments), 1e-13);
  }
}

TEST(MonotoneBasis, HasContinuousCurvature) {
  const MonotoneBasis basis(0.0, 1.0, 6);
  const SpringSpline spring = basis.spring(random_increments(basis, 11));
  for (int knot = 1; knot < 6; ++knot) {
    const double x = knot / 6.0, d = 1e-6;
    const double before = (evaluate(spring, x).slope - evaluate(spring, x - d).slope) / d;
    const double after = (evaluate(spring, x + d).slope - evaluate(spring, x).slope) / d;
    EXPECT_NEAR(before, after, 2e-3);  // third derivatives (about 1e3) times d
  }
}

TEST(MonotoneBasis, ReproducesAStiffeningCubicExactly) {
  const MonotoneBasis basis(-1.0, 1.0, 9);
  Eigen::MatrixXd rows(200, basis.size() + 1);
  Eigen::VectorXd force(200);
  for (int i = 0; i < 200; ++i) {
    const double x = -1.0 + 2.0 * i / 199.0;
    Eigen::VectorXd row(basis.size());
    basis.evaluate(x, row.data());
    rows.row(i) << row.transpose(), 1.0;
    force(i) = x + 2.0 * x * x * x;
  }
  const Eigen::VectorXd fit = rows.colPivHouseholderQr().solve(force);
  EXPECT_LT((rows * fit - force).norm(), 1e-11);
  EXPECT_GE(fit.head(basis.size()).minCoeff(), 0.0);
  const SpringSpline spring = basis.spring(fit.head(basis.size()));
  EXPECT_NEAR(evaluate(spring, 0.7).slope, 1.0 + 6.0 * 0.49, 1e-10);
}

}  // namespace
// A link is its own mirror image in the track's plane: along y, rx and rz the law has no preferred sign, to the last
// bit.
TEST(MonotoneBasis, IsOddForMirrorSymmetricAxes) {
  const MonotoneBasis basis(-2.5, 2.5, 14, SpringSymmetry::odd);
  EXPECT_EQ(basis.size(), 8);
  const Eigen::VectorXd increments = random_increments(basis, 5);
  const SpringSpline spring = basis.spring(increments);
  for (std::size_t i = 0, j = spring.force.size() - 1; i < spring.force.size(); ++i, --j) {
    EXPECT_EQ(spring.force[i], -spring.force[j]);
    EXPECT_EQ(spring.displacement[i], -spring.displacement[j]);
    EXPECT_EQ(spring.slope[i], spring.slope[j]);
  }
  for (double x = -2.5; x <= 2.5; x += 0.01) {  // round-off of sums of order 10
    EXPECT_NEAR(evaluate(spring, x).force, along(basis, increments, x) - basis.force_at_rest(increments),
                1e-13 * increments.sum());
  }
  const MonotoneBasis free(-2.5, 2.5, 14);
  Eigen::VectorXd untied(free.size());
  for (int i = 0; i < free.size(); ++i) untied(i) = increments(std::min(i, free.size() - 1 - i));
  EXPECT_NEAR(increments.dot(basis.roughness() * increments), untied.dot(free.roughness() * untied),
              1e-12 * untied.squaredNorm());
}

}  // namespace grouser
