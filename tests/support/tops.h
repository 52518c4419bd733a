#pragma once
#include "tests/support/scenes.h"

/// One free link as a torque-free top.
namespace grouser::test {

/// One link of the given principal inertia, spun at `spin` (its own frame), through the program's own stepping.
[[nodiscard]] LinkMotion spin_top(const Vector3d& inertia, const Vector3d& spin, double duration, int steps);
/// The same top by the classical Runge-Kutta method with 20000 steps, whose error is round-off.
[[nodiscard]] LinkMotion reference_top(const Vector3d& inertia, const Vector3d& spin, double duration);
/// |difference| of the quaternions, signs matched.
[[nodiscard]] double quaternion_distance(const Quaterniond& a, const Quaterniond& b);

/// A torque-free top whose angular velocity at some times is known.
struct TopReference {
  Vector3d inertia, spin;
  struct At {
    double time;
    Vector3d angular_velocity;
  };
  std::vector<At> known;
};
/// I = (3, 2, 1), w0 = (1, 0, 1): Jacobi's elliptic functions.
[[nodiscard]] TopReference euler_top();
/// I = (1, 2, 3), spun about the middle axis, where rotation is unstable (Dzhanibekov's nut).
[[nodiscard]] TopReference tumbling_top();

}  // namespace grouser::test
