// One bad mounting must not spoil an axis, and a sound campaign must not lose a test.
#include <gtest/gtest.h>

#include <algorithm>

#include "identification/axis_fit.h"
#include "identification/robust_weights.h"
#include "tests/identification/bench.h"
#include "tests/identification/law_campaign.h"

namespace grouser {
namespace {

std::vector<RigTest> campaign_of(Axis axis) {
  const Bench bench;
  std::vector<RigTest> tests;
  for (const PlannedTest& plan : bench.axis(axis).tests) tests.push_back(bench.measure(axis, plan.name));
  return tests;
}

std::vector<RigTest> with_wrong_gain(std::vector<RigTest> tests, std::size_t which) {
  for (double& force : tests[which].force) force *= 1.3;
  return tests;
}

double force_range_of(const AxisLaw& law, double amplitude, double frequency) {
  const RigTest loop = sine_test(amplitude, frequency, 4, 200, [](double, double) { return 0.0; });
  const std::vector<double> force = replay(law, loop.time, loop.displacement);
  const auto [low, high] = std::minmax_element(force.begin() + 400, force.end());
  return *high - *low;
}

AxisLaw law_of(const AxisData& data) {
  const AxisSolution solution = fit_axis(data);
  return make_law(solution.dictionary, solution.coefficients);
}

TEST(RobustWeights, KeepAnAxisFromOneMountingWithAWrongGain) {
  const Axis axis = Axis::y;
  const LawCampaign clean(campaign_of(axis));
  LawCampaign spoilt(with_wrong_gain(campaign_of(axis), 5));
  const AxisLaw truth = law_of(clean.data), misled = law_of(spoilt.data);
  weigh_tests(spoilt.data);
  const AxisLaw robust = law_of(spoilt.data);
  for (std::size_t b = 0; b < spoilt.data.blocks.size(); ++b) {
    if (spoilt.data.blocks[b].test == &spoilt.tests[5])
      EXPECT_LT(spoilt.data.blocks[b].robust_weight, 0.1);
    else
      EXPECT_EQ(spoilt.data.blocks[b].robust_weight, 1.0) << spoilt.data.blocks[b].test->source->name;
  }
  double worst_robust = 0.0, worst_misled = 0.0;
  for (const double amplitude : {0.1e-3, 0.3e-3, 1.0e-3}) {
    for (const double frequency : {0.1, 2.0, 30.0}) {
      const double expected = force_range_of(truth, amplitude, frequency);
      worst_robust = std::max(worst_robust, std::abs(force_range_of(robust, amplitude, frequency) / expected - 1.0));
      worst_misled = std::max(worst_misled, std::abs(force_range_of(misled, amplitude, frequency) / expected - 1.0));
    }
  }
  EXPECT_LT(worst_robust, 0.01);  // 30 % times the weight that is left, over the tests that share the cell
  EXPECT_GT(worst_misled, 0.03);  // what all tests with one say would do
}

TEST(RobustWeights, LeaveEveryTestOfASoundCampaignItsSay) {
  for (const Axis axis : {Axis::x, Axis::y, Axis::z, Axis::rx, Axis::ry, Axis::rz}) {
    LawCampaign clean(campaign_of(axis));
    clean.rig.rig_compliance = 0.0;
    weigh_tests(clean.data);
    for (const DataBlock& block : clean.data.blocks) EXPECT_EQ(block.robust_weight, 1.0) << block.test->source->name;
  }
}

TEST(RobustWeights, DoNotLetTwoTestsOutvoteAThird) {
  std::vector<RigTest> tests = with_wrong_gain(campaign_of(Axis::y), 2);
  tests.resize(3);
  LawCampaign campaign(std::move(tests));
  weigh_tests(campaign.data);
  for (const DataBlock& block : campaign.data.blocks) EXPECT_EQ(block.robust_weight, 1.0);
}

}  // namespace
}  // namespace grouser
