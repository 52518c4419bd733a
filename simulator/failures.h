#pragma once
#include <string>

#include "simulator/step.h"

/// What stands in messages about runs that fail.
namespace grouser {

/// "link 12 of the left track", "left/arm_3", "the chassis".
[[nodiscard]] std::string part_name(const System& system, const Part& part);

/// Part, quantity, value and remedy of a step that failed: "link 12 of the left track: its angular velocity about y
/// ...". Of what is no number the first in the order of the evaluation is named, for the rest follows from it.
[[nodiscard]] std::string step_failure(const System& system, const Stepper& stepper, StepStatus status);

}  // namespace grouser
