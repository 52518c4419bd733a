#pragma once
#include <vector>

#include "identification/axis_problem.h"
#include "model/fit.h"

namespace grouser {

/// Fills responses, backbone, tangent and preset of an axis: values by the fitted law, 95 % intervals by the draws, of
/// which every quantity is computed as the simulator would show it. All intervals come from the same draws:
///   half width = 1.96 sqrt(n / (n - 3) * variance of the draws about their mean),  n tests,
/// about the mean of the draws, which is closer to the truth than any one law, and widened on the side of the fitted
/// law's value where that lies outside.
/// The backbone is known up to a constant, since every test has its own force zero: its intervals are those of its
/// shape, about its own mean.
void state_intervals(const AxisData& data, const AxisLaw& law, const std::vector<AxisLaw>& draws, AxisFit& fit);

}  // namespace grouser
