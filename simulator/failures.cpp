#include "simulator/failures.h"

#include <fmt/format.h>

namespace grouser {
namespace {

const char* quantity(StepStatus status) {
  switch (status) {
    case StepStatus::turned_too_far:
      return "it turned by more than half a radian in one step: the run diverged";
    case StepStatus::underflow:
      return "its local error asks for a step below integrator.min_step: step underflow";
    case StepStatus::bottomed:
      return "its gas unit bottomed, the gas is pressed to nothing (charge, bump stop, speed over the obstacle)";
    default:
      return "the acceleration is no longer finite: the run diverged";
  }
}

}  // namespace

std::string part_name(const System& system, const Part& part) {
  return part.body < 0 ? link_name(system, part.link) : system.tree.bodies[static_cast<std::size_t>(part.body)].name;
}

std::string step_failure(const System& system, const Stepper& stepper, StepStatus status) {
  return fmt::format("{}: {}", part_name(system, stepper.worst()), quantity(status));
}

}  // namespace grouser
