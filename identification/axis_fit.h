#pragma once
#include <Eigen/Core>

#include "identification/axis_problem.h"
#include "model/fit.h"

namespace grouser {

/// Optimal law of one axis.
struct AxisSolution {
  Dictionary dictionary;         ///< about 4 stops and 4 branches, ascending
  Eigen::VectorXd coefficients;  ///< >= 0, in the order of the dictionary's columns
  SolverSummary summary;
};

/// A rich fixed grid of yields and relaxation times inside what the data can tell apart (I 2): yields up to 0.6 of the
/// largest half stroke, times up to 1/(2 pi lowest frequency); beyond, an element is the spring in disguise. `spread`
/// moves the grids (1, 1 = the nominal one); `extra_intervals` the knots.
[[nodiscard]] Dictionary full_dictionary(const AxisData& data, double yield_spread = 1.0, double time_spread = 1.0,
                                         int extra_intervals = 0);

/// Fits the axis: non-negative least squares on the full dictionary; its elements merged to a few; their yields and
/// relaxation times by variable projection and all coefficients together in Ceres; optimality checked after every
/// solve. Throws NumericalError when Ceres does not converge or the optimality conditions fail.
[[nodiscard]] AxisSolution fit_axis(const AxisData& data);

/// Sum of all blocks' moments, each with its weight (empty = 1), regularised.
[[nodiscard]] Eigen::MatrixXd weighted_sum(const std::vector<Eigen::MatrixXd>& blocks,
                                           const std::vector<double>& weights, const Dictionary& dictionary);

}  // namespace grouser
