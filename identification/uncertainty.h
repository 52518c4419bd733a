#pragma once
#include <vector>

#include "identification/axis_fit.h"
#include "model/fit.h"

namespace grouser {

/// Fills parameters, covariance, condition number, responses, backbone, tangent and what cannot be identified; returns
/// the draws behind the intervals (see draws.h, bands.h). Errors are common to all samples of a test (remounting gain,
/// left-over conditioning), so everything rests on tests as replicates: parameters by the sandwich over tests, all that
/// can be observed by the draws. `law`: of the solution. Deterministic: fixed seed.
[[nodiscard]] std::vector<AxisLaw> estimate_uncertainty(const AxisData& data, const AxisSolution& solution,
                                                        const AxisLaw& law, AxisFit& fit);

}  // namespace grouser
