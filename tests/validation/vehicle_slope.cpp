#include <cmath>

#include "tests/support/vehicle_run.h"
#include "tests/validation/chapters.h"

namespace grouser::validation {
namespace {

using namespace grouser::test;

/// The system on the same slope with another friction.
System with_friction(const System& system, double friction) {
  Scenario scenario = system.scenario;
  scenario.terrain.friction = friction;
  return compile(scenario);
}

/// Velocity of the centre of mass along a vector.
double speed_along(const System& system, const Stepper& stepper, const Vector3d& direction) {
  return direction.dot(center_of_mass(system, stepper.state(), stepper.work()).velocity);
}

}  // namespace

void add_vehicle_slope(Chapter& chapter) {
  const VehicleScene scene = at_rest(shipped_scenario("parked_slope_30"));
  const double slope = scene.system.scenario.terrain.slope, angle = std::atan(slope);
  const double gravity = scene.system.scenario.gravity;
  const Vector3d down(-std::cos(angle), 0.0, -std::sin(angle));
  chapter.section("Slope of 30 %",
                  "The shipped vehicle, sprockets locked: it parks with friction 0.7 for 60 s; then friction is taken "
                  "away from under it at once, to just above and to well below the slope.");

  const Vector3d start = scene.rest.state.chassis.position;
  double creep = 0.0;
  follow(scene.system, scene.rest.state, scene.rest.knobs, 60.0,
         [&](const Stepper& stepper) { creep = std::max(creep, (stepper.state().chassis.position - start).norm()); });
  chapter.add({"way of the hull in 60 s, friction 0.7", "mm", 0.0, 1e3 * creep, within(1.0, "settling of rubber"),
               "statics: tan α < μ"});

  const System holding = with_friction(scene.system, 0.32);
  double speed = 0.0;
  follow(holding, scene.rest.state, scene.rest.knobs, 2.0,
         [&](const Stepper& stepper) { speed = speed_along(holding, stepper, down); });
  chapter.add({"speed after 2 s, friction 0.32", "mm/s", 0.0, 1e3 * speed, within(5.0, "rocking on the suspension"),
               "statics: tan α < μ"});

  const double friction = 0.2, expected = gravity * (std::sin(angle) - friction * std::cos(angle));
  const System sliding = with_friction(scene.system, friction);
  const Vector3d up(-std::sin(angle), 0.0, std::cos(angle));
  double time = 0.0, along[2] = {0.0, 0.0}, across[2] = {0.0, 0.0};
  follow(sliding, scene.rest.state, scene.rest.knobs, 2.0, [&](const Stepper& stepper) {
    const std::size_t which = stepper.state().time <= 0.5 ? 0 : 1;
    if (which == 0) time = stepper.state().time;
    along[which] = speed_along(sliding, stepper, down);
    across[which] = speed_along(sliding, stepper, up);
  });
  const double found = (along[1] - along[0]) / (2.0 - time), bounce = (across[1] - across[0]) / (2.0 - time);
  chapter.add({"acceleration from 0.5 s to 2 s, friction 0.2", "m/s²", expected, found,
               fraction(0.01, expected, "bounce on the suspension changes the load"),
               "closed form, g (sin α - μ cos α)"});
  const double loaded = expected - friction * bounce;
  chapter.add({"the same, with the load that the bounce makes", "m/s²", loaded, found,
               fraction(1e-6, loaded, "round-off over 15 000 steps"),
               "closed form, g sin α - μ (g cos α + a_n), a_n: measured acceleration off the slope"});
}

}  // namespace grouser::validation
