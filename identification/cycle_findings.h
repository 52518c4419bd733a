#pragma once
#include <vector>

#include "identification/prepared_test.h"

namespace grouser {

/// What a test's cycles say about the rig and the specimen, a warning with the evidence for each: stated frequency or
/// amplitude that the data contradict, conditioning (Mullins), unsettled, transition and trailing cycles, softening
/// with temperature, backlash.
void find_in_cycles(const PreparedTest& test, const RigRecord& rig, std::vector<FitWarning>& warnings);

/// Conditioning is a property of the rubber: where more than three tests show it, one warning speaks for all.
void gather_common_findings(std::vector<FitWarning>& warnings);

}  // namespace grouser
