#pragma once
#include <string>

#include "simulator/step.h"

/// What stands in messages about runs that fail.
namespace grouser {

/// "link 12 of the left track", "left/arm_3", "the chassis".
[[nodiscard]] std::string part_name(const System& system, const Part& part);

/// Part and quantity on which a step failed: "link 12 of the left track: ...".
[[nodiscard]] std::string step_failure(const System& system, const Stepper& stepper, StepStatus status);

}  // namespace grouser
