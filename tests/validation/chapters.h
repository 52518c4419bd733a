#pragma once
#include "tests/validation/table.h"

/// One function a family of comparisons; each runs its own scenes and adds its rows.
namespace grouser::validation {

void add_trees(Chapter& chapter);  ///< rigid-body trees against published numbers and other solvers

}  // namespace grouser::validation
