// Drawn bushings: whole, small, physical, and the same for any number of threads.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "identification/identify.h"
#include "tests/identification/bench.h"

namespace grouser {
namespace {

RigRecord two_axes() {
  const Bench bench;
  std::vector<RigTest> tests;
  for (const Axis axis : {Axis::y, Axis::rx}) {
    for (const PlannedTest& plan : bench.axis(axis).tests) tests.push_back(bench.measure(axis, plan.name));
  }
  return record_of(std::move(tests));
}

TEST(Draws, AreWholeBushingsThatARunCanUse) {
  const IdentifyResult result = identify(two_axes());
  ASSERT_EQ(result.draws.size(), 60u);
  EXPECT_EQ(result.fit.axes.at(0).draws, 60);
  EXPECT_EQ(result.draws.at(4).name, "bench, draw 5 of 60");
  for (const Bushing& draw : result.draws) {
    for (const Axis axis : {Axis::y, Axis::rx}) {
      const AxisLaw& law = draw.axis(axis);
      EXPECT_LE(law.stops.size(), 8u);
      EXPECT_LE(law.branches.size(), 8u);
      EXPECT_TRUE(law.valid.has_value());
      EXPECT_GE(*std::ranges::min_element(law.spring.slope), 0.0);
      for (const FrictionStop& stop : law.stops) EXPECT_GT(stop.stiffness, 0.0);
      for (const MaxwellBranch& branch : law.branches) EXPECT_GT(branch.stiffness, 0.0);
    }
    EXPECT_TRUE(draw.axis(Axis::x).spring.displacement.empty());  // no test, no law
  }
}

TEST(Draws, AreTheSameBitsForAnyNumberOfThreads) {
  const IdentifyResult one = identify(two_axes(), {.threads = 1}), two = identify(two_axes(), {.threads = 2});
  for (std::size_t k = 0; k < one.draws.size(); ++k) {
    EXPECT_EQ(one.draws[k].axis(Axis::rx).spring.force, two.draws[k].axis(Axis::rx).spring.force) << k;
  }
  EXPECT_EQ(one.fit.axes.at(1).responses.back().energy.high, two.fit.axes.at(1).responses.back().energy.high);
}

TEST(Draws, StateEveryCellOfTheTestedGrid) {
  const IdentifyResult result = identify(two_axes());
  const AxisFit& y = result.fit.axes.at(0);
  ASSERT_EQ(y.responses.size(), 9u);                             // .1 .3 1 mm by .1 2 30 Hz
  EXPECT_NEAR(y.responses[4].amplitude, 0.3e-3, 0.01 * 0.3e-3);  // noise of two extremes
  EXPECT_NEAR(y.responses[4].frequency, 2.0, 1e-3 * 2.0);
  for (const ResponsePoint& cell : y.responses) {
    EXPECT_LE(cell.energy.low, cell.energy.value);
    EXPECT_GE(cell.energy.high, cell.energy.value);
    EXPECT_GT(cell.energy.high, cell.energy.low);
  }
}

TEST(Draws, SayWhatOneAmplitudeLeavesOpen) {
  std::vector<RigTest> tests;
  for (const double frequency : {1.0, 10.0}) {
    tests.push_back(sine_test(1e-3, frequency, 6, 200, [](double x, double rate) { return 1e7 * x + 1e4 * rate; }));
    tests.back().name = "sine_" + std::to_string(frequency);
  }
  EXPECT_THAT(identify(record_of(tests)).fit.axes.at(0).not_identified,
              ::testing::Contains(::testing::HasSubstr("one amplitude")));
}

}  // namespace
}  // namespace grouser
