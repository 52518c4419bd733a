#include <gtest/gtest.h>

#include "tests/support/tree_references.h"

/// Motion of trees against numbers made by independent programs.
namespace grouser::test {
namespace {

class TreeReferences : public ::testing::TestWithParam<MotionReference> {};

TEST_P(TreeReferences, MovesAsKnown) {
  const MotionReference& reference = GetParam();
  TreeState state = reference.start;
  double time = 0.0;
  for (const MotionReference::At& known : reference.known) {
    const double ahead = known.time - time;
    state = runge_kutta(reference.tree, state, reference.gravity, reference.torque, ahead,
                        static_cast<int>(ahead * 4000.0));
    time = known.time;
    EXPECT_LT((state.angle - known.angle).cwiseAbs().maxCoeff(), reference.tolerance) << "at " << time;
    EXPECT_LT((state.rate - known.rate).cwiseAbs().maxCoeff(), 30.0 * reference.tolerance) << "at " << time;
  }
}

INSTANTIATE_TEST_SUITE_P(Known, TreeReferences,
                         ::testing::Values(five_body_fall(), double_pendulum(), sprung_chain(), tilted_hinge_chain()));

TEST(TreeReference, SumOfTheTiltedChainsAnglesIsThePublishedOne) {
  const MotionReference reference = tilted_hinge_chain();
  const TreeState end = runge_kutta(reference.tree, reference.start, reference.gravity, no_torque, 1.0, 4000);
  EXPECT_NEAR(end.angle.sum(), -1.3093839514061, 1e-10);  // EXUDYN; the reference integrator's error at 0.25 ms
}

TEST(TreeReference, ChainOfTenSprungHingesHangsStill) {
  const MotionReference chain = sprung_chain();
  TreeState state = chain.start;
  state.angle = sprung_chain_at_rest();
  const TreeAnswer answer = accelerate(chain.tree, state, chain.gravity, chain.torque(state));
  // The angles are given to 1e-14 rad; 400 N m/rad on the last link's 0.1 kg m^2 make that 1e-10 rad/s^2.
  EXPECT_LT(answer.acceleration.joint.norm(), 1e-8);
}

TEST(TreeReference, HeavyTop) {
  const HeavyTop top;
  TreeState state = top.start;
  double time = 0.0;
  for (const HeavyTop::At& known : top.known) {
    const double ahead = known.time - time;
    state = runge_kutta(top.tree, state, top.gravity, no_torque, ahead, static_cast<int>(ahead * 4000.0));
    time = known.time;
    const TreeWorkspace work = accelerate(top.tree, state, top.gravity, no_torque(state)).work;
    EXPECT_LT((work.center_W(2) - known.center).norm(), 1e-7) << "at " << time;
    const Vector3d spin = work.rotation(2).transpose() * work.angular_velocity_W(2);
    // The spin of 150 rad/s is conserved; 1e-7 rad of phase turns the transverse 5 rad/s by as little.
    EXPECT_LT((spin - known.spin).norm(), 1e-5) << "at " << time;
  }
}

}  // namespace
}  // namespace grouser::test
