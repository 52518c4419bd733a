// Materials whose law is known exactly.
#include "identification/identify.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "model/errors.h"
#include "tests/identification/bench.h"

namespace grouser {
namespace {

TEST(Identify, WritesAViscousDamperAsAFastBranch) {
  std::vector<RigTest> tests;
  for (const double frequency : {0.5, 2.0, 10.0, 40.0}) {
    tests.push_back(sine_test(1e-3, frequency, 6, 200, [](double x, double rate) { return 1e7 * x + 1e4 * rate; }));
    tests.back().name = "sine_" + std::to_string(frequency);
  }
  const IdentifyResult result = identify(record_of(tests));
  const AxisLaw& law = result.bushing.axis(Axis::x);
  double damping = 0.0;
  for (const MaxwellBranch& branch : law.branches) damping += branch.stiffness * branch.relaxation_time;
  EXPECT_NEAR(damping, 1e4, 0.02 * 1e4);  // at 40 Hz a branch of the fastest time kept is a damper within 1 %
  for (const TestFit& test : result.fit.tests) {
    EXPECT_NEAR(test.fitted.dissipated_energy, test.measured.dissipated_energy, 0.02 * test.measured.dissipated_energy);
    EXPECT_NEAR(test.fitted.equivalent_damping, 1e4, 0.02 * 1e4);
  }
}

TEST(Identify, OfALinearSpringIsThatSpring) {
  const IdentifyResult result =
      identify(record_of({sine_test(1e-3, 1.0, 5, 200, [](double x, double) { return 1e7 * x; })}));
  const AxisLaw& law = result.bushing.axis(Axis::x);
  EXPECT_TRUE(law.stops.empty());
  for (const double x : {-0.9e-3, 0.2e-3, 0.9e-3}) EXPECT_NEAR(evaluate(law.spring, x).force, 1e7 * x, 1e-3 * 1e4);
  EXPECT_GT(result.fit.tests[0].r_squared, 1.0 - 1e-9);
}

TEST(Identify, FindsTheYieldOfALoneStop) {
  std::vector<RigTest> tests;
  for (const double amplitude : {0.1e-3, 0.3e-3, 1e-3}) {
    double deflection = 0.0, before = 0.0;
    tests.push_back(sine_test(amplitude, 1.0, 6, 400, [&](double x, double) {
      deflection = std::clamp(deflection + x - before, -0.08e-3, 0.08e-3);
      before = x;
      return 1e7 * x + 5e6 * deflection;
    }));
    tests.back().name = "sine_" + std::to_string(amplitude);
  }
  const AxisLaw law = identify(record_of(tests)).bushing.axis(Axis::x);
  double stiffness = 0.0, moment = 0.0;
  for (const FrictionStop& stop : law.stops) stiffness += stop.stiffness, moment += stop.stiffness * stop.yield;
  EXPECT_NEAR(stiffness, 5e6, 0.03 * 5e6);
  EXPECT_NEAR(moment / stiffness, 0.08e-3,
              0.03 * 0.08e-3);  // a sample's step is 2 % of the yield at the largest amplitude
}

TEST(Identify, RefusesDataThatStandStill) {
  const RigTest still = sine_test(1e-3, 1.0, 5, 200, [](double, double) { return 0.0; });
  try {
    (void)identify(record_of({still}));
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_EQ(error.findings().front().place, "/tests/0");
    EXPECT_EQ(error.findings().front().found, "a force that stands still");
  }
}

TEST(Identify, RefusesAnAxisWhoseForceFalls) {
  const RigTest reversed = sine_test(1e-3, 1.0, 5, 200, [](double x, double) { return -1e7 * x; });
  EXPECT_THROW((void)identify(record_of({reversed})), InputError);
}

TEST(Identify, KeepsTheSoundTestsWhenOneIsSwapped) {
  const auto law = [](double x, double rate) { return 1e7 * x + 1e4 * rate; };
  RigTest sound = sine_test(1e-3, 5.0, 6, 200, law), swapped = sound;
  std::swap(swapped.displacement, swapped.force);
  swapped.name = "swapped";
  const IdentifyResult result = identify(record_of({sound, swapped}));
  EXPECT_GT(result.fit.tests[0].cycles_used, 0);
  EXPECT_EQ(result.fit.tests[1].cycles_used, 0);
  EXPECT_LT(result.fit.tests[0].nrmse, 0.01);
}

TEST(Identify, ReportsTheSensorsZeroItsDriftAndTheTestsGain) {
  // Two equal records; the second has a zero, a drift and 4 % more force. Both weigh the same, so the law lies midway.
  const auto law = [](double x, double rate) { return 1e7 * x + 1e4 * rate; };
  RigTest plain = sine_test(1e-3, 5.0, 8, 200, law), shifted = plain;
  shifted.name = "shifted";
  const double duration = shifted.time.back();
  for (std::size_t i = 0; i < shifted.force.size(); ++i) {
    shifted.force[i] = 1.04 * shifted.force[i] + 500.0 + 200.0 * (shifted.time[i] / duration - 0.5);
  }
  const std::vector<TestFit> tests = identify(record_of({plain, shifted})).fit.tests;
  // both are held against the same law, somewhere between them
  EXPECT_NEAR((1.0 + tests[1].gain) / (1.0 + tests[0].gain), 1.04, 1e-3);
  EXPECT_NEAR(tests[0].force_drift, 0.0, 1.0);
  const double used = static_cast<double>(tests[1].cycles_used) / 8.0;  // the last ones
  EXPECT_NEAR(tests[1].force_drift, 200.0 * used, 2.0);
  EXPECT_NEAR(tests[1].force_zero - tests[0].force_zero, 500.0 + 100.0 * (1.0 - used), 5.0);
}

TEST(Identify, StopsWhenItsCallerAsks) {
  const RigTest test = sine_test(1e-3, 1.0, 5, 200, [](double x, double rate) { return 1e7 * x + 1e4 * rate; });
  EXPECT_THROW((void)identify(record_of({test}), {}, [](const ProgressReport&) { return false; }), Interrupted);
}

TEST(Identify, HoldsAMillionSamples) {
  // Cycles are not replicates: the last ten of two thousand are fitted, the whole history is followed. About a second;
  // the test's limit stands in the suite's time-out.
  const RigTest test = sine_test(1e-3, 1.0, 2000, 500, [](double x, double rate) { return 1e7 * x + 1e5 * rate; });
  const IdentifyResult result = identify(record_of({test}));
  EXPECT_EQ(result.fit.tests[0].cycles, 2000);
  EXPECT_EQ(result.fit.tests[0].cycles_used, 10);
  EXPECT_LE(result.fit.tests[0].curve.force.size(), 602u);
}

}  // namespace
}  // namespace grouser
