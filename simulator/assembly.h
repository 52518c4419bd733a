#pragma once
#include "model/progress.h"
#include "simulator/step.h"

namespace grouser {

/// A vehicle at rest: tracks closed at the asked pre-tension, everything in static equilibrium.
struct Assembled {
  State state;          ///< time 0
  AssemblyKnobs knobs;  ///< tensioner references found; everything else at its value for a run
  struct SideResult {
    double tension = 0.0;      ///< N, mean of the upper run
    double idler_angle = 0.0;  ///< rad from design
  };
  std::array<SideResult, k_num_sides> sides;
  double ride_height_change = 0.0;  ///< m, chassis origin against design, off the plane of the ground
  double pitch = 0.0;               ///< rad, nose down > 0
  double largest_link_speed = 0.0;  ///< m/s, what is left of the settling
};

/// Puts the vehicle down where the ground lets it stand (start_pose), closes the tracks round the running gear and lets
/// the vehicle settle (dynamic relaxation with fading mass damping; P 2): 1 the idler angle at which the pin line is 20
/// mm shorter than the track; 2 pins at equal arc lengths, sprocket in phase; 3 stiffness of bushings, discs and
/// sprocket raised from 2 % to 100 % in 0.6 s; 4 the tensioner's reference integrated until the upper run carries the
/// pre-tension; 5 damping faded out, rubber memory switched on (the rubber starts relaxed), free settling. Throws
/// NumericalError with the reason when the track cannot be closed, the tension is not reached or the vehicle does not
/// settle.
[[nodiscard]] Assembled assemble(const System& system, const Progress& progress = {});

}  // namespace grouser
