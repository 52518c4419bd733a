#pragma once
#include <Eigen/Core>

#include "identification/axis_problem.h"
#include "model/fit.h"

namespace grouser {

/// Where yields [m or rad] and relaxation times [s] may go.
struct PolishBounds {
  double yield_low = 0.0, yield_high = 0.0;
  double time_low = 0.0, time_high = 0.0;
};

/// Moves yields and relaxation times to the least squares optimum by variable projection (Golub & Pereyra 1973;
/// Kaufman's Jacobian): Ceres on their logarithms, non-negative least squares for the coefficients inside. Throws
/// NumericalError when Ceres does not converge.
SolverSummary refine_nonlinear(const AxisData& data, const PolishBounds& bounds, Dictionary& dictionary);

/// The same optimum with the free coefficients as unknowns too; those at zero stay there. `coefficients` is the start
/// and the result. Throws NumericalError when Ceres does not converge.
SolverSummary polish_jointly(const AxisData& data, const PolishBounds& bounds, Dictionary& dictionary,
                             Eigen::VectorXd& coefficients);

}  // namespace grouser
