#pragma once
#include "identification/prepared_test.h"
#include "model/bushing.h"
#include "model/fit.h"

namespace grouser {

/// Force of a law along a displacement history, by the functions that the simulator calls; states start at rest.
[[nodiscard]] std::vector<double> replay(const AxisLaw& law, const std::vector<double>& time,
                                         const std::vector<double>& displacement);

/// Measured against modelled: loop measures, errors and the curves of one test. `force`: the model's at every sample,
/// the sensor's zero aside; empty: there is no model for this test.
[[nodiscard]] TestFit evaluate_fit(const PreparedTest& test, std::vector<double> force);

}  // namespace grouser
