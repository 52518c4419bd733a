#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>

#include "tests/support/trees.h"

/// One hinged body, 2 m long, against curves of a commercial solver (../shared/references/rigid_body/adams).
namespace grouser::test {
namespace {

struct Curve {
  std::vector<double> time;
  std::vector<Vector3d> value;
};

Curve read_curve(const std::filesystem::path& file) {
  std::ifstream in(file);
  for (int header = 0; header < 3; ++header) in.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  Curve curve;
  double t = 0.0, x = 0.0, y = 0.0, z = 0.0;
  while (in >> t >> x >> y >> z) {
    curve.time.push_back(t);
    curve.value.emplace_back(x, y, z);
  }
  return curve;
}

struct Case {
  const char* name;
  TorqueLaw torque;
};
void PrintTo(const Case& shown, std::ostream* out) { *out << shown.name; }

class AdamsPendulum : public ::testing::TestWithParam<Case> {};

TEST_P(AdamsPendulum, MovesAndPullsAtItsHingeAsPublished) {
  const std::string start = std::string(GROUSER_SOURCE_DIR "/../shared/references/rigid_body/adams/") + GetParam().name;
  if (!std::filesystem::exists(start + "_ADAMS_Pos.txt"))
    GTEST_SKIP() << "the published curves are not here: " << start;
  const Curve position = read_curve(start + "_ADAMS_Pos.txt"), force = read_curve(start + "_ADAMS_Rforce.txt");
  const Curve torque = read_curve(start + "_ADAMS_Rtorque.txt");
  ASSERT_GT(position.time.size(), 400u);
  Tree tree;
  tree.base_fixed = true;
  TreeBody body;
  body.axis = Vector3d::UnitY();
  body.mass = 1.0;
  body.center_of_mass = Vector3d(2.0, 0.0, 0.0);
  body.inertia = Vector3d(0.04, 0.1, 0.1).asDiagonal();
  tree.bodies = {body};
  const Vector3d gravity(0.0, 0.0, -9.80665);
  TreeState state = make_state(tree);
  double worst_place = 0.0, worst_force = 0.0, worst_torque = 0.0;
  for (std::size_t i = 0; i + 1 < position.time.size(); ++i) {
    const TreeAnswer answer = accelerate(tree, state, gravity, GetParam().torque(state));
    const Vector6d reaction = joint_reaction(answer.work, 0);  // on the body; the curves show it on the ground
    worst_place = std::max(worst_place, (answer.work.center_W[0] - position.value[i]).norm());
    worst_force = std::max(worst_force, (reaction.tail<3>() + force.value[i]).norm());
    worst_torque = std::max(worst_torque, (reaction.head<3>() + torque.value[i]).norm());
    state = runge_kutta(tree, state, gravity, GetParam().torque, position.time[i + 1] - position.time[i], 10);
  }
  // What the curves were integrated to: 5e-6 m in place, 1e-4 of forces up to 30 N.
  EXPECT_LT(worst_place, 1e-5);
  EXPECT_LT(worst_force, 3e-3);
  EXPECT_LT(worst_torque, 5e-4);
}

INSTANTIATE_TEST_SUITE_P(
    Published, AdamsPendulum,
    ::testing::Values(
        Case{"revolute_joint/Revolute_Case01", [](const TreeState& s) -> Eigen::VectorXd { return 0.0 * s.angle; }},
        Case{"rotspring_force/RotSpring_Case01",
             [](const TreeState& s) -> Eigen::VectorXd { return -200.0 * s.angle - 10.0 * s.rate; }},
        Case{"rotspring_force/RotSpring_Case02",
             [](const TreeState& s) -> Eigen::VectorXd {
               return -(s.angle.array() * (50.0 + 10.0 * s.angle.array().abs()) + 10.0 * s.rate.array()).matrix();
             }}),
    [](const ::testing::TestParamInfo<Case>& of) {
      const std::string name = of.param.name;
      return name.substr(name.find('/') + 1);
    });

}  // namespace
}  // namespace grouser::test
