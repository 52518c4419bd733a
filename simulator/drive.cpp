#include "simulator/drive.h"

#include <algorithm>
#include <cmath>

namespace grouser {
namespace {

/// Angle from the table's first point to `time` within or beyond it.
double angle_since_start(const DriveTable& table, double time) {
  const std::vector<double>& value = table.value();
  const std::size_t n = table.time.size();
  if (time <= table.time[0]) return value[0] * (time - table.time[0]);
  double angle = 0.0;
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const double span = table.time[i + 1] - table.time[i];
    const double slope = (value[i + 1] - value[i]) / span;
    const double dt = std::min(time, table.time[i + 1]) - table.time[i];
    angle += dt * (value[i] + 0.5 * slope * dt);
    if (time <= table.time[i + 1]) return angle;
  }
  return angle + value[n - 1] * (time - table.time[n - 1]);
}

}  // namespace

DriveMotion drive_motion(const DriveTable& table, double time) {
  const std::vector<double>& value = table.value();
  const std::size_t n = table.time.size();
  DriveMotion motion;
  motion.angle = angle_since_start(table, time) - angle_since_start(table, 0.0);
  if (time < table.time[0]) {
    motion.speed = value[0];
  } else if (time >= table.time[n - 1]) {
    motion.speed = value[n - 1];
  } else {
    std::size_t i = 0;
    while (time >= table.time[i + 1]) ++i;
    motion.acceleration = (value[i + 1] - value[i]) / (table.time[i + 1] - table.time[i]);
    motion.speed = value[i] + motion.acceleration * (time - table.time[i]);
  }
  return motion;
}

double limited_torque(const DriveTable& table, double wanted, double rate) {
  if (wanted * rate < 0.0) return std::clamp(wanted, -table.brake_torque, table.brake_torque);
  const double speed = std::abs(rate), slowest = table.power / table.largest_torque;  // rad/s, at full power
  const double limit = speed <= slowest ? table.largest_torque : table.power / speed;
  return std::clamp(wanted, -limit, limit);
}

DriverAction driver_action(const DriveTable& table, double inertia, const DriveMotion& target, double rate,
                           double integral) {
  const double t = table.response_time, gain = inertia / t, error = target.speed - rate;
  const double wanted = inertia * target.acceleration + gain * error + integral,
               torque = limited_torque(table, wanted, rate);
  return {torque, 0.25 * gain / t * error + (torque - wanted) / t};
}

void drive_sprockets(const System& system, const State& state, Workspace& work, Acceleration& acceleration) {
  for (std::size_t side = 0; side < k_num_sides; ++side) {
    const DriveTable& table = system.scenario.drive[side];
    const int body = system.sprocket_body[side];
    const double rate = state.chassis.rate[body];
    switch (table.kind) {
      case DriveKind::speed:
        work.prescribed_acceleration[static_cast<std::size_t>(body)] = drive_motion(table, state.time).acceleration;
        break;
      case DriveKind::torque:
        work.chassis.joint_torque[body] += table_value(table.time, table.torque, state.time) - table.drag * rate;
        break;
      case DriveKind::cruise: {
        const double radius = system.tracks[side].speed_per_sprocket_rate;
        const double inertia = 0.5 * system.weight / system.scenario.gravity * radius * radius;  // of the vehicle
        const DriveMotion track = drive_motion(table, state.time);
        const DriveMotion target{track.angle / radius, track.speed / radius, track.acceleration / radius};
        const DriverAction action = driver_action(table, inertia, target, rate, state.driver[side]);
        work.chassis.joint_torque[body] += action.torque;
        acceleration.driver[side] = action.integral_rate;
        break;
      }
    }
  }
}

}  // namespace grouser
