#pragma once
#include "simulator/state.h"

namespace grouser {

/// Where the vehicle is put down before it settles: its frame V at design on the plane that fits the ground under both
/// tracks best, lifted until no ground stands above that plane; heading along W's x. W itself on level ground.
struct StartPose {
  Vector3d plane = Vector3d::Zero();         ///< point of the fitted plane below V's origin, W [m]
  Vector3d position = Vector3d::Zero();      ///< V's origin, W [m]
  Matrix3d rotation = Matrix3d::Identity();  ///< V -> W
};

/// Throws NumericalError where the ground is steeper than friction can hold.
[[nodiscard]] StartPose start_pose(const System& system);

/// Moves a state that stands at design in W to the start pose.
void put_down(const System& system, const StartPose& pose, State& state);

}  // namespace grouser
