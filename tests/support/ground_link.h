#pragma once
#include <cmath>
#include <stdexcept>

#include "tests/support/scenes.h"

/// One free link on the ground, 20 m ahead of the chassis, which falls freely meanwhile.
namespace grouser::test {

inline constexpr int k_ground_link = 2;

/// Ground tilted by `slope` [rad] about y: gravity leans forward instead.
inline System slope_system(double slope, double friction, double step) {
  Scenario scenario = parked(bare_vehicle(8), no_bushing(), 9.81);
  scenario.terrain.friction = friction;
  scenario.integrator.fixed_step = step;
  System system = compile(scenario);
  system.gravity_W = 9.81 * Vector3d(std::sin(slope), 0.0, -std::cos(slope));
  return system;
}

/// The link stands as deep as its weight asks for.
inline State standing_link(const System& system) {
  const CompiledTrack& track = system.tracks[0];
  State state = strewn_state(system);
  LinkMotion link;
  const double depth = -track.mass * system.gravity_W.z() / (6.0 * track.ground.stiffness);
  link.position = {20.0, 0.0, track.ground_depth - depth};
  set_link(state, k_ground_link, link);
  return state;
}

/// Upward speed [m/s] after the link came down flat at 1 m/s, for which the restitution is stated; no gravity.
inline double rebound_speed(double restitution, double step) {
  Vehicle vehicle = bare_vehicle(8);
  for (RunningGear& gear : vehicle.sides) gear.track.ground_contact.restitution = restitution;
  Scenario scenario = parked(vehicle, no_bushing(), 0.0);
  scenario.integrator.fixed_step = step;
  const System system = compile(scenario);
  State state = strewn_state(system);
  LinkMotion link;
  link.position = {20.0, 0.0, system.tracks[0].ground_depth + 1e-3};
  link.velocity = {0.0, 0.0, -1.0};
  set_link(state, k_ground_link, link);
  Stepper stepper(system, state, {});
  while (stepper.state().time < 0.03) {
    if (stepper.step(1e9) != StepStatus::ok) throw std::runtime_error("a step of the falling link failed");
  }
  return get_link(stepper.state(), k_ground_link).velocity.z();
}

/// Link's motion at `time`, on from wherever the stepper stands.
inline LinkMotion ground_link_at(Stepper& stepper, double time) {
  while (stepper.state().time < time) {
    if (stepper.step(1e9) != StepStatus::ok) throw std::runtime_error("a step of the link on the ground failed");
  }
  return get_link(stepper.state(), k_ground_link);
}
/// Its mean place along x over the last 0.2 s before `until`.
inline double mean_place(Stepper& stepper, double until) {
  ground_link_at(stepper, until - 0.2);
  double sum = 0.0;
  int count = 0;
  while (stepper.state().time < until) {
    if (stepper.step(1e9) != StepStatus::ok) throw std::runtime_error("a step of the link on the ground failed");
    sum += get_link(stepper.state(), k_ground_link).position.x(), ++count;
  }
  return sum / count;
}

}  // namespace grouser::test
