#pragma once
#include "identification/prepared_test.h"
#include "model/bushing.h"
#include "model/fit.h"

namespace grouser {

/// Force of a law along a displacement history, by the functions that the simulator calls; states start at rest.
[[nodiscard]] std::vector<double> replay(const AxisLaw& law, const std::vector<double>& time,
                                         const std::vector<double>& displacement);

/// Measured against fitted: loop measures, errors and the curves of one test. law = nullptr: the test is not in a fit.
[[nodiscard]] TestFit evaluate_fit(const PreparedTest& test, const AxisLaw* law);

}  // namespace grouser
