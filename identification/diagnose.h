#pragma once
#include <vector>

#include "identification/prepared_test.h"

namespace grouser {

/// Looks for sensor and rig faults in a test whose cycles are measured and sorted; adds a warning with the evidence for
/// each. Marks the test unusable when its two channels cannot be what the file says (swapped, reversed).
void diagnose(PreparedTest& test, const RigRecord& rig, std::vector<FitWarning>& warnings);

/// Single samples of a record that leap out of the range of all others: a warning with the first row of each channel.
void find_spikes(const RigTest& test, std::vector<FitWarning>& warnings);

}  // namespace grouser
