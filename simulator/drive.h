#pragma once
#include "simulator/workspace.h"

/// What turns the sprockets: a prescribed motion, a prescribed torque, or a driver (see DriveKind). With a torque the
/// sprocket is a degree of freedom like any other joint.
namespace grouser {

/// Rotation that is asked of a sprocket: angle [rad] turned since time 0, speed [rad/s] and acceleration [rad/s^2]. Of
/// a cruise table the track's travel [m] and its derivatives.
struct DriveMotion {
  double angle = 0.0, speed = 0.0, acceleration = 0.0;
};

/// Exact integral of a piecewise linear speed table, speed constant outside it. At a corner the acceleration is that of
/// the interval that begins there.
[[nodiscard]] DriveMotion drive_motion(const DriveTable& table, double time);

/// Torque [N m] that engine or brake can give of what is wanted at a sprocket's rate [rad/s]: driving at most
/// min(largest torque, P / |rate|), braking at most the brake torque.
[[nodiscard]] double limited_torque(const DriveTable& table, double wanted, double rate);

/// A driver's torque and what becomes of his integral.
struct DriverAction {
  double torque = 0.0;         ///< N m
  double integral_rate = 0.0;  ///< N m/s
};

/// Proportional-integral control of a sprocket's rate with back-calculation (Astrom & Hagglund, PID Controllers, 1995,
/// 3.5):
///   T_wanted = inertia target' + k_p e + I,  e = target - rate,  T = limited(T_wanted),  I' = k_i e + (T - T_wanted) /
///   t
/// inertia: what the sprocket has to turn [kg m^2]. With the response time t: k_p = inertia / t, k_i = k_p / 4 t, the
/// gains of a double pole at -1 / 2t.
[[nodiscard]] DriverAction driver_action(const DriveTable& table, double inertia, const DriveMotion& target,
                                         double rate, double integral);

/// Puts the torques of driven sprockets on their joints, and the accelerations of prescribed ones and the rates of the
/// drivers' integrals where the step looks for them.
void drive_sprockets(const System& system, const State& state, Workspace& work, Acceleration& acceleration);

}  // namespace grouser
