#pragma once
#include "simulator/bushing_element.h"

/// The double pin: a joint of two shoes through a rigid connector that carries a pin at each end, each pin in the
/// rubber of its shoe's bore. Frames: the joint's middle stands half a pitch from either shoe's centre; the two
/// pins stand half a connector length before and behind it, along the connector's x axis. Both bores are in the shoes,
/// so that both bushings have the shoe as `own` and the connector as `next`; the rear one (in the shoe ahead) is seen
/// in half-turned frames, which makes its x the tension too.
namespace grouser {

/// Eight bushings between shoes and connectors.
struct PinBushings {
  ElementKinematics kinematics;
  RubberLoad rubber;
  ElementWrench wrench;  ///< on the connectors
};

/// Eight joints: connectors and their bushings in the front bores of links i and in the rear bores of links i+1.
struct DoublePinJoints {
  BodyLanes connector;
  PinBushings front, rear;
};

/// Rows of eight joints in the arrays of joints.
struct DoublePinRows {
  int front = 0, rear = 0;
};

/// Connectors half way between the two shoes and in line with their bores: where equal bushings without hinge moments
/// hold them. Motion: the mean of the shoes'.
[[nodiscard]] BodyLanes connectors_in_line(const CompiledTrack& track, const BodyLanes& link, const BodyLanes& next);

/// Both bushings of eight joints for connectors where they are.
void evaluate_bushings(const RubberStep& step, const BodyLanes& link, const BodyLanes& next, DoublePinRows rows,
                       DoublePinJoints& joints);

/// Static condensation: the massless connector stands where the wrenches of its two bushings cancel, all six components
/// (Newton with their tangents, from connectors_in_line), and moves as it must for them to go on cancelling. The
/// transverse stiffness T / l of a pulled connector is part of it. Nothing of the connector is remembered but what its
/// bushings' rubber remembers, each its own. Only the first `valid` joints count. Where slipping stops keep
/// Newton from settling, what is left below 10 um and 1e-4 rad is shared by the shoes; a connector further from any
/// equilibrium gets a wrench that is not a number, and the step is tried again, shorter.
[[nodiscard]] DoublePinJoints balance_connectors(const RubberStep& step, const BodyLanes& link, const BodyLanes& next,
                                                 DoublePinRows rows, int valid);

}  // namespace grouser
