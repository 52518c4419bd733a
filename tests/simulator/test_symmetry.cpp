#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/vehicle_scene.h"

/// What must not matter: left and right, the direction the vehicle faces, repetition.
namespace grouser::test {
namespace {

/// To the last bit: contacts magnify round-off by e^10 a second, so what is only nearly straight is not straight for
/// long. No lane's result may depend on what stands in the others.
TEST(Symmetry, EqualDrivesGoStraight) {
  EXPECT_EQ(reference_scene().rest.state.chassis.position.y(), 0.0);
  const ShortRun run = run_for(driven(9.0, 9.0), reference_scene().rest.state, 0.3);
  const TreeState& chassis = run.state.chassis;
  EXPECT_GT(chassis.velocity.x(), 0.3);
  EXPECT_EQ(chassis.position.y(), 0.0);
  EXPECT_EQ(chassis.orientation.x(), 0.0);
  EXPECT_EQ(chassis.orientation.z(), 0.0);
}

TEST(Symmetry, ExchangedDrivesGiveTheMirroredMotion) {
  const State& start = reference_scene().rest.state;
  const ShortRun right_turn = run_for(driven(9.0, 3.0), start, 0.3), left_turn = run_for(driven(3.0, 9.0), start, 0.3);
  const TreeState &a = right_turn.state.chassis, &b = left_turn.state.chassis;
  EXPECT_LT(a.angular_velocity.z(), -0.05);  // the faster left track turns it to the right
  // Equal but for round-off, which contacts magnify.
  EXPECT_NEAR(a.position.x(), b.position.x(), 1e-9);
  EXPECT_NEAR(a.position.y(), -b.position.y(), 1e-9);
  EXPECT_NEAR(a.position.z(), b.position.z(), 1e-9);
  EXPECT_NEAR(a.orientation.z(), -b.orientation.z(), 1e-9);
  EXPECT_NEAR(a.angular_velocity.z(), -b.angular_velocity.z(), 1e-8);
  const System& system = reference_scene().system;
  const int left = system.tracks[0].offset, right = system.tracks[1].offset;
  for (int k = 0; k < system.tracks[0].num_links; ++k) {
    const Vector3d p = get_vector(right_turn.state.position, left + k);
    const Vector3d q = get_vector(left_turn.state.position, right + k);
    ASSERT_LT((Vector3d(p.x(), -p.y(), p.z()) - q).norm(), 1e-8) << "link " << k;
  }
}

TEST(Symmetry, TurningTheWorldChangesNothing) {
  constexpr double k_angle = 1.1;  // rad
  const System system = driven(6.0, 9.0);
  const State& start = reference_scene().rest.state;
  const ShortRun straight = run_for(system, start, 0.2), aside = run_for(system, turned(start, k_angle), 0.2);
  const State expected = turned(straight.state, k_angle);
  EXPECT_EQ(straight.steps, aside.steps);
  EXPECT_LT((aside.state.chassis.position - expected.chassis.position).norm(), 1e-9);
  EXPECT_LT((aside.state.chassis.velocity - expected.chassis.velocity).norm(), 1e-8);
  for (int i = 0; i < start.position.length(); ++i) {
    ASSERT_LT((get_vector(aside.state.position, i) - get_vector(expected.position, i)).norm(), 1e-8) << "link " << i;
  }
}

TEST(Symmetry, TheSameRunTwiceIsTheSameToTheLastBit) {
  const System system = driven(9.0, 3.0);
  const ShortRun a = run_for(system, reference_scene().rest.state, 0.1);
  const ShortRun b = run_for(system, reference_scene().rest.state, 0.1);
  EXPECT_EQ(a.steps, b.steps);
  EXPECT_EQ(a.state.position.data(), b.state.position.data());
  EXPECT_EQ(a.state.orientation.data(), b.state.orientation.data());
  EXPECT_EQ(a.acceleration.angular.data(), b.acceleration.angular.data());
  EXPECT_EQ(a.book.residual(), b.book.residual());
}

}  // namespace
}  // namespace grouser::test
