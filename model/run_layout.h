#pragma once
#include "model/run.h"

namespace grouser {

/// Throws InputError where channels have other rows than those of the folder's own vehicle, or samples whose times do
/// not rise: who reads a row may then count on its length.
void check_layout(const RunFolder& run);

}  // namespace grouser
