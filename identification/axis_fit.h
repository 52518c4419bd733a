#pragma once
#include <Eigen/Core>

#include "identification/axis_problem.h"
#include "identification/block_moments.h"
#include "identification/polish.h"
#include "model/fit.h"

namespace grouser {

/// Optimal law of one axis.
struct AxisSolution {
  Dictionary dictionary;         ///< a few stops and branches, ascending
  Eigen::VectorXd coefficients;  ///< >= 0, in the order of the dictionary's columns
  SolverSummary summary;
  std::vector<LawCandidate> selection;   ///< sizes of law that were compared
  std::vector<double> left_out_nrmse;    ///< of each of replicates(data), by this law fitted to all the others
  std::vector<Eigen::MatrixXd> moments;  ///< block_moments(data, dictionary, true)
};

/// A rich fixed grid of yields and relaxation times inside what the data can tell apart (I 2): yields up to 0.6 of the
/// largest half stroke, times up to 1/(2 pi lowest frequency); beyond, an element is the spring in disguise. `spread`
/// moves the grids (1, 1 = the nominal one); `extra_intervals` the knots.
[[nodiscard]] Dictionary full_dictionary(const AxisData& data, double yield_spread = 1.0, double time_spread = 1.0,
                                         int extra_intervals = 0);

/// Fits the axis: the size of the law is chosen by leave-one-out error and its yields and relaxation times are searched
/// from several starts on thinned data; then the law is polished on all samples. Optimality is checked after every
/// solve. Throws NumericalError when Ceres does not converge or the optimality conditions fail.
[[nodiscard]] AxisSolution fit_axis(const AxisData& data, const PolishOptions& options = {});

}  // namespace grouser
