#pragma once
#include <cstdint>
#include <functional>

#include "simulator/tree.h"

/// Trees of revolute bodies for tests, and a reference integrator for them.
namespace grouser::test {

/// Five unit bodies on a fixed base (RBDL's test tree): parents -1 0 1 0 3, axes z y x y x.
[[nodiscard]] Tree five_body_tree();

/// Bodies with random parents, axes, joints, masses and inertias of a real shape.
[[nodiscard]] Tree random_tree(std::uint32_t seed, int num_bodies);
/// Random pose and motion of everything, the base too.
[[nodiscard]] TreeState random_state(const Tree& tree, std::uint32_t seed);

/// Joint torques over time, angles and rates.
using TorqueLaw = std::function<Eigen::VectorXd(const TreeState&)>;

/// What a tree does at one state.
struct TreeAnswer {
  TreeWorkspace work;
  TreeAcceleration acceleration;
};
[[nodiscard]] TreeAnswer accelerate(const Tree& tree, const TreeState& state, const Vector3d& gravity_W,
                                    const Eigen::VectorXd& torque);

/// Classical Runge-Kutta of fourth order: a reference, never the program's own integrator.
[[nodiscard]] TreeState runge_kutta(const Tree& tree, TreeState state, const Vector3d& gravity_W,
                                    const TorqueLaw& torque, double duration, int steps);

/// Linear momentum, angular momentum about W's origin, and energy.
struct TreeMomentum {
  Vector3d linear = Vector3d::Zero(), angular = Vector3d::Zero();
  double kinetic = 0.0, potential = 0.0;
};
[[nodiscard]] TreeMomentum tree_momentum(const Tree& tree, const TreeState& state, const Vector3d& gravity_W);

}  // namespace grouser::test
