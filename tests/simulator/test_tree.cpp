#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/trees.h"

namespace grouser::test {
namespace {

const Vector3d k_gravity_y(0.0, -9.81, 0.0), k_gravity_z(0.0, 0.0, -9.81);

Eigen::VectorXd vector_of(std::initializer_list<double> values) {
  Eigen::VectorXd v(static_cast<Eigen::Index>(values.size()));
  Eigen::Index i = 0;
  for (const double value : values) v[i++] = value;
  return v;
}

Eigen::VectorXd no_torque(const TreeState& state) { return Eigen::VectorXd::Zero(state.angle.size()); }

void expect_near(const Eigen::VectorXd& a, const Eigen::VectorXd& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_LT((a - b).cwiseAbs().maxCoeff(), tolerance) << a.transpose() << "\nagainst\n" << b.transpose();
}

/// RBDL's chains of unit bodies along x, hinged at z, from rest in gravity along -y.
Tree unit_chain(int length) {
  Tree tree;
  tree.base_fixed = true;
  for (int i = 0; i < length; ++i) {
    TreeBody body;
    body.parent = i - 1;
    body.axis = Vector3d::UnitZ();
    body.origin = (i == 0 ? 0.0 : 1.0) * Vector3d::UnitX();
    body.mass = 1.0;
    body.center_of_mass = Vector3d::UnitX();
    body.inertia = Matrix3d::Identity();
    tree.bodies.push_back(body);
  }
  return tree;
}

TEST(Tree, FallsFromRestLikeThePublishedChains) {
  // RBDL, DynamicsTests.cc: angular accelerations of one, two and three bodies; rational numbers, hence round-off.
  const auto fall = [](const Tree& tree) {
    const TreeState rest = make_state(tree);
    return accelerate(tree, rest, k_gravity_y, no_torque(rest)).acceleration.joint;
  };
  expect_near(fall(unit_chain(1)), vector_of({-4.905}), 1e-13);
  expect_near(fall(unit_chain(2)), vector_of({-5.886, 3.924}), 1e-13);
  expect_near(fall(unit_chain(3)), vector_of({-6.03692307692308, 3.77307692307692, 1.50923076923077}), 1e-13);
  Tree across = unit_chain(2);
  across.bodies[1].axis = Vector3d::UnitY();
  across.bodies[1].center_of_mass = Vector3d::UnitY();
  expect_near(fall(across), vector_of({-3.924, 0.0}), 1e-13);
  expect_near(fall(five_body_tree()),
              vector_of({-1.6031906614786, -0.534396887159533, 4.1034046692607, 0.267198443579767, 5.30579766536965}),
              1e-12);
}

struct GenericState {
  Tree tree = five_body_tree();
  TreeState state = make_state(tree);
  Eigen::VectorXd torque = vector_of({0.5, -0.3, 0.2, 0.1, -0.4});
  Eigen::VectorXd acceleration =
      vector_of({-0.896520835556976, -2.53969241941477, 1.76448968591703, -0.865767038176765, 2.42569523672112});
  GenericState() {
    state.angle = vector_of({0.3, -0.4, 0.5, 0.6, -0.7});
    state.rate = vector_of({1.1, -1.2, 1.3, -0.1, 0.2});
  }
};

TEST(Tree, AcceleratesLikeAnIndependentSolverAtAGenericState) {
  // Fourteen digits from a dense mass matrix (numpy).
  const GenericState g;
  const TreeAnswer answer = accelerate(g.tree, g.state, k_gravity_y, g.torque);
  expect_near(answer.acceleration.joint, g.acceleration, 1e-12);
  EXPECT_NEAR(answer.work.kinetic_energy, 9.80814271677356, 1e-12);
  EXPECT_NEAR(gravity_energy(g.tree, g.state, k_gravity_y, answer.work), 31.0333913374693, 1e-11);
}

TEST(Tree, PrescribedJointsNeedTheTorqueOfInverseDynamics) {
  GenericState g;
  for (TreeBody& body : g.tree.bodies) body.prescribed = true;
  TreeWorkspace work = make_workspace(g.tree);
  TreeAcceleration acceleration;
  acceleration.joint = Eigen::VectorXd::Zero(5);
  place_tree(g.tree, g.state, k_gravity_y, work);
  const std::vector<double> wanted(g.acceleration.begin(), g.acceleration.end());
  tree_accelerations(g.tree, g.state, wanted, work, acceleration);
  expect_near(work.joint_torque, g.torque, 1e-12);
  // At rest and without gravity a unit acceleration of the root gives the first column of the mass matrix.
  TreeState still = g.state;
  still.rate.setZero();
  place_tree(g.tree, still, Vector3d::Zero(), work);
  tree_accelerations(g.tree, still, std::vector<double>{1.0, 0.0, 0.0, 0.0, 0.0}, work, acceleration);
  expect_near(
      work.joint_torque,
      vector_of({9.97973659158745, -0.420784015928471, -0.285442975776752, -0.0910376309556479, -0.564987518984467}),
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
    weight_moment += work.center_W[i].cross(tree.bodies[i].mass * k_gravity_z);
  }
  const Vector3d force = (after.linear - before.linear) / (2.0 * k_dt) - mass * k_gravity_z;
  const Vector3d moment = (after.angular - before.angular) / (2.0 * k_dt) - weight_moment;
  EXPECT_LT((reaction.tail<3>() - force).norm(), 1e-6);  // central difference over 1e-5 s
  EXPECT_LT((reaction.head<3>() + work.origin_W[0].cross(reaction.tail<3>()) - moment).norm(), 1e-6);
  // A free hinge carries no moment along its axis.
  EXPECT_NEAR(reaction.head<3>().dot(work.axis_W[0].head<3>()), 0.0, 1e-10);
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

}  // namespace
}  // namespace grouser::test
