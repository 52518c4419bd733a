#pragma once
#include <vector>

#include "model/geometry.h"

/// A floating tree of hinges solved by Simbody. Plain values only: Simbody's headers need C++17, the tree's C++20.
namespace grouser::test {

struct SimbodyHinge {
  int parent = -1;          ///< -1 is the base
  Vector3d axis, origin;    ///< in the parent's frame
  double mass = 0.0;        ///< kg
  Vector3d center_of_mass;  ///< in the body's frame
  Matrix3d inertia;         ///< about the centre of mass
  double angle = 0.0, rate = 0.0, torque = 0.0;
};

struct SimbodyProblem {
  double base_mass = 0.0;
  Matrix3d base_inertia;
  Vector3d position, velocity, angular_velocity_W;  ///< of the base's centre of mass, W
  Quaterniond orientation;
  Vector3d gravity_W;
  std::vector<SimbodyHinge> hinges;
};

struct SimbodyAnswer {
  Vector3d linear, angular_W;  ///< of the base
  std::vector<double> joint;
};
[[nodiscard]] SimbodyAnswer solve_with_simbody(const SimbodyProblem& problem);

}  // namespace grouser::test
