#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>

#include "tests/support/tree_references.h"

/// One hinged body, 2 m long, against curves of a commercial solver.
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

/// Largest distances from a curve.
struct Distance {
  double center = 0.0, force = 0.0, moment = 0.0;
  void see(const HingedRod::At& found, const HingedRod::At& known) {
    center = std::max(center, (found.center - known.center).norm());
    force = std::max(force, (found.force - known.force).norm());
    moment = std::max(moment, (found.moment - known.moment).norm());
  }
  // The curves' own error: 8e-6 m in place and 1.2e-3 N of forces up to 30 N against an integration to 1e-12.
  void expect_small(const HingedRod& rod) const {
    EXPECT_LT(center, 1e-5);
    EXPECT_LT(force, 3e-3);
    EXPECT_LT(moment, rod.moment_tolerance);
  }
};

class AdamsRod : public ::testing::TestWithParam<HingedRod> {};

TEST_P(AdamsRod, MovesAndPullsAtItsHingeAsPublished) {
  const HingedRod& rod = GetParam();
  TreeState state = rod.start;
  double time = 0.0;
  Distance distance;
  for (const HingedRod::At& known : rod.known) {
    const double ahead = known.time - time;
    state = runge_kutta(rod.tree, state, rod.gravity, rod.torque, ahead, static_cast<int>(ahead * 1000.0));
    time = known.time;
    distance.see(observe(rod, state, time), known);
  }
  distance.expect_small(rod);
}

TEST_P(AdamsRod, FollowsTheWholeCurves) {
  const HingedRod& rod = GetParam();
  const std::string start = std::string(GROUSER_SOURCE_DIR "/../shared/references/rigid_body/adams/") + rod.name;
  if (!std::filesystem::exists(start + "_ADAMS_Pos.txt"))
    GTEST_SKIP() << "the published curves are not here: " << start;
  const Curve center = read_curve(start + "_ADAMS_Pos.txt"), force = read_curve(start + "_ADAMS_Rforce.txt");
  const Curve moment = read_curve(start + "_ADAMS_Rtorque.txt");
  ASSERT_GT(center.time.size(), 400u);
  TreeState state = rod.start;
  Distance distance;
  for (std::size_t i = 0; i + 1 < center.time.size(); ++i) {
    distance.see(observe(rod, state, center.time[i]),
                 {center.time[i], center.value[i], force.value[i], moment.value[i]});
    state = runge_kutta(rod.tree, state, rod.gravity, rod.torque, center.time[i + 1] - center.time[i], 10);
  }
  distance.expect_small(rod);
}

INSTANTIATE_TEST_SUITE_P(Published, AdamsRod, ::testing::ValuesIn(adams_rods()),
                         [](const ::testing::TestParamInfo<HingedRod>& of) {
                           return of.param.name.substr(of.param.name.find('/') + 1);
                         });

}  // namespace
}  // namespace grouser::test
