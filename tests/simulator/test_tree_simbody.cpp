#include <gtest/gtest.h>

#include "tests/support/simbody_solver.h"
#include "tests/support/trees.h"

namespace grouser::test {
namespace {

SimbodyProblem problem_of(const Tree& tree, const TreeState& state, const Vector3d& gravity,
                          const Eigen::VectorXd& torque) {
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
  return problem;
}

TEST(TreeAgainstSimbody, RandomFloatingTreesAccelerateAlike) {
  const Vector3d gravity(0.3, -0.2, -9.81);
  for (std::uint32_t seed = 1; seed <= 50; ++seed) {
    const Tree tree = random_tree(seed, 1 + static_cast<int>(seed % 36));
    const TreeState state = random_state(tree, 1000 + seed);
    const Eigen::VectorXd torque = Eigen::VectorXd::LinSpaced(state.angle.size(), -5.0, 5.0);
    const TreeAcceleration ours = accelerate(tree, state, gravity, torque).acceleration;
    const SimbodyAnswer theirs = solve_with_simbody(problem_of(tree, state, gravity, torque));
    const Eigen::VectorXd joint = Eigen::VectorXd::Map(theirs.joint.data(), ours.joint.size());
    const double scale = 1.0 + joint.cwiseAbs().maxCoeff();  // up to 1e3 rad/s^2 on light bodies
    EXPECT_LT((ours.joint - joint).cwiseAbs().maxCoeff(), 1e-9 * scale) << "seed " << seed;
    EXPECT_LT((ours.linear - theirs.linear).norm(), 1e-9 * scale) << "seed " << seed;
    EXPECT_LT((state.orientation * ours.angular - theirs.angular_W).norm(), 1e-9 * scale) << "seed " << seed;
  }
}

}  // namespace
}  // namespace grouser::test
