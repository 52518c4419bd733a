#include "simulator/drive.h"

#include <cmath>

namespace grouser {
namespace {

/// Angle from the table's first point to `time` within or beyond it.
double angle_since_start(const DriveTable& table, double time) {
  const std::size_t n = table.time.size();
  if (time <= table.time[0]) return table.speed[0] * (time - table.time[0]);
  double angle = 0.0;
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const double span = table.time[i + 1] - table.time[i];
    const double slope = (table.speed[i + 1] - table.speed[i]) / span;
    const double dt = std::min(time, table.time[i + 1]) - table.time[i];
    angle += dt * (table.speed[i] + 0.5 * slope * dt);
    if (time <= table.time[i + 1]) return angle;
  }
  return angle + table.speed[n - 1] * (time - table.time[n - 1]);
}

}  // namespace

DriveMotion drive_motion(const DriveTable& table, double time) {
  const std::size_t n = table.time.size();
  DriveMotion motion;
  motion.angle = angle_since_start(table, time) - angle_since_start(table, 0.0);
  if (time < table.time[0]) {
    motion.speed = table.speed[0];
  } else if (time >= table.time[n - 1]) {
    motion.speed = table.speed[n - 1];
  } else {
    std::size_t i = 0;
    while (time >= table.time[i + 1]) ++i;
    motion.acceleration = (table.speed[i + 1] - table.speed[i]) / (table.time[i + 1] - table.time[i]);
    motion.speed = table.speed[i] + motion.acceleration * (time - table.time[i]);
  }
  return motion;
}

}  // namespace grouser
