#pragma once
#include "simulator/workspace.h"

namespace grouser {

/// Rotation matrices and world angular velocities of all links.
void place_links(const System& system, const State& state, Workspace& work);

/// Six-axis bushing wrenches of every joint (paper eq. 7 with the law of model/bushing_law.h).
///
/// Single pin: joint i connects link i (frame i, the joint frame of the paper, with the bore) to link i+1 (frame j,
/// carrying the pin). Double pin: two such bushings and a connector between them (simulator/connector.h). d_R is the
/// position of the pin less the groove, in frame i. The rotation from i to j is split into a twist phi about the pin
/// axis (the hinge, any angle) and a swing; the moments follow from the generalised rates by virtual work, so the
/// wrench is exactly conservative plus dissipative. Equal and opposite force at one common point: momentum is
/// conserved.
///
/// before: the last accepted state (its history is the rubber's memory). h: length of the step from `before` to
/// `state`, 0 for an evaluation without a step. Writes state.history's rubber parts and the joint arrays of `work`, and
/// begins the links' force and torque sums.
void bushing_forces(const System& system, const AssemblyKnobs& knobs, const History& before, double h, State& state,
                    Workspace& work);

/// Puts connectors that are bodies in line with their bores, moving with their shoes.
void place_connectors(const System& system, State& state);

}  // namespace grouser
