#pragma once
#include <vector>

#include "identification/prepared_test.h"

namespace grouser {

/// Looks for jumps of a measured clock (see parts_of) and for phase breaks: a cycle of another length than the others,
/// by more than 4 %, amid motion that one sine leaves more than 2 % of (I 4: either alone is noise or another wave
/// form). Where the rig file asks for `segment_at_jumps`, the broken cycle and the one after a jump are noted as not to
/// be used, and a correction says so. Else a warning, `time_gap` or `phase_break`, gives the place and the test is
/// unusable: no rate and no harmonic can be told across a jump.
void mark_jumps(PreparedTest& test, std::vector<FitWarning>& warnings, std::vector<AppliedCorrection>& corrections);

}  // namespace grouser
