#pragma once
#include "tests/validation/table.h"

/// One function a family of comparisons; each runs its own scenes and adds its rows.
namespace grouser::validation {

void add_trees(Chapter& chapter);          ///< rigid-body trees against published numbers and other solvers
void add_vehicle_rest(Chapter& chapter);   ///< the vehicle at rest: counts, loads, sag
void add_vehicle_modes(Chapter& chapter);  ///< its heave and pitch frequencies
void add_vehicle_track(Chapter& chapter);  ///< its track: hoop tension, waves, chordal action
void add_vehicle_drive(Chapter& chapter);  ///< run A: speed, link passing, way, brake, coasting, energy
void add_vehicle_turn(Chapter& chapter);   ///< run B, and what must not matter
void add_vehicle_slope(Chapter& chapter);  ///< parked and sliding
void add_integrator(Chapter& chapter);     ///< Chung-Lee's spectrum, order, trajectories; other integrators; tops
void add_chains(Chapter& chapter);         ///< chains of links: momentum, hoop, catenary, vibration, waves
void add_bushings(Chapter& chapter);       ///< stops and branches of the rubber's law
void add_contacts(Chapter& chapter);       ///< restitution, stick and slide, elastic forces
void add_suspension(Chapter& chapter);     ///< torsion bar, gas unit, damper

}  // namespace grouser::validation
