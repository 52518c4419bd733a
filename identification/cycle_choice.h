#pragma once
#include "identification/prepared_test.h"

namespace grouser {

/// Names transition cycles (between two amplitudes), numbers the amplitude blocks, and names the last cycles of a
/// record that run at another amplitude than the block they end.
void sort_into_blocks(PreparedTest& test);

/// Decides which measured cycles of sorted blocks enter the fit, and notes why the others do not.
void choose_cycles(PreparedTest& test);

}  // namespace grouser
