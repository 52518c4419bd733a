#pragma once
#include <array>
#include <vector>

#include "simulator/lanes.h"
#include "simulator/system.h"

namespace grouser {

/// Memory of rubber and ground contact: belongs to the state, committed with an accepted step only.
struct History {
  Field deflection;                    ///< bushing deflections at the last accepted step [m, rad] (6 x joints)
  Field stop;                          ///< elastic deflection of every friction stop [m, rad] (stops x joints)
  Field branch;                        ///< force of every Maxwell branch [N, N m] (branches x joints)
  Field anchor_x, anchor_y, anchor_z;  ///< bristle anchors on the ground, W [m] (ground contacts x links)
  Field stretch_x, stretch_y;          ///< point less anchor, in the ground's tangent plane [m]
  Field anchored;                      ///< 1 where the anchor is in use
};

/// Everything that is integrated. Link arrays hold both tracks, each padded; element num_links of a track repeats its
/// first link.
struct State {
  double time = 0.0;  ///< s
  TreeState chassis;
  Field position;                            ///< link centres in W [m] (3)
  Field orientation;                         ///< link -> W, unit quaternions w, x, y, z (4)
  Field velocity;                            ///< W [m/s] (3)
  Field angular_velocity;                    ///< link frame [rad/s] (3)
  std::array<double, k_num_sides> driver{};  ///< N m, what the driver's integral asks of each sprocket
  History history;
};

/// Accelerations at one state; the integrator keeps those of the last two accepted steps.
struct Acceleration {
  TreeAcceleration chassis;
  Field linear;                              ///< W [m/s^2] (3)
  Field angular;                             ///< link frame [rad/s^2] (3)
  std::array<double, k_num_sides> driver{};  ///< N m/s, rate of State::driver
};

[[nodiscard]] State make_state(const System& system);
[[nodiscard]] Acceleration make_acceleration(const System& system);

/// Repeats the first link of every track behind its last, so that blocks may be loaded across the seam.
void close_chains(const System& system, State& state);

}  // namespace grouser
