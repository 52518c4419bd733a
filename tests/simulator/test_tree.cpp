#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "simulator/lane_trigonometry.h"
#include "tests/support/tree_references.h"

namespace grouser::test {
namespace {

const Vector3d k_gravity_y(0.0, -9.81, 0.0), k_gravity_z(0.0, 0.0, -9.81);

void expect_near(const Eigen::VectorXd& a, const Eigen::VectorXd& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_LT((a - b).cwiseAbs().maxCoeff(), tolerance) << a.transpose() << "\nagainst\n" << b.transpose();
}

TEST(Tree, FallsFromRestLikeThePublishedChains) {
  for (const FallReference& fall : published_falls()) {
    const TreeState rest = make_state(fall.tree);
    SCOPED_TRACE(fall.name);
    expect_near(accelerate(fall.tree, rest, k_gravity_y, no_torque(rest)).acceleration.joint, fall.acceleration, 1e-12);
  }
}

TEST(Tree, AcceleratesLikeAnIndependentSolverAtAGenericState) {
  const GenericState g;
  const TreeAnswer answer = accelerate(g.tree, g.state, g.gravity, g.torque);
  expect_near(answer.acceleration.joint, g.acceleration, 1e-12);
  EXPECT_NEAR(answer.work.kinetic_energy, g.kinetic, 1e-12);
  EXPECT_NEAR(gravity_energy(g.tree, g.state, g.gravity, answer.work), g.potential, 1e-11);
}

TEST(Tree, PrescribedJointsNeedTheTorqueOfInverseDynamics) {
  const GenericState g;
  expect_near(inverse_dynamics(g.tree, g.state, g.gravity, g.acceleration), g.torque, 1e-12);
  // At rest and without gravity a unit acceleration of the root gives the first column of the mass matrix.
  TreeState still = g.state;
  still.rate.setZero();
  expect_near(inverse_dynamics(g.tree, still, Vector3d::Zero(), Eigen::VectorXd::Unit(5, 0)), g.mass_matrix_column,
              1e-12);
}

TEST(Tree, AJointPrescribedToItsFreeMotionChangesNothing) {
  const Tree free_tree = random_tree(11, 12);
  const TreeState state = random_state(free_tree, 12);
  const Eigen::VectorXd torque = Eigen::VectorXd::LinSpaced(12, -3.0, 4.0);
  const TreeAcceleration free_motion = accelerate(free_tree, state, k_gravity_z, torque).acceleration;
  Tree tree = free_tree;
  for (const std::size_t j : {1u, 4u, 9u}) tree.bodies[j].prescribed = true;
  TreeWorkspace work = make_workspace(tree);
  TreeAcceleration acceleration;
  acceleration.joint = Eigen::VectorXd::Zero(12);
  place_tree(tree, state, k_gravity_z, work);
  work.joint_torque = torque;
  const std::vector<double> wanted(free_motion.joint.begin(), free_motion.joint.end());
  tree_accelerations(tree, state, wanted, work, acceleration);
  expect_near(acceleration.joint, free_motion.joint, 1e-10);  // round-off at accelerations of about 1e2
  expect_near(acceleration.linear, free_motion.linear, 1e-10);
  expect_near(acceleration.angular, free_motion.angular, 1e-10);
  for (const Eigen::Index j : {1, 4, 9}) EXPECT_NEAR(work.joint_torque[j], torque[j], 1e-10);
}

TEST(Tree, GravityAloneIsFreeFall) {
  const Tree tree = random_tree(21, 10);
  TreeState state = random_state(tree, 22);
  state.rate.setZero();
  state.angular_velocity.setZero();
  const TreeAcceleration a = accelerate(tree, state, k_gravity_z, no_torque(state)).acceleration;
  EXPECT_LT((a.linear - k_gravity_z).norm(), 1e-12);
  EXPECT_LT(a.angular.norm(), 1e-12);
  EXPECT_LT(a.joint.norm(), 1e-12);
}

TEST(Tree, InternalTorquesLeaveMomentumAlone) {
  const Tree tree = random_tree(31, 10);
  const TreeState start = random_state(tree, 32);
  const TorqueLaw torque = [](const TreeState& s) -> Eigen::VectorXd {
    return -1.5 * s.angle - 0.2 * s.rate + Eigen::VectorXd::LinSpaced(s.angle.size(), -2.0, 2.0);
  };
  const TreeMomentum before = tree_momentum(tree, start, Vector3d::Zero());
  const TreeMomentum after =
      tree_momentum(tree, runge_kutta(tree, start, Vector3d::Zero(), torque, 1.0, 4000), Vector3d::Zero());
  // The reference integrator's error at 0.25 ms, of fourth order; both momenta are of order 10.
  EXPECT_LT((after.linear - before.linear).norm(), 1e-9);
  EXPECT_LT((after.angular - before.angular).norm(), 1e-9);
}

TEST(Tree, KeepsItsEnergyInGravity) {
  const Tree tree = random_tree(41, 10);
  const TreeState start = random_state(tree, 42);
  const TreeMomentum before = tree_momentum(tree, start, k_gravity_z);
  const TreeMomentum after =
      tree_momentum(tree, runge_kutta(tree, start, k_gravity_z, no_torque, 1.0, 4000), k_gravity_z);
  EXPECT_NEAR(after.kinetic + after.potential, before.kinetic + before.potential, 1e-8);  // of order 100 J
  EXPECT_GT(std::abs(after.kinetic - before.kinetic), 1.0);                               // and it did move
}

TEST(Tree, TheRootJointCarriesWeightAndInertia) {
  Tree tree = random_tree(51, 8);
  tree.base_fixed = true;
  tree.base_mass = 0.0;
  for (TreeBody& body : tree.bodies) body.parent = std::max(body.parent, 0);
  tree.bodies[0].parent = -1;
  const TreeState state = random_state(tree, 52);
  const Vector6d reaction = joint_reaction(accelerate(tree, state, k_gravity_z, no_torque(state)).work, 0);
  // Newton and Euler: the joint's force and moment are the rate of momentum less the weight's share.
  constexpr double k_dt = 1e-5;
  const auto momentum_at = [&](double dt) {
    return tree_momentum(tree, runge_kutta(tree, state, k_gravity_z, no_torque, dt, 1), k_gravity_z);
  };
  const TreeMomentum before = momentum_at(-k_dt), after = momentum_at(k_dt);
  double mass = 0.0;
  Vector3d weight_moment = Vector3d::Zero();
  const TreeWorkspace work = accelerate(tree, state, k_gravity_z, no_torque(state)).work;
  for (std::size_t i = 0; i < tree.bodies.size(); ++i) {
    mass += tree.bodies[i].mass;
    weight_moment += work.center_W(static_cast<int>(i)).cross(tree.bodies[i].mass * k_gravity_z);
  }
  const Vector3d force = (after.linear - before.linear) / (2.0 * k_dt) - mass * k_gravity_z;
  const Vector3d moment = (after.angular - before.angular) / (2.0 * k_dt) - weight_moment;
  EXPECT_LT((reaction.tail<3>() - force).norm(), 1e-6);  // central difference over 1e-5 s
  EXPECT_LT((reaction.head<3>() + work.origin_W(0).cross(reaction.tail<3>()) - moment).norm(), 1e-6);
  // A free hinge carries no moment along its axis.
  EXPECT_NEAR(reaction.head<3>().dot(work.axis_W(0).head<3>()), 0.0, 1e-10);
}

TEST(Tree, MirroredTreesMoveAsMirrorImages) {
  const Tree tree = random_tree(61, 10);
  const TreeState state = random_state(tree, 62);
  const Matrix3d S = Vector3d(1.0, -1.0, 1.0).asDiagonal();  // mirror at the x-z plane; axial vectors take -S
  Tree mirrored = tree;
  mirrored.base_inertia = S * tree.base_inertia * S;
  for (TreeBody& body : mirrored.bodies) {
    body.axis = -S * body.axis;
    body.origin = S * body.origin;
    body.center_of_mass = S * body.center_of_mass;
    body.inertia = S * body.inertia * S;
  }
  TreeState image = state;
  image.position = S * state.position;
  image.velocity = S * state.velocity;
  image.orientation = Quaterniond(Matrix3d(S * state.orientation.toRotationMatrix() * S));
  image.angular_velocity = -S * state.angular_velocity;
  const TreeAcceleration a = accelerate(tree, state, k_gravity_z, no_torque(state)).acceleration;
  const TreeAcceleration b = accelerate(mirrored, image, k_gravity_z, no_torque(image)).acceleration;
  EXPECT_LT((b.linear - S * a.linear).norm(), 1e-11);
  EXPECT_LT((b.angular + S * a.angular).norm(), 1e-11);
  expect_near(b.joint, a.joint, 1e-10);
}

/// Eleven bodies a side on the base, seven of which carry one more and two of those a second; right is left in a
/// mirror.
Tree two_sided_tree() {
  Tree tree;
  tree.base_mass = 20.0;
  tree.base_inertia = Vector3d(3.0, 5.0, 7.0).asDiagonal();
  for (const int side : {0, 1}) {
    std::mt19937 random(81);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const double outwards = side == 0 ? 1.0 : -1.0;
    const auto add = [&](int parent) {
      TreeBody body;
      body.parent = parent;
      body.mirror_group = side;
      body.mass = 1.5 + unit(random);
      body.origin = Vector3d(unit(random), outwards * unit(random), unit(random));
      body.center_of_mass = Vector3d(unit(random), outwards * unit(random), unit(random));
      body.inertia = Vector3d(1.0, 1.1, 1.2).asDiagonal();
      tree.bodies.push_back(body);
    };
    const int first = static_cast<int>(tree.bodies.size());
    for (int i = 0; i < 11; ++i) add(-1);
    for (int i = 0; i < 9; ++i) add(first + 2 + i % 7);
  }
  return tree;
}

TEST(Tree, ItsOwnMirrorImageMovesStraightToTheLastBit) {
  const Tree tree = two_sided_tree();
  const Eigen::Index on_a_side = 20;
  TreeState state = random_state(tree, 82);
  state.orientation = Quaterniond(0.8, 0.0, -0.6, 0.0);
  state.velocity.y() = state.angular_velocity.x() = state.angular_velocity.z() = 0.0;
  state.angle.tail(on_a_side) = state.angle.head(on_a_side);
  state.rate.tail(on_a_side) = state.rate.head(on_a_side);
  const TreeAcceleration a = accelerate(tree, state, k_gravity_z, no_torque(state)).acceleration;
  EXPECT_EQ(a.linear.y(), 0.0);
  EXPECT_EQ(a.angular.x(), 0.0);
  EXPECT_EQ(a.angular.z(), 0.0);
  EXPECT_EQ(a.joint.head(on_a_side), a.joint.tail(on_a_side));
  EXPECT_GT(a.linear.norm() * a.angular.norm(), 1.0);
}

TEST(Tree, EveryBodyStandsInTheLaneOfTheOneThatItHangsOn) {
  std::vector<Tree> trees{two_sided_tree(), five_body_tree()};
  for (std::uint32_t seed = 1; seed < 50; ++seed) trees.push_back(random_tree(seed, static_cast<int>(seed)));
  for (const Tree& tree : trees) {
    const TreeWorkspace work = make_workspace(tree);
    double mass = 0.0, in_blocks = 0.0;
    for (std::size_t i = 0; i < tree.bodies.size(); ++i) {
      const auto [number, lane] = work.place[i];
      const TreeBlock& block = work.blocks[number];
      const int parent = tree.bodies[i].parent;
      EXPECT_EQ(block.body[static_cast<std::size_t>(lane)], static_cast<int>(i));
      EXPECT_EQ(block.parent < 0, parent < 0);
      mass += block.mass[lane];
      if (parent < 0) {
        EXPECT_EQ(block.mirror_group, tree.bodies[i].mirror_group);
        continue;
      }
      const TreePlace carrier = work.place[static_cast<std::size_t>(parent)];
      EXPECT_EQ(carrier.block, static_cast<std::size_t>(block.parent));
      EXPECT_EQ(carrier.lane, lane);
      EXPECT_LT(carrier.block, number);
      EXPECT_TRUE(work.blocks[carrier.block].bears);
    }
    for (const TreeBlock& block : work.blocks) in_blocks += block.mass.sum();
    EXPECT_NEAR(in_blocks, mass, 1e-12 * mass);  // lanes without a body have none
  }
  EXPECT_EQ(make_workspace(two_sided_tree()).blocks.size(), 8u);  // a side: two, what they bear, the second ones
}

TEST(Tree, TurningAndMovingTheWorldChangesNothingInside) {
  const Tree tree = random_tree(71, 10);
  const TreeState state = random_state(tree, 72);
  const Quaterniond turn = quaternion_exp({0.4, -1.1, 0.7});
  TreeState turned = state;
  turned.position = turn * state.position + Vector3d(100.0, -20.0, 3.0);
  turned.velocity = turn * state.velocity + Vector3d(5.0, 6.0, -7.0);
  turned.orientation = turn * state.orientation;
  const TreeAcceleration a = accelerate(tree, state, k_gravity_z, no_torque(state)).acceleration;
  const TreeAcceleration b = accelerate(tree, turned, turn * k_gravity_z, no_torque(turned)).acceleration;
  EXPECT_LT((b.linear - turn * a.linear).norm(), 1e-10);
  EXPECT_LT((b.angular - a.angular).norm(), 1e-10);
  expect_near(b.joint, a.joint, 1e-10);
}

TEST(LaneTrigonometry, HoldsAfterManyTurns) {
  std::mt19937 random(3);
  for (const double largest : {1.0, 1e3, 9e5}) {  // the last: a wheel's angle after an hour at 250 rad/s
    std::uniform_real_distribution<double> angle(-largest, largest);
    for (int n = 0; n < 1000; ++n) {
      Lanes x;
      for (int lane = 0; lane < k_lanes; ++lane) x.set(lane, angle(random));
      const SineCosine found = sine_cosine(x);
      for (int lane = 0; lane < k_lanes; ++lane) {
        ASSERT_NEAR(found.sine[lane], std::sin(x[lane]), 4.5e-16) << x[lane];  // 2 ulp of 1
        ASSERT_NEAR(found.cosine[lane], std::cos(x[lane]), 4.5e-16) << x[lane];
      }
    }
  }
}

}  // namespace
}  // namespace grouser::test
