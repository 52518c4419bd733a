#include "simulator/failures.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <span>
#include <vector>

namespace grouser {
namespace {

constexpr std::array<const char*, 3> k_directions{"x", "y", "z"};
constexpr const char* k_joint_force = "force in the joint ahead of it along";

/// One number of a part: "left/arm_1: its rate" 3.2 "rad/s".
struct Symptom {
  Part part;
  std::string quantity;
  double value = 0.0;
  const char* unit = "";
  [[nodiscard]] std::string text() const { return fmt::format("its {} is {:.4g} {}", quantity, value, unit); }
};
using Found = std::optional<Symptom>;

/// Three rows of a field over links or joints, as a vector: "velocity along" x.
struct LinkVector {
  const Field* field;
  int first;
  const char* what;
  const char* unit;
};

std::string component(const char* what, Eigen::Index c) {
  return fmt::format("{} {}", what, k_directions[static_cast<std::size_t>(c)]);
}

/// Array indices of all links and connectors.
std::vector<int> all_links(const System& system) {
  std::vector<int> all;
  for (const CompiledTrack& track : system.tracks) {
    for (const LinkBodies& bodies : track.bodies) {
      for (int i = bodies.offset; i < bodies.offset + bodies.count; ++i) all.push_back(i);
    }
  }
  return all;
}

const CompiledTrack& track_of(const System& system, int link) {
  return system.tracks[link < system.tracks[1].offset ? 0 : 1];
}

Vector3d vector_at(const Field& field, int first, int i) {
  return {field[first][i], field[first + 1][i], field[first + 2][i]};
}

Found not_finite(const Part& part, const Vector3d& v, const char* what, const char* unit) {
  for (int c = 0; c < 3; ++c) {
    if (!std::isfinite(v[c])) return Symptom{part, component(what, c), v[c], unit};
  }
  return std::nullopt;
}

Found not_finite(const System& system, std::span<const LinkVector> all) {
  for (const LinkVector& of : all) {
    for (const int i : all_links(system)) {
      if (Found found = not_finite({i, -1}, vector_at(*of.field, of.first, i), of.what, of.unit)) return found;
    }
  }
  return std::nullopt;
}

/// One number a joint.
Found not_finite(const Eigen::VectorXd& joints, const char* what, const char* unit) {
  for (Eigen::Index j = 0; j < joints.size(); ++j) {
    if (!std::isfinite(joints[j])) return Symptom{{-1, static_cast<int>(j)}, what, joints[j], unit};
  }
  return std::nullopt;
}

Found state_not_finite(const System& system, const State& state) {
  const std::array<LinkVector, 3> links{{{&state.position, 0, "position along", "m"},
                                         {&state.velocity, 0, "velocity along", "m/s"},
                                         {&state.angular_velocity, 0, "angular velocity about", "rad/s"}}};
  if (Found found = not_finite(system, links)) return found;
  if (Found found = not_finite(Part{}, state.chassis.position, "position along", "m")) return found;
  if (Found found = not_finite(Part{}, state.chassis.velocity, "velocity along", "m/s")) return found;
  if (Found found = not_finite(Part{}, state.chassis.angular_velocity, "angular velocity about", "rad/s")) return found;
  if (Found found = not_finite(state.chassis.angle, "angle", "rad")) return found;
  return not_finite(state.chassis.rate, "angular velocity about its joint", "rad/s");
}

Found forces_not_finite(const System& system, const State& state, const Workspace& work) {
  const std::array<LinkVector, 9> forces{
      {{&state.history.deflection, 0, "deflection of the joint ahead of it along", "m"},
       {&state.history.deflection, 3, "deflection of the joint ahead of it about", "rad"},
       {&work.contact_force_W[0], 0, "contact force of road wheels along", "N"},
       {&work.contact_force_W[1], 0, "contact force of support rollers along", "N"},
       {&work.contact_force_W[2], 0, "contact force of the idler along", "N"},
       {&work.contact_force_W[3], 0, "contact force of the sprocket along", "N"},
       {&work.contact_force_W[4], 0, "contact force of its guide along", "N"},
       {&work.contact_force_W[5], 0, "contact force of the ground along", "N"},
       {&work.joint_force_W, 0, k_joint_force, "N"}}};
  if (Found found = not_finite(system, forces)) return found;
  return not_finite(work.chassis.joint_torque, "torque of its spring and damper", "N m");
}

/// A joint about which what it carries has no inertia to speak of.
Found singular_joint(const System& system, const TreeWorkspace& work) {
  for (std::size_t j = 0; j < system.tree.bodies.size(); ++j) {
    if (system.tree.bodies[j].prescribed) continue;
    const auto [block, lane] = work.place[j];
    const BlockState& state = work.states[block];
    const double inertia = in_lane(lane, state.axis_W).dot(in_lane(lane, state.projected));
    const double compliance = state.compliance[lane];
    if (inertia > 0.0 && std::isfinite(compliance)) continue;
    if (std::isnan(inertia)) continue;  // follows from another
    return Symptom{{-1, static_cast<int>(j)}, "inertia about its joint", inertia, "kg m2"};
  }
  return std::nullopt;
}

Found acceleration_not_finite(const System& system, const Acceleration& acceleration) {
  const std::array<LinkVector, 2> links{{{&acceleration.linear, 0, "acceleration along", "m/s2"},
                                         {&acceleration.angular, 0, "angular acceleration about", "rad/s2"}}};
  if (Found found = not_finite(system, links)) return found;
  const TreeAcceleration& chassis = acceleration.chassis;
  if (Found found = not_finite(chassis.joint, "angular acceleration about its joint", "rad/s2")) return found;
  if (Found found = not_finite(Part{}, chassis.linear, "acceleration along", "m/s2")) return found;
  return not_finite(Part{}, chassis.angular, "angular acceleration about", "rad/s2");
}

Symptom fastest_turn(const System& system, const State& state) {
  Symptom fastest;
  for (const int i : all_links(system)) {
    Eigen::Index about = 0;
    const Vector3d w = vector_at(state.angular_velocity, 0, i);
    if (w.cwiseAbs().maxCoeff(&about) < std::abs(fastest.value)) continue;
    fastest = {{i, -1}, component("angular velocity about", about), w[about], "rad/s"};
  }
  return fastest;
}

/// By how much the accelerations of the part with the largest error change in the step that was tried.
Symptom largest_jump(const System& system, const Stepper& stepper) {
  const Part part = stepper.worst();
  const Acceleration &from = stepper.acceleration(), &to = stepper.trial().acceleration;
  if (part.body >= 0)
    return {part, "angular acceleration about its joint", to.chassis.joint[part.body] - from.chassis.joint[part.body],
            "rad/s2"};
  Vector3d linear = to.chassis.linear - from.chassis.linear, angular = to.chassis.angular - from.chassis.angular;
  double arm = 1.0;  // m, at which turning counts as moving
  if (part.link >= 0) {
    linear = vector_at(to.linear, 0, part.link) - vector_at(from.linear, 0, part.link);
    angular = vector_at(to.angular, 0, part.link) - vector_at(from.angular, 0, part.link);
    arm = 0.5 * track_of(system, part.link).pitch;
  }
  Eigen::Index along = 0, about = 0;
  const double moved = linear.cwiseAbs().maxCoeff(&along), turned = angular.cwiseAbs().maxCoeff(&about);
  if (moved >= arm * turned) return {part, component("acceleration along", along), linear[along], "m/s2"};
  return {part, component("angular acceleration about", about), angular[about], "rad/s2"};
}

/// What a user can do about steps that are too long for the vehicle.
std::string remedy(const System& system, const Stepper& stepper) {
  const IntegratorOptions& options = system.scenario.integrator;
  const double stable = options.stability_fraction * stepper.stable_step();
  const std::string stiffest = fmt::format("{}, which is stable below {:.3g} ms only",
                                           part_name(system, stepper.bounding()), 1e3 * stepper.stable_step());
  if (options.fixed_step > stable)
    return fmt::format("reduce integrator.fixed_step ({:.3g} ms) or leave it out: the step is bounded by {}",
                       1e3 * options.fixed_step, stiffest);
  if (options.min_step > stable)
    return fmt::format(
        "integrator.min_step ({:.3g} ms) is too long for {}; it is too stiff for its mass and inertia: check these and "
        "the stiffness of what it meets",
        1e3 * options.min_step, stiffest);
  return "look there for a mass, inertia or stiffness far from its neighbours', and for a jump of the drive or an "
         "obstacle that it meets too fast; shorter steps (integrator.max_step, velocity_tolerance) tell one from the "
         "other";
}

/// The first quantity that is no number, and what that means; nothing where all are.
std::optional<std::string> no_number(const System& system, const Stepper& stepper, const Trial& at) {
  const auto because = [&](const Symptom& symptom, const std::string& why) {
    return fmt::format("{}: {}: {}", part_name(system, symptom.part), symptom.text(), why);
  };
  const auto diverged = [&](const Symptom& symptom) {
    return because(symptom, "the run diverged; " + remedy(system, stepper));
  };
  if (const Found found = state_not_finite(system, at.state)) return diverged(*found);
  if (const Found found = singular_joint(system, at.work.chassis))
    return because(*found,
                   "the mass matrix is singular; give it, or what it carries, the mass and inertia of a real body");
  if (const Found found = forces_not_finite(system, at.state, at.work)) {
    if (!found->quantity.starts_with(k_joint_force) ||
        track_of(system, found->part.link).joint != JointForm::double_pin)
      return diverged(*found);
    return because(*found,
                   "its connector finds no place where the rubber of both pins balances; check the bushing's springs "
                   "and the connector's length");
  }
  if (const Found found = acceleration_not_finite(system, at.acceleration)) return diverged(*found);
  return std::nullopt;
}

std::string no_number(const System& system, const Stepper& stepper) {
  const Trial started{stepper.state(), stepper.work(), stepper.acceleration()};  // the first evaluation is not checked
  if (const std::optional<std::string> text = no_number(system, stepper, started)) return *text;
  if (const std::optional<std::string> text = no_number(system, stepper, stepper.trial())) return *text;
  return "the chassis: the sum of all accelerations passes the largest number: the run diverged; " +
         remedy(system, stepper);
}

std::string turned_too_far(const System& system, const Stepper& stepper) {
  const State& tried = stepper.trial().state;
  if (state_not_finite(system, tried)) return no_number(system, stepper);
  const Symptom symptom = fastest_turn(system, tried);
  return fmt::format("{}: {}, more than half a radian in a step of {:.3g} ms: the run diverged; {}",
                     part_name(system, symptom.part), symptom.text(), 1e3 * (tried.time - stepper.state().time),
                     remedy(system, stepper));
}

std::string underflow(const System& system, const Stepper& stepper) {
  const Symptom jump = largest_jump(system, stepper);
  return fmt::format(
      "{}: its {} jumps by {:.4g} {} within the least step (integrator.min_step, {:.3g} ms), more than the tolerances "
      "let pass: step underflow; {}",
      part_name(system, jump.part), jump.quantity, jump.value, jump.unit, 1e3 * system.scenario.integrator.min_step,
      remedy(system, stepper));
}

std::string bottomed(const System& system, const Stepper& stepper) {
  const Part arm = stepper.worst();
  const TreeState& chassis = stepper.trial().state.chassis;
  return fmt::format(
      "{}: its gas unit bottomed at an angle of {:.3f} rad, which it reached with {:.3g} rad/s: the gas is pressed to "
      "nothing; give it more gas or charge, an earlier or stiffer bump stop, or take the obstacle slower",
      part_name(system, arm), chassis.angle[arm.body], chassis.rate[arm.body]);
}

}  // namespace

std::string part_name(const System& system, const Part& part) {
  return part.body < 0 ? link_name(system, part.link) : system.tree.bodies[static_cast<std::size_t>(part.body)].name;
}

std::string step_failure(const System& system, const Stepper& stepper, StepStatus status) {
  switch (status) {
    case StepStatus::turned_too_far:
      return turned_too_far(system, stepper);
    case StepStatus::underflow:
      return underflow(system, stepper);
    case StepStatus::bottomed:
      return bottomed(system, stepper);
    default:
      return no_number(system, stepper);
  }
}

}  // namespace grouser
