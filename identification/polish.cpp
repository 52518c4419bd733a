#include "identification/polish.h"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "identification/nnls.h"
#include "model/errors.h"

namespace grouser {
namespace {

constexpr double k_parameter_tolerance = 1e-7;
constexpr double k_at_bound = 1e-9;  // distance in the logarithm
constexpr std::array k_moves{-0.05, -0.01, -0.002,
                             0.002, 0.01,  0.05};  // of one logarithm: across a kink, and beyond it
constexpr int k_most_moves = 20;

std::vector<double> log_parameters(const Dictionary& dictionary) {
  std::vector<double> result;
  for (const double yield : dictionary.yields) result.push_back(std::log(yield));
  for (const double time : dictionary.relaxation_times) result.push_back(std::log(time));
  if (dictionary.yield_growth > 0.0) result.push_back(std::log(dictionary.yield_growth));
  return result;
}

Dictionary with_parameters(const Dictionary& dictionary, const std::vector<double>& logs) {
  Dictionary moved = dictionary;
  auto log = logs.begin();
  for (double& yield : moved.yields) yield = std::exp(*log++);
  for (double& time : moved.relaxation_times) time = std::exp(*log++);
  if (moved.yield_growth > 0.0) moved.yield_growth = std::exp(*log++);
  return moved;
}

struct Range {
  double low = 0.0, high = 0.0;
};

// Of the logarithms, in their order.
std::vector<Range> ranges(const Dictionary& dictionary, const PolishBounds& bounds) {
  std::vector<Range> result;
  // Bounds of what the dictionary has none of may be zero.
  const auto add = [&result](std::size_t count, double low, double high) {
    if (count > 0) result.resize(result.size() + count, {std::log(low), std::log(high)});
  };
  add(dictionary.yields.size(), bounds.yield_low, bounds.yield_high);
  add(dictionary.relaxation_times.size(), bounds.time_low, bounds.time_high);
  add(dictionary.yield_growth > 0.0 ? 1 : 0, bounds.growth_low, bounds.growth_high);
  return result;
}

// Square root of the moments: residuals of the whole campaign, rotated into as many rows as there are columns. The
// rotation differs from point to point, which least squares does not see: cost, gradient and Gauss-Newton matrix are
// those of the samples. Pivoted, because two elements may meet at a bound.
Eigen::MatrixXd square_root(const Eigen::MatrixXd& moments) {
  const Eigen::VectorXd length = moments.diagonal().cwiseMax(1e-300).cwiseSqrt();
  const Eigen::LDLT<Eigen::MatrixXd> factor(length.cwiseInverse().asDiagonal() * moments *
                                            length.cwiseInverse().asDiagonal());
  Eigen::MatrixXd root = factor.transpositionsP().transpose() * Eigen::MatrixXd(factor.matrixL());
  root *= factor.vectorD().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  return root.transpose() * length.asDiagonal();
}

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// The campaign seen through one dictionary, with the coefficients that fit it best.
struct Projection {
  std::vector<double> logs;
  Dictionary dictionary;
  std::vector<BlockMoments> blocks;
  Eigen::MatrixXd moments;  // sum of all blocks, regularised
  NnlsSolution inner;

  Projection(const AxisData& data, Dictionary d, std::vector<double> at, const std::vector<int>& start)
      : logs(std::move(at)), dictionary(std::move(d)), blocks(split_moments(data, dictionary, true)) {
    moments = sum_of(blocks);
    regularise(moments, dictionary);
    const int n = dictionary.num_linear();
    inner = solve_nnls(moments.topLeftCorner(n, n), moments.col(moments.cols() - 1).head(n), start);
  }

  // Derivative of the residual by the logarithms, without what the free coefficients take up at once (Kaufman).
  // `root`: square_root(moments).
  [[nodiscard]] Eigen::MatrixXd jacobian(const Eigen::MatrixXd& root) const {
    const Eigen::MatrixXd weights = derivative_weights(dictionary, inner.x);
    const Eigen::MatrixXd direct = -root.middleCols(inner.x.size(), weights.rows()) * weights;
    const Eigen::MatrixXd columns = root(Eigen::all, inner.free);
    const Eigen::MatrixXd normal = moments(inner.free, inner.free);
    return direct - columns * normal.ldlt().solve(columns.transpose() * direct);
  }
  [[nodiscard]] Eigen::VectorXd residual(const Eigen::MatrixXd& root) const {
    return root.rightCols(1) - root.leftCols(inner.x.size()) * inner.x;
  }
};

// Ceres asks for the cost of a trial point first and for its derivatives when it has taken it: one pass serves both.
class ProjectedCost : public ceres::CostFunction {
 public:
  ProjectedCost(const AxisData& data, const Dictionary& start) : data_(&data), start_(&start) {
    const Eigen::Index derivatives = derivative_weights(start, Eigen::VectorXd::Zero(start.num_linear())).rows();
    set_num_residuals(start.num_linear() + static_cast<int>(derivatives) + 1);
    mutable_parameter_block_sizes()->push_back(start.num_nonlinear());
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Projection& here = at({parameters[0], parameters[0] + start_->num_nonlinear()});
    const Eigen::MatrixXd root = square_root(here.moments);
    Eigen::Map<Eigen::VectorXd>(residuals, num_residuals()) = here.residual(root);
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<RowMatrix>(jacobians[0], num_residuals(), start_->num_nonlinear()) = here.jacobian(root);
    }
    return true;
  }

  [[nodiscard]] const Projection& at(const std::vector<double>& logs) const {
    if (!last_ || last_->logs != logs) {
      const std::vector<int> start = last_ ? last_->inner.free : std::vector<int>{};
      last_ = std::make_unique<Projection>(*data_, with_parameters(*start_, logs), logs, start);
    }
    return *last_;
  }

 private:
  const AxisData* data_;
  const Dictionary* start_;
  mutable std::unique_ptr<Projection> last_;
};

// Ceres' outcome; `logs` is moved to the optimum.
ceres::Solver::Summary minimise(ProjectedCost& cost, const std::vector<Range>& bounds, const PolishOptions& options,
                                std::vector<double>& logs) {
  ceres::Problem::Options ownership;
  ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(ownership);
  problem.AddResidualBlock(&cost, nullptr, logs.data());
  for (std::size_t i = 0; i < logs.size(); ++i) {
    logs[i] = std::clamp(logs[i], bounds[i].low, bounds[i].high);
    problem.SetParameterLowerBound(logs.data(), static_cast<int>(i), bounds[i].low);
    problem.SetParameterUpperBound(logs.data(), static_cast<int>(i), bounds[i].high);
  }
  ceres::Solver::Options solver;
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = options.function_tolerance;
  solver.parameter_tolerance = k_parameter_tolerance;
  solver.linear_solver_type = ceres::DENSE_QR;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  return summary;
}

double largest_gradient(const Projection& here, const std::vector<Range>& bounds) {
  const Eigen::MatrixXd root = square_root(here.moments);
  const Eigen::MatrixXd jacobian = here.jacobian(root);
  const Eigen::VectorXd residual = here.residual(root), gradient = jacobian.transpose() * residual;
  double worst = 0.0;
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const bool held_low = here.logs[i] <= bounds[i].low + k_at_bound && gradient(at) > 0.0;
    const bool held_high = here.logs[i] >= bounds[i].high - k_at_bound && gradient(at) < 0.0;
    const double length = jacobian.col(at).norm();
    if (held_low || held_high || !(length > 0.0)) continue;
    worst = std::max(worst, std::abs(gradient(at)) / (length * residual.norm()));
  }
  return worst;
}

double twice_cost(const Projection& here) {
  const Eigen::Index n = here.inner.x.size(), force = here.moments.cols() - 1;
  return here.moments(force, force) - here.moments.col(force).head(n).dot(here.inner.x);
}

struct Move {
  std::vector<double> logs;
  double gain = 0.0;  // fraction of the cost
};

// The move of one parameter alone that lowers the cost most.
Move best_single_move(const ProjectedCost& cost, const std::vector<Range>& bounds, const std::vector<double>& logs) {
  const double before = twice_cost(cost.at(logs));
  Move best{logs, 0.0};
  for (std::size_t i = 0; i < logs.size(); ++i) {
    for (const double step : k_moves) {
      std::vector<double> moved = logs;
      moved[i] = std::clamp(logs[i] + step, bounds[i].low, bounds[i].high);
      const double gain = 1.0 - twice_cost(cost.at(moved)) / before;
      if (gain > best.gain) best = {std::move(moved), gain};
    }
  }
  return best;
}

}  // namespace

PolishedLaw polish(const AxisData& data, const PolishBounds& bounds, const Dictionary& start,
                   const PolishOptions& options) {
  ProjectedCost cost(data, start);
  std::vector<double> logs = log_parameters(start);
  const std::vector<Range> limits = ranges(start, bounds);
  PolishedLaw result{start, {}, {}, {}, {"CONVERGENCE", 0, 0.0, 0.0, 0.0}, 0.0, true};
  for (int moves = 0; !logs.empty(); ++moves) {
    const ceres::Solver::Summary summary = minimise(cost, limits, options, logs);
    result.converged = summary.termination_type == ceres::CONVERGENCE;
    result.summary.termination = ceres::TerminationTypeToString(summary.termination_type);
    result.summary.iterations += static_cast<int>(summary.iterations.size());
    if (moves == 0) result.summary.initial_cost = summary.initial_cost;
    result.gradient = largest_gradient(cost.at(logs), limits);
    if (!(result.gradient > options.gradient_limit) || moves == k_most_moves) break;
    Move move = best_single_move(cost, limits, logs);
    if (move.gain < options.gradient_limit * options.gradient_limit) {
      result.gradient = std::sqrt(move.gain);
      break;
    }
    logs = std::move(move.logs);
  }
  const Projection& here = cost.at(logs);
  const Eigen::Index n = here.inner.x.size(), force = here.moments.cols() - 1;
  result.dictionary = here.dictionary;
  result.coefficients = here.inner.x;
  result.free = here.inner.free;
  result.moments = here.blocks;
  result.summary.final_cost = 0.5 * twice_cost(here);
  result.summary.kkt_residual = kkt_residual(here.moments.topLeftCorner(n, n), here.moments.col(force).head(n),
                                             here.moments(force, force), result.coefficients);
  return result;
}

}  // namespace grouser
