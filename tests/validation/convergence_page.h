#pragma once
#include <string>

#include "tests/validation/convergence_ladder.h"
#include "tests/validation/convergence_trajectory.h"

namespace grouser::validation {

/// The document docs/convergence.md, in Markdown. `fine`: the tolerance beside the chosen one in the figure of steps.
[[nodiscard]] std::string convergence_page(const Ladder& ladder, const TrajectoryErrors& errors,
                                           const std::string& fine);

}  // namespace grouser::validation
