#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/trees.h"

/// Motion of trees against numbers made by independent programs (../shared/references/rigid_body/refs.json).
namespace grouser::test {
namespace {

const Vector3d k_gravity_y(0.0, -9.81, 0.0), k_gravity_z(0.0, 0.0, -9.81);

Eigen::VectorXd no_torque(const TreeState& state) { return Eigen::VectorXd::Zero(state.angle.size()); }

class TreeReferences : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::filesystem::path file = GROUSER_SOURCE_DIR "/../shared/references/rigid_body/refs.json";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "the published references are not here: " << file;
    references_ = nlohmann::json::parse(std::ifstream(file));
  }
  [[nodiscard]] static Eigen::VectorXd vector_of(const nlohmann::json& values) {
    const auto v = values.get<std::vector<double>>();
    return Eigen::VectorXd::Map(v.data(), static_cast<Eigen::Index>(v.size()));
  }
  /// Runs on from one listed time to the next, comparing joint angles and rates at each.
  void expect_motion(const char* name, const Tree& tree, TreeState state, const Vector3d& gravity,
                     const TorqueLaw& torque, double tolerance) const {
    const nlohmann::json& known = references_.at(name);
    double time = 0.0;
    for (std::size_t i = 0; i < known.at("t").size(); ++i) {
      const double until = known.at("t")[i];
      state = runge_kutta(tree, state, gravity, torque, until - time, static_cast<int>((until - time) * 4000.0));
      time = until;
      EXPECT_LT((state.angle - vector_of(known.at("q")[i])).cwiseAbs().maxCoeff(), tolerance) << name << " at " << time;
      EXPECT_LT((state.rate - vector_of(known.at("v")[i])).cwiseAbs().maxCoeff(), 30.0 * tolerance)
          << name << " at " << time;
    }
  }
  nlohmann::json references_;
};

TreeBody rod(int parent, const Vector3d& axis, double length, double mass, const Vector3d& inertia) {
  TreeBody body;
  body.parent = parent;
  body.axis = axis;
  body.origin = parent < 0 ? Vector3d::Zero() : Vector3d(length, 0.0, 0.0);
  body.mass = mass;
  body.center_of_mass = Vector3d(0.5 * length, 0.0, 0.0);
  body.inertia = inertia.asDiagonal();
  return body;
}

TEST_F(TreeReferences, FiveBodyTreeFalls) {
  const Tree tree = five_body_tree();
  expect_motion("tree5_fall_from_rest", tree, make_state(tree), k_gravity_y, no_torque, 1e-9);
}

TEST_F(TreeReferences, DoublePendulumOfRods) {
  Tree tree;
  tree.base_fixed = true;
  const Vector3d slender(0.0, 1.0 / 12.0, 1.0 / 12.0);
  tree.bodies = {rod(-1, Vector3d::UnitZ(), 1.0, 1.0, slender), rod(0, Vector3d::UnitZ(), 1.0, 1.0, slender)};
  // Chaotic: errors of the reference integrator grow about 1e3 times over 3 s.
  expect_motion("double_pendulum_rods", tree, make_state(tree), k_gravity_y, no_torque, 1e-7);
}

Tree spring_chain() {
  Tree tree;
  tree.base_fixed = true;
  constexpr double length = 0.15, mass = 15.0;
  const double across = mass * length * length / 12.0;
  for (int i = 0; i < 10; ++i)
    tree.bodies.push_back(rod(i - 1, Vector3d::UnitY(), length, mass, {0.01, across, across}));
  return tree;
}

TEST_F(TreeReferences, ChainOfTenSprungHinges) {
  const Tree tree = spring_chain();
  const TorqueLaw springs = [](const TreeState& s) -> Eigen::VectorXd { return -400.0 * s.angle - 2.0 * s.rate; };
  expect_motion("hinge_spring_chain10", tree, make_state(tree), k_gravity_z, springs, 1e-7);
}

TEST_F(TreeReferences, ChainOfTenSprungHingesHangsStill) {
  const Tree tree = spring_chain();
  TreeState state = make_state(tree);
  state.angle = vector_of(references_.at("hinge_spring_chain10_static").at("q"));
  const TreeAnswer answer = accelerate(tree, state, k_gravity_z, -400.0 * state.angle);
  // The angles are given to 1e-14 rad; 400 N m/rad on the last link's 0.1 kg m^2 make that 1e-10 rad/s^2.
  EXPECT_LT(answer.acceleration.joint.norm(), 1e-8);
}

TEST_F(TreeReferences, HeavyTop) {
  // A fixed point as three crossed hinges: two massless bodies, then the top, which never comes nearer than 30 degrees
  // to the first axis, where the hinges would be singular.
  const double c = std::cos(k_pi * 150.0 / 180.0), s = std::sin(k_pi * 150.0 / 180.0);
  Tree tree;
  tree.base_fixed = true;
  for (const Vector3d& axis : {Vector3d(c, 0.0, s), Vector3d(-s, 0.0, c), Vector3d(0.0, 1.0, 0.0)}) {
    TreeBody body;
    body.parent = static_cast<int>(tree.bodies.size()) - 1;
    body.axis = axis;
    tree.bodies.push_back(body);
  }
  tree.bodies[2].mass = 15.0;
  tree.bodies[2].center_of_mass = Vector3d::UnitY();
  tree.bodies[2].inertia = Vector3d(0.234375, 0.46875, 0.234375).asDiagonal();
  TreeState state = make_state(tree);
  state.rate << -4.61538 * s, -4.61538 * c, 150.0;
  const nlohmann::json& known = references_.at("heavy_top");
  double time = 0.0;
  for (std::size_t i = 0; i < known.at("t").size(); ++i) {
    const double until = known.at("t")[i];
    state = runge_kutta(tree, state, k_gravity_z, no_torque, until - time, static_cast<int>((until - time) * 4000.0));
    time = until;
    const TreeWorkspace work = accelerate(tree, state, k_gravity_z, no_torque(state)).work;
    EXPECT_LT((work.center_W[2] - vector_of(known.at("x_com")[i])).norm(), 1e-7) << "at " << time;
    const Vector3d spin = work.rotation[2].transpose() * work.angular_velocity_W[2];
    // The spin of 150 rad/s is conserved; 1e-7 rad of phase turns the transverse 5 rad/s by as little.
    EXPECT_LT((spin - vector_of(known.at("omega_body")[i])).norm(), 1e-5) << "at " << time;
  }
}

TEST_F(TreeReferences, FreeBodyTumblesAboutItsMiddleAxis) {
  Tree tree;
  tree.base_mass = 1.0;
  tree.base_inertia = Vector3d(1.0, 2.0, 3.0).asDiagonal();
  TreeState state = make_state(tree);
  state.angular_velocity << 1e-3, 5.0, 1e-3;
  const nlohmann::json& known = references_.at("dzhanibekov");
  // The middle axis is unstable: an error grows e^2.9 times a second until the body has turned over.
  for (std::size_t second = 0; second < 10; ++second) {
    state = runge_kutta(tree, state, Vector3d::Zero(), no_torque, 1.0, 4000);
    EXPECT_LT((state.angular_velocity - vector_of(known.at("omega")[second])).norm(), 1e-6) << second + 1 << " s";
  }
}

}  // namespace
}  // namespace grouser::test
