#pragma once
#include "tests/support/simbody_solver.h"
#include "tests/support/trees.h"

namespace grouser::test {

/// Largest difference of any acceleration (joints, base) between the program and Simbody on a random floating tree of
/// 1 to 36 hinges in a random state with joint torques, as a fraction of 1 + the largest joint acceleration.
inline double difference_to_simbody(std::uint32_t seed) {
  const Vector3d gravity(0.3, -0.2, -9.81);
  const Tree tree = random_tree(seed, 1 + static_cast<int>(seed % 36));
  const TreeState state = random_state(tree, 1000 + seed);
  const Eigen::VectorXd torque = Eigen::VectorXd::LinSpaced(state.angle.size(), -5.0, 5.0);
  SimbodyProblem problem{tree.base_mass,
                         tree.base_inertia,
                         state.position,
                         state.velocity,
                         state.orientation * state.angular_velocity,
                         state.orientation,
                         gravity,
                         {}};
  for (std::size_t i = 0; i < tree.bodies.size(); ++i) {
    const TreeBody& body = tree.bodies[i];
    const auto j = static_cast<Eigen::Index>(i);
    problem.hinges.push_back({body.parent, body.axis, body.origin, body.mass, body.center_of_mass, body.inertia,
                              state.angle[j], state.rate[j], torque[j]});
  }
  const TreeAcceleration ours = accelerate(tree, state, gravity, torque).acceleration;
  const SimbodyAnswer theirs = solve_with_simbody(problem);
  const Eigen::VectorXd joint = Eigen::VectorXd::Map(theirs.joint.data(), ours.joint.size());
  const double scale = 1.0 + joint.cwiseAbs().maxCoeff();  // up to 1e3 rad/s^2 on light bodies
  return std::max({(ours.joint - joint).cwiseAbs().maxCoeff(), (ours.linear - theirs.linear).norm(),
                   (state.orientation * ours.angular - theirs.angular_W).norm()}) /
         scale;
}

}  // namespace grouser::test
