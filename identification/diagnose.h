#pragma once
#include <vector>

#include "identification/prepared_test.h"

namespace grouser {

/// Looks for sensor and rig faults in a test whose cycles are measured and sorted; adds a warning with the evidence for
/// each. Marks the test unusable when its two channels cannot be what the file says (swapped, reversed).
void diagnose(PreparedTest& test, const RigRecord& rig, std::vector<FitWarning>& warnings);

}  // namespace grouser
