#pragma once
#include <span>

#include "simulator/workspace.h"

namespace grouser {

/// Moments of eight joint springs and what the energy book needs.
struct SpringMoments {
  Lanes moment;       ///< N m along the joint's +axis
  Lanes energy;       ///< J
  Lanes loss;         ///< W, >= 0
  LaneMask bottomed;  ///< a gas unit without gas volume left: the figures are finite and mean nothing
};

/// Springs in the order given, eight a block.
[[nodiscard]] std::vector<SpringBlock> arrange_springs(std::span<const CompiledSuspension> springs);

/// Torsion bar: M = K (theta_f - theta), theta below horizontal, with bump and rebound stops.
/// Tensioner: the same law about the idler arm's pivot, free at `reference` of its side [rad], without stops.
/// Hydropneumatic unit: gas p V^n through the slider-crank, orifice with blow-off in parallel, linear part,
/// with the same stops. At another gas temperature than it was charged at the same mass of gas rests,
/// under the design load, at p_s in the volume V_s T / T_charge (ideal gas); fast strokes follow p V^n from there.
/// angle, rate of the joints about V's +y; results act on the arms.
[[nodiscard]] SpringMoments spring_moments(const SpringBlock& springs, const std::array<double, k_num_sides>& reference,
                                           const Lanes& angle, const Lanes& rate);

/// Pressure across orifice and blow-off valve at oil flow q [m^3/s, >= 0]; Pa.
[[nodiscard]] Lanes damper_pressure(const GasUnits& units, const Lanes& flow);

/// Stroke of the piston into the cylinder from the design angle, and its lever d stroke / d bump angle [m, m/rad].
struct Strokes {
  Lanes stroke, lever;
};
[[nodiscard]] Strokes piston_strokes(const GasUnits& units, const Lanes& bump_angle);

/// All joint springs into work.chassis.joint_torque and the energy book.
void suspension_forces(const AssemblyKnobs& knobs, const State& state, Workspace& work);

}  // namespace grouser
