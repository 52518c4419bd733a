#pragma once
#include <Eigen/Core>
#include <limits>

#include "identification/block_moments.h"
#include "model/fit.h"

namespace grouser {

/// Where the nonlinear parameters may go.
struct PolishBounds {
  double yield_low = 0.0, yield_high = 0.0;    ///< m or rad
  double time_low = 0.0, time_high = 0.0;      ///< s
  double growth_low = 0.0, growth_high = 0.0;  ///< 1/m^2 or 1/rad^2
};

struct PolishOptions {
  double function_tolerance = 1e-8;  ///< relative change of the cost at which the search stops
  int max_iterations = 200;
  /// `gradient` above which the parameters are moved one by one before the search goes on; see polish().
  double gradient_limit = std::numeric_limits<double>::infinity();
};

/// A law after the search for its nonlinear parameters.
struct PolishedLaw {
  Dictionary dictionary;
  Eigen::VectorXd coefficients;       ///< >= 0, non-negative least squares for this dictionary
  std::vector<int> free;              ///< numbers of the coefficients > 0
  std::vector<BlockMoments> moments;  ///< split_moments() with derivatives, for this dictionary
  SolverSummary summary;              ///< termination as Ceres states it; kkt_residual of the linear part
  double gradient = 0.0;              ///< nonlinear optimality, see below
  bool converged = false;
};

/// Moves the nonlinear parameters to the least squares optimum by variable projection (Golub & Pereyra 1973; Kaufman's
/// Jacobian): Ceres on their logarithms, non-negative least squares for the coefficients inside. `gradient` is the
/// largest cosine between the residual and its derivative by a parameter that is not held by its bound: moving that
/// parameter alone could lower the cost by the fraction gradient^2.
/// The cost has kinks, where a yield lets one more sample slip, and Ceres' joint steps stop at one although the other
/// parameters are short of their optimum. Above `gradient_limit` each parameter is therefore moved by itself, the best
/// move is taken and Ceres goes on from there. Where no such move gains gradient_limit^2 of the cost, what the best one
/// does gain is the measure: `gradient` is then its square root, for a derivative at a kink is that of one side only.
[[nodiscard]] PolishedLaw polish(const AxisData& data, const PolishBounds& bounds, const Dictionary& start,
                                 const PolishOptions& options = {});

}  // namespace grouser
