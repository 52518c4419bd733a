#include "tests/support/vehicle_scene.h"

#include <stdexcept>

namespace grouser::test {

const VehicleScene& reference_scene() {
  static const VehicleScene scene = [] {
    VehicleScene made{compile(parked(reference_vehicle(), rubber_bushing(), 9.81)), {}};
    made.rest = assemble(made.system);
    return made;
  }();
  return scene;
}

System driven(double left, double right) {
  System system = reference_scene().system;
  system.scenario.drive = {DriveTable{{0.0, 1.0}, {0.0, left}}, DriveTable{{0.0, 1.0}, {0.0, right}}};
  return system;
}

ShortRun run_for(const System& system, const State& start, double duration) {
  Stepper stepper(system, start, reference_scene().rest.knobs);
  ShortRun run;
  run.book = open_book(stepper.work().energy);
  while (stepper.state().time < duration) {
    if (stepper.step(duration) != StepStatus::ok) throw std::runtime_error("the run failed");
    book_step(run.book, stepper.work().energy, stepper.last_step());
    ++run.steps;
  }
  run.state = stepper.state();
  run.acceleration = stepper.acceleration();
  return run;
}

}  // namespace grouser::test
