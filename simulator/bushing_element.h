#pragma once
#include "simulator/workspace.h"

/// The rubber bushing as an element between two rigid bodies, eight at once: the bore stands in the body `own` (frame
/// i, the joint frame of the paper), the pin in the body `next` (frame j).
namespace grouser {

using AxisLanes = std::array<Lanes, k_num_axes>;

/// Pose and motion of eight bodies in W.
struct BodyLanes {
  Lanes3 position, x, y, z;          ///< centre [m] and axes
  std::array<Lanes, 4> orientation;  ///< body -> W, w, x, y, z
  Lanes3 velocity, angular_velocity;
};
/// Eight neighbours out of the link arrays.
[[nodiscard]] inline BodyLanes load_bodies(const State& state, const Workspace& work, int i) {
  return {load3(state.position, i),
          load_axis(work, 0, i),
          load_axis(work, 1, i),
          load_axis(work, 2, i),
          {load(state.orientation[0] + i), load(state.orientation[1] + i), load(state.orientation[2] + i),
           load(state.orientation[3] + i)},
          load3(state.velocity, i),
          load3(work.angular_velocity_W, i)};
}
/// The same bodies in frames turned by half a turn about their own z: x and y reversed. A bushing in the rear bore of a
/// shoe is one in a front bore, so turned.
[[nodiscard]] BodyLanes half_turned(const BodyLanes& bodies);

/// Where bore and pin stand on their bodies.
struct ElementShape {
  double groove = 0.0;  ///< m, middle of the bore ahead of own's centre
  double pin = 0.0;     ///< m, pin ahead of next's centre
};

/// Deflections and their rates, and the lever arms that turn generalised forces into a wrench.
struct ElementKinematics {
  AxisLanes deflection;                ///< pin less groove in the frame of own [m]; swing rx, rz and hinge ry [rad]
  AxisLanes rate;                      ///< m/s, rad/s
  Lanes3 pin_from_own, pin_from_next;  ///< pin less body centre, W
  Lanes3 jacobian_rx, jacobian_ry,
      jacobian_rz;  ///< rate of each angle over the angular velocity of j against i, frame j
};
[[nodiscard]] ElementKinematics element_kinematics(const BodyLanes& own, const BodyLanes& next,
                                                   const ElementShape& shape);

/// What the energy book takes from eight bushings.
struct ElementEnergy {
  Lanes stored = 0.0, power = 0.0, step_loss = 0.0;
};

/// Restoring forces dual to the deflections, their dynamic tangents (every stop taken as sticking) and energies.
struct RubberLoad {
  AxisLanes force, stiffness, damping;
  AxisLanes moved;  ///< by what the deflection that the rubber feels grew in the step
  ElementEnergy energy;
};

/// The bushings of one track over a step: what they remember of the state before, and where they write their memory.
struct RubberStep {
  const CompiledTrack& track;
  const std::array<AxisBranches, k_num_axes>& branch_step;  ///< for h
  const History& before;
  History& after;
  double h;     ///< s
  bool memory;  ///< false: the rubber is taken as relaxed, with a plain damper
};

/// The constants of an axis' branches for a step of length h; `branches` has a place for each, and may hold those
/// already: most steps are as long as the one before.
void prepare_branches(const CompiledAxis& axis, double h, AxisBranches& branches);

/// The law of eight bushings whose rows in the arrays of joints begin at `joint`. With a radial play c the rubber feels
/// the deflection beyond it, (x, z) (1 - c / r) with r^2 = x^2 + z^2 > c^2, and nothing within; its forces are dual to
/// (x, z). Beyond the stop angle the hinge carries stop_stiffness (angle - stop_angle) more. Writes their rows in
/// step.after.
[[nodiscard]] RubberLoad rubber_load(const RubberStep& step, const ElementKinematics& k, int joint);

/// Tangent stiffness of `rubber` in this very step: slipping stops carry none [N/m, N m/rad].
[[nodiscard]] AxisLanes slipping_tangent(const RubberStep& step, const RubberLoad& rubber, int joint);

/// Force on `next` at the pin and its moments about both centres, all in W: `own` takes their opposite.
struct ElementWrench {
  Lanes3 force, torque_next, torque_own;
};
[[nodiscard]] ElementWrench element_wrench(const BodyLanes& own, const BodyLanes& next, const ElementKinematics& k,
                                           const AxisLanes& force);

/// Arc tangent of eight numbers up to k_largest_tangent in size to 2 ulp (rational approximation of Cephes atan; wrong
/// by 1e-10 at 1).
inline constexpr double k_largest_tangent = 0.66;
[[nodiscard]] Lanes arc_tangent(const Lanes& x);

}  // namespace grouser
