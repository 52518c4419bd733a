#include "identification/nnls.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>

#include "model/errors.h"
#include "tests/support/floating_point_traps.h"

namespace grouser {
namespace {

struct Problem {
  Eigen::MatrixXd a;
  Eigen::VectorXd b;
  [[nodiscard]] Eigen::MatrixXd gram() const { return a.transpose() * a; }
  [[nodiscard]] Eigen::VectorXd rhs() const { return a.transpose() * b; }
  [[nodiscard]] double cost(const Eigen::VectorXd& x) const { return (a * x - b).squaredNorm(); }
};

Problem random_problem(unsigned seed, int rows, int columns) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Problem problem{Eigen::MatrixXd(rows, columns), Eigen::VectorXd(rows)};
  for (double& value : problem.a.reshaped()) value = normal(random);
  for (double& value : problem.b) value = normal(random);
  return problem;
}

TEST(NonNegativeLeastSquares, RecoversAPlantedSolutionWithItsZeros) {
  Problem problem = random_problem(1, 60, 12);
  Eigen::VectorXd planted = Eigen::VectorXd::Zero(12);
  planted(2) = 3.0;
  planted(5) = 1e-3;
  planted(11) = 40.0;
  problem.b = problem.a * planted;
  const NnlsSolution solution = solve_nnls(problem.gram(), problem.rhs());
  EXPECT_LT((solution.x - planted).norm(),
            1e-9 * planted.norm());  // normal equations square the condition number (about 10)
}

TEST(NonNegativeLeastSquares, HoldsAtZeroWhatWantsToBeNegative) {
  // min (x - 1)^2 + (y + 2)^2 over x, y >= 0
  const NnlsSolution solution = solve_nnls(Eigen::Matrix2d::Identity(), Eigen::Vector2d(1.0, -2.0));
  EXPECT_DOUBLE_EQ(solution.x(0), 1.0);
  EXPECT_EQ(solution.x(1), 0.0);
  EXPECT_EQ(solution.free, std::vector<int>{0});
}

TEST(NonNegativeLeastSquares, MeetsTheOptimalityConditionsAndNoNeighbourIsBetter) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const Problem problem = random_problem(seed, 30, 20);
    const NnlsSolution solution = solve_nnls(problem.gram(), problem.rhs());
    EXPECT_GE(solution.x.minCoeff(), 0.0);
    EXPECT_LT(kkt_residual(problem.gram(), problem.rhs(), problem.b.squaredNorm(), solution.x), 1e-9);
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    for (int k = 0; k < 50; ++k) {
      Eigen::VectorXd near = solution.x;
      for (double& value : near) value = std::max(0.0, value + 1e-3 * normal(random));
      EXPECT_GE(problem.cost(near), problem.cost(solution.x) * (1.0 - 1e-12));
    }
  }
}

TEST(NonNegativeLeastSquares, DoesNotCareForTheUnitsOfItsColumns) {
  const Problem problem = random_problem(7, 40, 10);
  Eigen::VectorXd unit(10);
  for (int j = 0; j < 10; ++j) unit(j) = std::pow(10.0, j - 5);
  const Eigen::VectorXd plain = solve_nnls(problem.gram(), problem.rhs()).x;
  const Eigen::MatrixXd gram = unit.asDiagonal() * problem.gram() * unit.asDiagonal();
  const Eigen::VectorXd scaled = solve_nnls(gram, unit.cwiseProduct(problem.rhs())).x;
  EXPECT_LT((scaled.cwiseProduct(unit) - plain).norm(), 1e-9 * plain.norm());
}

TEST(NonNegativeLeastSquares, RefusesNumbersThatAreNone) {
  const test::WithoutTraps of_none;
  const Problem problem = random_problem(7, 20, 4);
  Eigen::MatrixXd gram = problem.gram();
  gram(2, 2) = std::numeric_limits<double>::infinity();
  EXPECT_THROW((void)solve_nnls(gram, problem.rhs()), NumericalError);
  Eigen::VectorXd rhs = problem.rhs();
  rhs(1) = std::nan("");
  EXPECT_THROW((void)solve_nnls(problem.gram(), rhs), NumericalError);
}

TEST(NonNegativeLeastSquares, ReachesTheSameOptimumFromAnyStart) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Problem problem = random_problem(seed, 30, 20);
    const NnlsSolution cold = solve_nnls(problem.gram(), problem.rhs());
    const NnlsSolution warm = solve_nnls(problem.gram(), problem.rhs(), cold.free);
    const NnlsSolution odd = solve_nnls(problem.gram(), problem.rhs(), {0, 3, 5, 7, 11, 19});
    EXPECT_EQ(warm.iterations, 0);
    EXPECT_LT((warm.x - cold.x).norm(), 1e-9 * cold.x.norm());
    EXPECT_LT((odd.x - cold.x).norm(), 1e-9 * cold.x.norm());
  }
}

TEST(KktResidual, SeesAPointThatIsNotOptimal) {
  const Eigen::Vector2d rhs(1.0, -2.0);
  EXPECT_GT(kkt_residual(Eigen::Matrix2d::Identity(), rhs, rhs.squaredNorm(), Eigen::Vector2d(0.9, 0.0)),
            0.04);  // free, gradient left
  EXPECT_GT(kkt_residual(Eigen::Matrix2d::Identity(), rhs, rhs.squaredNorm(), Eigen::Vector2d(0.0, 0.0)),
            0.4);  // zero, wants to grow
}

}  // namespace
}  // namespace grouser
