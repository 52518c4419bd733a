#pragma once
#include "model/scenario.h"

namespace grouser {

/// Prescribed rotation of a sprocket: angle [rad] turned since time 0, speed [rad/s] and acceleration [rad/s^2].
struct DriveMotion {
  double angle = 0.0, speed = 0.0, acceleration = 0.0;
};

/// Exact integral of a piecewise linear speed table, speed constant outside it. At a corner the acceleration is that of
/// the interval that begins there.
[[nodiscard]] DriveMotion drive_motion(const DriveTable& table, double time);

}  // namespace grouser
