#pragma once
#include "simulator/workspace.h"

namespace grouser {

/// Moment of one joint spring against the joint's positive rotation, and what the energy book needs.
struct SpringMoment {
  double moment = 0.0;    ///< N m along +axis
  double energy = 0.0;    ///< J
  double loss = 0.0;      ///< W, >= 0
  bool bottomed = false;  ///< a gas unit without gas volume left: the figures are finite and mean nothing
};

/// Torsion bar: M = K (theta_f - theta), theta below horizontal (D 4.1), with bump and rebound stops.
/// Hydropneumatic unit: gas p V^n through the slider-crank, orifice with blow-off in parallel, linear part
/// (D 4.2, 4.3). At another gas temperature than it was charged at the same mass of gas rests, under the design load,
/// at p_s in the volume V_s T / T_charge (ideal gas); fast strokes follow p V^n from there. angle, rate of the joint
/// about V's +y; result acts on the arm.
[[nodiscard]] SpringMoment station_moment(const CompiledSuspension& spring, double angle, double rate);

/// Tensioner about the idler arm's pivot, free at `reference`.
[[nodiscard]] SpringMoment tensioner_moment(const CompiledSuspension& spring, double reference, double angle,
                                            double rate);

/// Pressure across orifice and blow-off valve at oil flow q [m^3/s, >= 0]; Pa.
[[nodiscard]] double damper_pressure(const Hydropneumatic& unit, double flow);

/// Stroke of the piston into the cylinder from the design angle, and its lever d stroke / d bump angle [m, m/rad].
struct Stroke {
  double stroke = 0.0, lever = 0.0;
};
[[nodiscard]] Stroke piston_stroke(const Hydropneumatic& unit, double bump_angle);

/// All joint springs into work.chassis.joint_torque and the energy book.
void suspension_forces(const System& system, const AssemblyKnobs& knobs, const State& state, Workspace& work);

}  // namespace grouser
