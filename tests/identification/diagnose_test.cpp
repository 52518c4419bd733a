// What the data show about the rig: each fault is put into one record of the bench and must be named.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "identification/diagnose.h"
#include "identification/identify.h"
#include "model/errors.h"
#include "tests/identification/prepared.h"

namespace grouser {
namespace {

using ::testing::HasSubstr;

RigTest loop() { return Bench().measure(Axis::x, "x_loop_0.2mm_1hz"); }

TEST(Diagnosis, FindsNothingWrongWithASoundRecord) {
  EXPECT_THAT(codes(Prepared(loop()).warnings), ::testing::IsEmpty());
}

TEST(Diagnosis, NamesSwappedColumnsAndLeavesTheTestOut) {
  RigTest test = loop();
  std::swap(test.displacement, test.force);
  const Prepared prepared(test);
  EXPECT_THAT(codes(prepared.warnings), ::testing::Contains("swapped_columns"));
  EXPECT_EQ(prepared.test.cycles_used(), 0);
  EXPECT_THROW((void)identify(record_of({test})), InputError);
}

TEST(Diagnosis, SaysThatReversedTimeOrALagLooksLikeSwappedColumns) {
  RigTest backwards = loop(), lagging = loop();
  std::ranges::reverse(backwards.displacement);
  std::ranges::reverse(backwards.force);
  std::ranges::rotate(lagging.force, lagging.force.end() - 40);  // 40 samples late: more than the rubber's own lead
  for (const RigTest& test : {backwards, lagging}) {
    const Prepared prepared(test);
    const auto warning = std::ranges::find(prepared.warnings, "swapped_columns", &FitWarning::code);
    ASSERT_NE(warning, prepared.warnings.end());
    EXPECT_THAT(warning->text, HasSubstr("swapped, or time runs backwards, or one channel lags"));
    EXPECT_THAT(warning->text, HasSubstr("degrees behind displacement"));
    EXPECT_THAT(warning->text, HasSubstr("the displacement column is the purer sine"));
    EXPECT_EQ(prepared.test.cycles_used(), 0);
  }
}

TEST(Diagnosis, NamesSpikes) {
  RigTest force = loop(), displacement = loop(), burst = loop();
  force.force[600] = force.force[900] = -1e9;
  displacement.displacement[700] = 0.01;
  displacement.time_measured = false;
  EXPECT_THAT(Prepared(force).text("spike"),
              HasSubstr("force leaps to -1e+06 kN in sample 601 (at 4 s) and back, and 1 times more"));
  EXPECT_THAT(Prepared(displacement).text("spike"),
              HasSubstr("displacement leaps to 10 mm in sample 701 and back, where"));
  for (std::size_t i = 600; i < 620; ++i) burst.force[i] *= 20.0;  // whatever it is, it lasts
  EXPECT_EQ(Prepared(burst).text("spike"), "");
}

TEST(Diagnosis, NamesSpikesOfEitherSignInShortRecords) {
  for (const double sign : {1.0, -1.0}) {
    RigTest ramp = loop();
    for (std::vector<double>* each : {&ramp.time, &ramp.displacement, &ramp.force}) each->resize(40);
    ramp.force[20] = 1e9 * sign;
    std::vector<FitWarning> warnings;
    find_spikes(ramp, warnings);
    ASSERT_EQ(warnings.size(), 1U) << sign;
    EXPECT_THAT(warnings[0].text, HasSubstr("in sample 21"));
  }
}

TEST(Diagnosis, NamesReversedPolarityOfEitherChannel) {
  RigTest force = loop(), displacement = loop();
  for (double& value : force.force) value = -value;
  for (double& value : displacement.displacement) value = -value;
  EXPECT_THAT(codes(Prepared(force).warnings), ::testing::Contains("reversed_polarity"));
  EXPECT_THAT(codes(Prepared(displacement).warnings), ::testing::Contains("reversed_polarity"));
}

TEST(Diagnosis, NamesAStatedFrequencyThatIsNotTheMeasuredOne) {
  RigTest test = loop();
  test.frequency = 1.03;
  const Prepared prepared(test);
  ASSERT_THAT(codes(prepared.warnings), ::testing::ElementsAre("wrong_frequency"));
  EXPECT_NEAR(prepared.test.frequency, 1.0, 1e-3);  // the measured one is used
  test.frequency = 1.005;
  EXPECT_THAT(codes(Prepared(test).warnings), ::testing::IsEmpty());  // half a per cent is an ordinary rig
}

TEST(Diagnosis, NamesAStatedAmplitudeThatIsNotTheMeasuredOne) {
  RigTest test = sine_test(0.25e-3, 1.0, 6, 200, [](double x, double rate) { return 1e7 * x + 1e5 * rate; });
  test.amplitude = 5e-3;
  const Prepared prepared(test);
  ASSERT_THAT(codes(prepared.warnings), ::testing::ElementsAre("wrong_amplitude"));
  EXPECT_THAT(prepared.warnings[0].text, HasSubstr("stated 5 mm, measured 0.25 mm"));
  test.amplitude = 0.26e-3;  // 4 per cent is an ordinary actuator
  EXPECT_THAT(codes(Prepared(test).warnings), ::testing::IsEmpty());
}

TEST(Diagnosis, TakesTheAmplitudeOfTheWholeColumnForRight) {
  RigTest test = sine_test(0.25e-3, 1.0, 6, 200, [](double x, double rate) { return 1e7 * x + 1e5 * rate; });
  for (double& x : test.displacement) x *= 2.0;
  for (const double stated : {0.25e-3, 0.5e-3}) {
    test.amplitude = stated;
    RigRecord rig = record_of({test});
    rig.bushings_in_series = 2;
    EXPECT_THAT(codes(Prepared(rig).warnings), ::testing::IsEmpty()) << stated;
  }
}

TEST(Diagnosis, LeavesOutARecordWithAHoleInItsTime) {
  RigTest sound = sine_test(1e-3, 1.0, 12, 200, [](double x, double rate) { return 1e7 * x + 1e5 * rate; });
  RigTest broken = sound;
  for (std::size_t i = 1201; i < broken.time.size(); ++i) broken.time[i] += 12.5;
  const Prepared prepared(broken);
  ASSERT_THAT(codes(prepared.warnings), ::testing::ElementsAre("time_gap"));
  EXPECT_THAT(prepared.warnings[0].text, HasSubstr("12.5 s after sample 1201 (at 6 s; the usual step is 0.005 s)"));
  EXPECT_NEAR(prepared.test.frequency, 1.0, 1e-6);  // told on either side; across the hole it would be half of that
  EXPECT_EQ(prepared.test.cycles_used(), 0);
  broken.name = "broken";
  const IdentifyResult result = identify(record_of({sound, broken}));
  EXPECT_GT(result.fit.tests[0].cycles_used, 0);
  EXPECT_LT(result.fit.tests[0].nrmse, 0.01);
  EXPECT_THROW((void)identify(record_of({broken})), InputError);
}

TEST(Diagnosis, TakesAFewLostSamplesForNoHole) {
  RigTest test = loop();
  for (auto* channel : {&test.time, &test.displacement, &test.force}) {
    channel->erase(channel->begin() + 400, channel->begin() + 403);
  }
  EXPECT_THAT(codes(Prepared(test).warnings), ::testing::Not(::testing::Contains("time_gap")));
}

TEST(Diagnosis, NamesDrift) {
  RigTest test = loop();
  const double range = 40e3;
  for (std::size_t i = 0; i < test.force.size(); ++i) {
    test.force[i] += 0.2 * range * static_cast<double>(i) / static_cast<double>(test.force.size());
  }
  const Prepared prepared(test);
  ASSERT_THAT(codes(prepared.warnings), ::testing::ElementsAre("drift"));
  EXPECT_THAT(prepared.warnings[0].text, HasSubstr("mean force"));
  EXPECT_THAT(prepared.warnings[0].text, HasSubstr("taken out of the fit"));
}

TEST(Diagnosis, SaysThatADriftOfTheDisplacementStaysInTheFit) {
  RigTest test = loop();
  for (std::size_t i = 0; i < test.displacement.size(); ++i) {
    test.displacement[i] += 0.2 * 0.4e-3 * static_cast<double>(i) / static_cast<double>(test.displacement.size());
  }
  const Prepared prepared(test);
  ASSERT_THAT(codes(prepared.warnings), ::testing::Contains("drift"));
  const auto drift = std::ranges::find(prepared.warnings, "drift", &FitWarning::code);
  EXPECT_THAT(drift->text, HasSubstr("mean displacement"));
  EXPECT_THAT(drift->text, HasSubstr("leaves it in"));
}

TEST(Diagnosis, NamesAClippedSensor) {
  RigTest test = loop();
  const double limit = 0.9 * *std::ranges::max_element(test.force);
  for (double& value : test.force) value = std::min(value, limit);
  const Prepared prepared(test);
  ASSERT_THAT(codes(prepared.warnings), ::testing::Contains("clipped_sensor"));
  EXPECT_THAT(prepared.warnings.front().text, HasSubstr("force stands at"));
}

TEST(Diagnosis, DoesNotTakeACoarseConverterForAClippedSensor) {
  RigTest test = sine_test(1e-3, 0.1, 9, 150, [](double x, double rate) { return 1e7 * x + 1e6 * rate; });
  for (double& value : test.displacement) value = std::round(value / 0.05e-3) * 0.05e-3;
  EXPECT_THAT(codes(Prepared(test).warnings), ::testing::Not(::testing::Contains("clipped_sensor")));
}

TEST(Diagnosis, NamesARecordWithTooFewSamples) {
  RigTest full = loop(), sparse = full;
  sparse.time.clear(), sparse.displacement.clear(), sparse.force.clear();
  for (std::size_t i = 0; i < full.time.size(); i += 5) {
    sparse.time.push_back(full.time[i]);
    sparse.displacement.push_back(full.displacement[i]);
    sparse.force.push_back(full.force[i]);
  }
  EXPECT_THAT(codes(Prepared(sparse).warnings), ::testing::Contains("few_samples"));
}

TEST(Diagnosis, SaysThatTwoRowsAreTooFewRatherThanStandingStill) {
  RigTest test = loop();
  for (auto* channel : {&test.time, &test.displacement, &test.force}) *channel = {channel->at(0), channel->at(20)};
  const Prepared prepared(test);
  ASSERT_THAT(codes(prepared.warnings), ::testing::ElementsAre("unusable_test"));
  EXPECT_EQ(prepared.test.unusable, "2 samples, too few for a cycle");
}

TEST(Diagnosis, NamesCyclesThatStillSettle) {
  Bench bench;
  RigErrors errors = bench.axis(Axis::x).errors;
  errors.conditioning = 0.6;
  errors.conditioning_cycles = 8.0;
  EXPECT_THAT(codes(Prepared(bench.measure(Axis::x, "x_loop_0.5mm_1hz", errors)).warnings),
              ::testing::Contains("unsettled_cycles"));
}

TEST(Diagnosis, NamesATiltedSpecimen) {
  RigTest test = loop();
  for (const double x : test.displacement) test.tilt.push_back(0.3 * x);
  EXPECT_THAT(codes(Prepared(test).warnings), ::testing::ElementsAre("tilted_specimen"));
}

TEST(Preparation, DropsTheConditioningCycles) {
  const Prepared prepared(loop());
  ASSERT_EQ(prepared.test.cycles.size(), 9u);
  EXPECT_EQ(prepared.test.cycles.front().note, "conditioning");
  EXPECT_FALSE(prepared.test.cycles[3].used);
  EXPECT_TRUE(prepared.test.cycles[4].used);
  // 12 % exp(-1.5 / 1.1) = 3 % more force in the middle of the second cycle
  EXPECT_GT(prepared.test.cycles[1].measured.dissipated_energy,
            1.02 * prepared.test.cycles[8].measured.dissipated_energy);
}

TEST(Preparation, DropsWhatTheRigFileAsks) {
  RigTest test = loop();
  test.discard_cycles = 7;
  const Prepared prepared(test);
  EXPECT_EQ(prepared.test.cycles_used(), 2);
  EXPECT_EQ(prepared.test.cycles[6].note, "discarded by the rig file");
}

TEST(Preparation, TakesTheTimeOfALoopWithoutOneFromItsFrequency) {
  RigTest test = loop();
  test.time_measured = false;
  for (std::size_t i = 0; i < test.time.size(); ++i) test.time[i] = static_cast<double>(i);
  test.frequency = 5.0;
  const Prepared prepared(test);
  EXPECT_TRUE(prepared.test.rate_known);
  EXPECT_NEAR(prepared.test.frequency, 5.0, 0.02);
}

}  // namespace
}  // namespace grouser
