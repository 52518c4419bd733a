#pragma once
#include <Eigen/Core>
#include <vector>

namespace grouser {

/// Minimiser of x'Gx/2 - h'x over x >= 0.
struct NnlsSolution {
  Eigen::VectorXd x;
  std::vector<int> free;      ///< indices with x > 0, ascending
  double kkt_residual = 0.0;  ///< see kkt_residual()
  int iterations = 0;
};

/// Lawson & Hanson (1974, ch. 23) on normal equations: gram = A'A (symmetric, positive semidefinite), rhs = A'b.
/// The columns are scaled to unit length inside; a column of zero length keeps x = 0.
/// `start`: indices that are expected to be free, as those of a similar problem are; only the effort depends on it.
/// Throws NumericalError when the active set does not settle or the optimum misses KKT by more than 1e-6.
[[nodiscard]] NnlsSolution solve_nnls(const Eigen::MatrixXd& gram, const Eigen::VectorXd& rhs,
                                      const std::vector<int>& start = {});

/// Largest violation of the optimality conditions at x: |gradient| where x > 0, descent direction where x = 0. Each
/// component is relative to the lengths of its column and of b (squared_b = b'b), so 1 means "parallel to the data".
[[nodiscard]] double kkt_residual(const Eigen::MatrixXd& gram, const Eigen::VectorXd& rhs, double squared_b,
                                  const Eigen::VectorXd& x);

}  // namespace grouser
