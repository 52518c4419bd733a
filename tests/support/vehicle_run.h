#pragma once
#include <string>

#include "tests/support/vehicle_scene.h"

/// Scenes with the whole vehicle and what is measured on them.
namespace grouser::test {

/// test_data/scenarios/<name>.json as it is shipped.
[[nodiscard]] Scenario shipped_scenario(const std::string& name);

[[nodiscard]] VehicleScene at_rest(const Scenario& scenario);

/// Linear springs with dampers: a joint whose stiffness is one number.
[[nodiscard]] Bushing linear_bushing();

/// Without friction at wheels, rollers, idlers and teeth.
[[nodiscard]] Vehicle frictionless(Vehicle vehicle);

/// The reference vehicle at rest with linear_bushing() and no friction anywhere, the ground included.
[[nodiscard]] VehicleScene on_ice();

/// Another tensioner with the force of the present one: the assembled vehicle stays at rest.
void set_tensioner(double stiffness, VehicleScene& scene);

/// Whole vehicle: centre of mass in W and its velocity.
struct CenterOfMass {
  double mass = 0.0;
  Vector3d position = Vector3d::Zero(), velocity = Vector3d::Zero();
};
[[nodiscard]] CenterOfMass center_of_mass(const System& system, const State& state, const Workspace& work);

/// Normal forces of the ground on its points from their depth below z = 0 alone: at rest, where nothing is damped.
struct GroundPress {
  double force = 0.0;                ///< N, all points
  double moment = 0.0;               ///< N m, sum of x times force
  std::vector<double> wheel_forces;  ///< N, left track, weight of its links on the ground taken off; front to rear
};
[[nodiscard]] GroundPress press_on_ground(const System& system, const State& state);

}  // namespace grouser::test
