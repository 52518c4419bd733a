#include "identification/nnls.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <string>

#include "model/errors.h"

namespace grouser {
namespace {

constexpr double k_gradient_tolerance = 1e-10;  // of the largest scaled right-hand side: round-off of forming A'b
constexpr double k_kkt_limit = 1e-6;

Eigen::VectorXd solve_on(const Eigen::MatrixXd& gram, const Eigen::VectorXd& rhs, const std::vector<int>& passive) {
  const Eigen::MatrixXd block = gram(passive, passive);
  const Eigen::VectorXd part = rhs(passive);
  return block.ldlt().solve(part);
}

// Steps from x towards the unconstrained optimum of the passive set, dropping what would turn negative, until all stay
// positive.
void settle(const Eigen::MatrixXd& gram, const Eigen::VectorXd& rhs, std::vector<int>& passive, Eigen::VectorXd& x) {
  while (!passive.empty()) {
    const Eigen::VectorXd target = solve_on(gram, rhs, passive);
    double fraction = 1.0;
    for (std::size_t i = 0; i < passive.size(); ++i) {
      const double now = x(passive[i]), then = target(static_cast<Eigen::Index>(i));
      if (then <= 0.0) fraction = std::min(fraction, now / (now - then));
    }
    std::vector<int> kept;
    for (std::size_t i = 0; i < passive.size(); ++i) {
      double& value = x(passive[i]);
      const double then = target(static_cast<Eigen::Index>(i));
      const bool blocking = then <= 0.0 && value / (value - then) <= fraction * (1.0 + 1e-12);
      value = blocking ? 0.0 : value + fraction * (then - value);
      if (value > 0.0)
        kept.push_back(passive[i]);
      else
        value = 0.0;
    }
    const bool done = kept.size() == passive.size();
    passive = std::move(kept);
    if (done) return;
  }
}

// The start's optimum, without those of it that want to be negative.
void settle_start(const Eigen::MatrixXd& gram, const Eigen::VectorXd& rhs, std::vector<int>& passive,
                  Eigen::VectorXd& x) {
  for (bool all_positive = false; !all_positive && !passive.empty();) {
    const Eigen::VectorXd target = solve_on(gram, rhs, passive);
    std::vector<int> kept;
    for (std::size_t i = 0; i < passive.size(); ++i) {
      if (target(static_cast<Eigen::Index>(i)) > 0.0) kept.push_back(passive[i]);
    }
    all_positive = kept.size() == passive.size();
    passive = std::move(kept);
    if (all_positive) x(passive) = target;
  }
}

}  // namespace

double kkt_residual(const Eigen::MatrixXd& gram, const Eigen::VectorXd& rhs, double squared_b,
                    const Eigen::VectorXd& x) {
  const Eigen::VectorXd descent = rhs - gram * x;
  double worst = 0.0;
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    if (gram(j, j) <= 0.0) continue;
    const double violation = x(j) > 0.0 ? std::abs(descent(j)) : std::max(descent(j), 0.0);
    worst = std::max(worst, violation / std::sqrt(gram(j, j) * squared_b));
  }
  return worst;
}

NnlsSolution solve_nnls(const Eigen::MatrixXd& gram, const Eigen::VectorXd& rhs, const std::vector<int>& start) {
  // No comparison with a NaN is true: it would pass for optimal below.
  if (!gram.allFinite() || !rhs.allFinite()) {
    throw NumericalError("the normal equations hold numbers that are infinite or none");
  }
  const Eigen::Index n = rhs.size();
  Eigen::VectorXd length(n);
  for (Eigen::Index j = 0; j < n; ++j) length(j) = gram(j, j) > 0.0 ? std::sqrt(gram(j, j)) : 0.0;
  const Eigen::VectorXd inverse = length.unaryExpr([](double v) { return v > 0.0 ? 1.0 / v : 0.0; });
  const Eigen::MatrixXd scaled = inverse.asDiagonal() * gram * inverse.asDiagonal();
  const Eigen::VectorXd target = inverse.cwiseProduct(rhs);
  const double tolerance = k_gradient_tolerance * target.cwiseAbs().maxCoeff();

  NnlsSolution solution;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  std::vector<int> passive;
  for (const int j : start) {
    if (length(j) > 0.0) passive.push_back(j);
  }
  settle_start(scaled, target, passive, x);
  std::vector<char> barred(static_cast<std::size_t>(n), 0);  // entered and left at once: round-off, not descent
  for (const int limit = 10 * static_cast<int>(n) + 100; solution.iterations < limit; ++solution.iterations) {
    const Eigen::VectorXd descent = target - scaled * x;
    int entering = -1;
    for (int j = 0; j < n; ++j) {
      const bool candidate = x(j) == 0.0 && length(j) > 0.0 && !barred[static_cast<std::size_t>(j)];
      if (candidate && descent(j) > (entering < 0 ? tolerance : descent(entering))) entering = j;
    }
    if (entering < 0) break;
    passive.push_back(entering);
    x(entering) = 1e-300;  // > 0, so that `settle` measures the step from the boundary
    settle(scaled, target, passive, x);
    if (x(entering) == 0.0)
      barred[static_cast<std::size_t>(entering)] = 1;
    else
      std::fill(barred.begin(), barred.end(), 0);
  }
  solution.x = inverse.cwiseProduct(x);
  for (int j = 0; j < n; ++j) {
    if (x(j) > 0.0) solution.free.push_back(j);
  }
  const double squared_b = std::max(target.squaredNorm(), 1e-300);
  solution.kkt_residual = kkt_residual(gram, rhs, squared_b, solution.x);
  if (!(solution.kkt_residual <= k_kkt_limit)) {
    throw NumericalError("non-negative least squares misses optimality by " + std::to_string(solution.kkt_residual) +
                         " after " + std::to_string(solution.iterations) + " steps");
  }
  return solution;
}

}  // namespace grouser
