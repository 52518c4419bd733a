// The paper's own case: a static test and nothing else.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "identification/identify.h"
#include "tests/identification/bench.h"

namespace grouser {
namespace {

using ::testing::HasSubstr;

RigRecord static_only(RigTest test) {
  RigRecord rig = record_of({std::move(test)});
  rig.rig_compliance = 4e-10;
  return rig;
}

TEST(StaticTestAlone, GivesSpringAndFrictionAndSaysWhatIsUnknown) {
  Bench bench;
  const IdentifyResult result = identify(static_only(bench.measure(Axis::x, "x_static")));
  const AxisLaw& law = result.bushing.axis(Axis::x);
  EXPECT_TRUE(law.branches.empty());
  EXPECT_FALSE(law.stops.empty());
  EXPECT_LT(result.fit.tests[0].nrmse, 0.01);  // sensor noise is 0.1 % of the range
  ASSERT_FALSE(result.fit.axes[0].not_identified.empty());
  EXPECT_THAT(result.fit.axes[0].not_identified, ::testing::Contains(HasSubstr("rate dependence is unknown")));
  const Backbone truth = true_backbone(bench.axis(Axis::x));
  double worst = 0.0;
  const double top = truth.force.back();
  for (const BandPoint& point : result.fit.axes[0].backbone) {
    const auto at = static_cast<std::size_t>(
        std::lround((point.x - truth.displacement.front()) / (truth.displacement[1] - truth.displacement[0])));
    if (at >= truth.force.size()) continue;
    const double slope = 1.0e8, expected = truth.force[at] + slope * (point.x - truth.displacement[at]);
    worst = std::max(worst, std::abs(point.value - result.fit.axes[0].backbone.back().value - (expected - top)));
  }
  EXPECT_LT(worst, 0.02 * top);  // remounting gain .3 %, left-over conditioning 1 %, zero of the displacement
}

TEST(StaticTestAlone, OfOneRampWithoutReturnGivesTheSpring) {
  RigTest test = Bench().measure(Axis::x, "x_static");
  const auto peak = static_cast<std::size_t>(std::ranges::max_element(test.force) - test.force.begin());
  std::size_t turn = 0;
  while (turn + 5 < peak && test.displacement[turn + 5] > test.displacement[turn]) ++turn;
  for (auto* channel : {&test.time, &test.displacement, &test.force}) channel->resize(turn);
  const IdentifyResult result = identify(static_only(test));
  const AxisLaw& law = result.bushing.axis(Axis::x);
  EXPECT_TRUE(law.stops.empty());
  EXPECT_TRUE(law.branches.empty());
  EXPECT_LT(result.fit.tests[0].nrmse, 0.005);
  EXPECT_THAT(result.fit.axes[0].not_identified, ::testing::Contains(HasSubstr("friction and damping are unknown")));
}

TEST(StaticTestAlone, WorksWithoutATimeColumn) {
  RigTest test = Bench().measure(Axis::y, "y_static");
  const RigTest timed = test;
  test.time_measured = false;
  for (std::size_t i = 0; i < test.time.size(); ++i) test.time[i] = static_cast<double>(i);
  const IdentifyResult without = identify(record_of({test})), with = identify(record_of({timed}));
  EXPECT_NEAR(without.fit.tests[0].frequency, with.fit.tests[0].frequency, 0.01 * with.fit.tests[0].frequency);
  EXPECT_LT(without.fit.tests[0].nrmse, 0.005);
}

}  // namespace
}  // namespace grouser
