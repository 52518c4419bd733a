#pragma once
#include <vector>

#include "model/vehicle.h"

/// The pin line of a closed track round its running gear, in the vehicle frame's x-z plane at design.
namespace grouser {

/// One wheel that the pin line wraps, met in the track's order: ground run rear to front, front end, upper run, rear
/// end.
struct PathWheel {
  double x = 0.0, z = 0.0;
  double tangent_radius = 0.0;  ///< distance of the pin line from the axle on the straight parts [m]
  double wrap_radius =
      0.0;  ///< length of pin line a radian of wrap [m]: p / (2 atan(p / 2R)), or N p / 2 pi on the sprocket
};

/// Wheels of one side with the idler arm turned by `idler_angle` from design about +y.
[[nodiscard]] std::vector<PathWheel> path_wheels(const RunningGear& gear, double idler_angle);

/// Length of the belt of outer tangents and wraps [m].
[[nodiscard]] double path_length(const std::vector<PathWheel>& wheels);

/// Pin positions (x, z) at `count` equal arc lengths.
struct PathPoint {
  double x = 0.0, z = 0.0;
};
[[nodiscard]] std::vector<PathPoint> path_pins(const std::vector<PathWheel>& wheels, int count);

}  // namespace grouser
