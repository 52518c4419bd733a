#include "identification/polish.h"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "identification/axis_fit.h"
#include "identification/nnls.h"
#include "model/errors.h"

namespace grouser {
namespace {

constexpr int k_max_iterations = 200;
constexpr double k_function_tolerance = 1e-8;  // relative cost; far below the cost of a 1 % change of any element
constexpr double k_parameter_tolerance = 1e-7;
constexpr double k_factor_ridge = 1e-13;

std::vector<double> log_parameters(const Dictionary& dictionary) {
  std::vector<double> result;
  for (const double yield : dictionary.yields) result.push_back(std::log(yield));
  for (const double time : dictionary.relaxation_times) result.push_back(std::log(time));
  return result;
}

Dictionary with_parameters(const Dictionary& dictionary, const double* logs) {
  Dictionary moved = dictionary;
  for (double& yield : moved.yields) yield = std::exp(*logs++);
  for (double& time : moved.relaxation_times) time = std::exp(*logs++);
  return moved;
}

// Square root of the moments: residuals of the whole campaign, rotated into as many rows as there are columns. The
// rotation differs from point to point, which least squares does not see: cost, gradient and Gauss-Newton matrix are
// those of the samples.
Eigen::MatrixXd square_root(const Eigen::MatrixXd& moments) {
  const Eigen::VectorXd length = moments.diagonal().cwiseMax(1e-300).cwiseSqrt();
  Eigen::MatrixXd scaled = length.cwiseInverse().asDiagonal() * moments * length.cwiseInverse().asDiagonal();
  scaled.diagonal().array() += k_factor_ridge;
  const Eigen::LLT<Eigen::MatrixXd> factor(scaled);
  if (factor.info() != Eigen::Success)
    throw NumericalError("the normal equations of the fit are not positive definite");
  return Eigen::MatrixXd(factor.matrixU()) * length.asDiagonal();
}

// A dictionary's campaign in compressed form; columns [linear | derivative | force].
struct Compressed {
  Eigen::MatrixXd moments, root;
  Compressed(const AxisData& data, const Dictionary& dictionary)
      : moments(weighted_sum(block_moments(data, dictionary, true), {}, dictionary)), root(square_root(moments)) {}

  [[nodiscard]] Eigen::VectorXd residual(const Eigen::VectorXd& c) const {
    return root.rightCols(1) - root.leftCols(c.size()) * c;
  }
  // d residual / d log parameter for coefficients c, of which the last num_nonlinear belong to the elements
  [[nodiscard]] Eigen::MatrixXd nonlinear_jacobian(const Eigen::VectorXd& c, int num_nonlinear) const {
    return -root.middleCols(c.size(), num_nonlinear) * c.tail(num_nonlinear).asDiagonal();
  }
};

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

class ProjectedCost : public ceres::CostFunction {
 public:
  ProjectedCost(const AxisData& data, const Dictionary& dictionary) : data_(&data), dictionary_(&dictionary) {
    set_num_residuals(dictionary.num_linear() + dictionary.num_nonlinear() + 1);
    mutable_parameter_block_sizes()->push_back(dictionary.num_nonlinear());
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Dictionary dictionary = with_parameters(*dictionary_, parameters[0]);
    const int n = dictionary.num_linear(), s = dictionary.num_nonlinear();
    const Compressed problem(*data_, dictionary);
    const NnlsSolution inner = solve_nnls(problem.moments.topLeftCorner(n, n), problem.moments.col(n + s).head(n));
    Eigen::Map<Eigen::VectorXd>(residuals, num_residuals()) = problem.residual(inner.x);
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    const Eigen::MatrixXd direct = problem.nonlinear_jacobian(inner.x, s);
    const Eigen::MatrixXd free_columns = problem.root(Eigen::all, inner.free);
    const Eigen::MatrixXd normal = problem.moments(inner.free, inner.free);
    Eigen::Map<RowMatrix>(jacobians[0], num_residuals(), s) =
        direct - free_columns * normal.ldlt().solve(free_columns.transpose() * direct);
    return true;
  }

 private:
  const AxisData* data_;
  const Dictionary* dictionary_;
};

// Unknowns: free coefficients relative to their start, then the logarithms.
class JointCost : public ceres::CostFunction {
 public:
  JointCost(const AxisData& data, const Dictionary& dictionary, const Eigen::VectorXd& start, std::vector<int> free)
      : data_(&data), dictionary_(&dictionary), start_(&start), free_(std::move(free)) {
    set_num_residuals(dictionary.num_linear() + dictionary.num_nonlinear() + 1);
    mutable_parameter_block_sizes()->push_back(static_cast<int>(free_.size()));
    if (dictionary.num_nonlinear() > 0) mutable_parameter_block_sizes()->push_back(dictionary.num_nonlinear());
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const int s = dictionary_->num_nonlinear();
    const Dictionary dictionary = s > 0 ? with_parameters(*dictionary_, parameters[1]) : *dictionary_;
    const Compressed problem(*data_, dictionary);
    Eigen::VectorXd c = Eigen::VectorXd::Zero(start_->size());
    for (std::size_t i = 0; i < free_.size(); ++i) c(free_[i]) = parameters[0][i] * (*start_)(free_[i]);
    Eigen::Map<Eigen::VectorXd>(residuals, num_residuals()) = problem.residual(c);
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) {
      const Eigen::VectorXd scale = (*start_)(free_);
      Eigen::Map<RowMatrix>(jacobians[0], num_residuals(), static_cast<Eigen::Index>(free_.size())) =
          -problem.root(Eigen::all, free_) * scale.asDiagonal();
    }
    if (s > 0 && jacobians[1] != nullptr) {
      Eigen::Map<RowMatrix>(jacobians[1], num_residuals(), s) = problem.nonlinear_jacobian(c, s);
    }
    return true;
  }

 private:
  const AxisData* data_;
  const Dictionary* dictionary_;
  const Eigen::VectorXd* start_;
  std::vector<int> free_;
};

void set_bounds(ceres::Problem& problem, std::vector<double>& logs, const Dictionary& dictionary,
                const PolishBounds& bounds) {
  const std::size_t stops = dictionary.yields.size();
  for (std::size_t i = 0; i < logs.size(); ++i) {
    const double low = std::log(i < stops ? bounds.yield_low : bounds.time_low);
    const double high = std::log(i < stops ? bounds.yield_high : bounds.time_high);
    logs[i] = std::clamp(logs[i], low, high);
    problem.SetParameterLowerBound(logs.data(), static_cast<int>(i), low);
    problem.SetParameterUpperBound(logs.data(), static_cast<int>(i), high);
  }
}

SolverSummary run(ceres::Problem& problem) {
  ceres::Solver::Options options;
  options.max_num_iterations = k_max_iterations;
  options.function_tolerance = k_function_tolerance;
  options.parameter_tolerance = k_parameter_tolerance;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (summary.termination_type != ceres::CONVERGENCE)
    throw NumericalError("the fit did not converge: " + summary.message);
  return {ceres::TerminationTypeToString(summary.termination_type), static_cast<int>(summary.iterations.size()),
          summary.initial_cost, summary.final_cost, 0.0};
}

}  // namespace

SolverSummary refine_nonlinear(const AxisData& data, const PolishBounds& bounds, Dictionary& dictionary) {
  if (dictionary.num_nonlinear() == 0) return {"CONVERGENCE", 0, 0.0, 0.0, 0.0};
  std::vector<double> logs = log_parameters(dictionary);
  ceres::Problem problem;
  problem.AddResidualBlock(new ProjectedCost(data, dictionary), nullptr, logs.data());
  set_bounds(problem, logs, dictionary, bounds);
  SolverSummary summary = run(problem);
  dictionary = with_parameters(dictionary, logs.data());
  return summary;
}

SolverSummary polish_jointly(const AxisData& data, const PolishBounds& bounds, Dictionary& dictionary,
                             Eigen::VectorXd& coefficients) {
  std::vector<int> free;
  for (int j = 0; j < coefficients.size(); ++j) {
    if (coefficients(j) > 0.0) free.push_back(j);
  }
  std::vector<double> relative(free.size(), 1.0), logs = log_parameters(dictionary);
  std::vector<double*> unknowns{relative.data()};
  if (!logs.empty()) unknowns.push_back(logs.data());
  ceres::Problem problem;
  problem.AddResidualBlock(new JointCost(data, dictionary, coefficients, free), nullptr, unknowns);
  for (std::size_t i = 0; i < free.size(); ++i)
    problem.SetParameterLowerBound(relative.data(), static_cast<int>(i), 0.0);
  if (!logs.empty()) set_bounds(problem, logs, dictionary, bounds);
  SolverSummary summary = run(problem);
  for (std::size_t i = 0; i < free.size(); ++i) coefficients(free[i]) *= relative[i];
  dictionary = with_parameters(dictionary, logs.data());
  return summary;
}

}  // namespace grouser
