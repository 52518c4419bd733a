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

ShortRun follow(const System& system, const State& start, const AssemblyKnobs& knobs, double until,
                const std::function<void(const Stepper&)>& look) {
  Stepper stepper(system, start, knobs);
  ShortRun run;
  run.book = open_book(stepper.work().energy);
  while (stepper.state().time < until) {
    if (stepper.step(until) != StepStatus::ok) throw std::runtime_error("the run failed");
    book_step(run.book, stepper.work().energy, stepper.last_step());
    ++run.steps;
    if (look) look(stepper);
  }
  run.state = stepper.state();
  run.acceleration = stepper.acceleration();
  return run;
}

ShortRun run_for(const System& system, const State& start, double duration) {
  return follow(system, start, reference_scene().rest.knobs, duration);
}

State turned(const State& state, double angle) {
  State out = state;
  const Quaterniond turn(Eigen::AngleAxisd(angle, Vector3d::UnitZ()));
  const auto turn_fields = [&](Field& x, Field& y, int row) {
    for (int i = 0; i < x.length(); ++i) {
      const Vector3d v = turn * Vector3d(x[row][i], y[row][i], 0.0);
      x[row][i] = v.x();
      y[row][i] = v.y();
    }
  };
  for (int i = 0; i < state.position.length(); ++i) {
    LinkMotion link = get_link(state, i);
    link.position = turn * link.position;
    link.velocity = turn * link.velocity;
    link.orientation = turn * link.orientation;
    set_link(out, i, link);
  }
  for (int row = 0; row < state.history.anchor_x.components(); ++row) {
    turn_fields(out.history.anchor_x, out.history.anchor_y, row);
    turn_fields(out.history.stretch_x, out.history.stretch_y, row);
  }
  out.chassis.position = turn * state.chassis.position;
  out.chassis.velocity = turn * state.chassis.velocity;
  out.chassis.orientation = turn * state.chassis.orientation;
  return out;
}

}  // namespace grouser::test
