#pragma once
#include "simulator/workspace.h"

namespace grouser {

/// Rotation matrices and world angular velocities of all links.
void place_links(const System& system, const State& state, Workspace& work);

/// Six-axis bushing wrenches of every joint (paper eq. 7 with the law of model/bushing_law.h).
///
/// Joint i connects link i (frame i, the joint frame of the paper) to link i+1 (frame j, carrying the pin). d_R is the
/// position of the pin less the groove, in frame i. The rotation from i to j is split into a twist phi about the pin
/// axis (the hinge, any angle) and a swing; the moments follow from the generalised rates by virtual work, so the
/// wrench is exactly conservative plus dissipative. Equal and opposite force at one common point: momentum is
/// conserved.
///
/// before: the last accepted state (its history is the rubber's memory). h: length of the step from `before` to
/// `state`, 0 for an evaluation without a step. Writes state.history's rubber parts and the joint arrays of `work`.
void bushing_forces(const System& system, const AssemblyKnobs& knobs, const History& before, double h, State& state,
                    Workspace& work);

/// Adds the joint wrenches to the links' force and torque sums.
void sum_joint_forces(const System& system, Workspace& work);

/// Arc tangent of eight numbers in [-0.66, 0.66] to 2 ulp (rational approximation of Cephes atan; wrong by 1e-10 at 1).
[[nodiscard]] Lanes arc_tangent(const Lanes& x);

}  // namespace grouser
