// Every correction against a truth in closed form: with it the answer is right, without it measurably wrong, and it is
// made only when asked for, and listed.
#include "identification/corrections.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "identification/identify.h"
#include "model/bushing_law.h"
#include "tests/identification/prepared.h"

namespace grouser {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double k_pi = std::numbers::pi, k_stiffness = 5e7, k_damping = 1e5, k_amplitude = 1e-3;

double kelvin_voigt(double x, double rate) { return k_stiffness * x + k_damping * rate; }

RigTest loops(double frequency = 1.0, int cycles = 12, int samples = 200) {
  return sine_test(k_amplitude, frequency, cycles, samples, kelvin_voigt);
}

RigTest asking(RigTest test, CorrectionKind kind) {
  test.corrections.push_back(kind);
  return test;
}

TEST(Correction, OfNothingIsListedUnasked) { EXPECT_THAT(Prepared(loops()).corrections, IsEmpty()); }

TEST(Correction, OfComplianceAndSeriesGivesOneBushing) {
  for (const Axis axis : {Axis::x, Axis::ry}) {
    RigTest test = loops();
    test.axis = axis;
    for (std::size_t i = 0; i < test.force.size(); ++i) {
      test.displacement[i] = 2.0 * test.displacement[i] + 1e-9 * test.force[i];
    }
    RigRecord rig = record_of({test});
    const double uncorrected = Prepared(rig).last().storage_stiffness;
    rig.bushings_in_series = 2;
    (is_rotation(axis) ? rig.rig_angular_compliance : rig.rig_compliance) = 1e-9;
    const Prepared prepared(rig);
    EXPECT_NEAR(prepared.test.cycles.back().amplitude, k_amplitude, 1e-6 * k_amplitude);
    EXPECT_NEAR(prepared.last().storage_stiffness, k_stiffness, 1e-6 * k_stiffness);  // linear at every sample
    EXPECT_NEAR(prepared.last().loss_stiffness, 2.0 * k_pi * k_damping, 1e-6 * k_stiffness);
    EXPECT_LT(uncorrected, 0.51 * k_stiffness);
    const auto listed = campaign_corrections({prepared.test}, rig);
    EXPECT_THAT(codes(listed), ElementsAre("rig_compliance", "bushings_in_series"));
    EXPECT_THAT(listed[0].text, HasSubstr(is_rotation(axis) ? "1e-09 rad/(N m)" : "1e-09 m/N"));
  }
}

TEST(Correction, OfInertiaGivesTheSpecimensForce) {
  // A motion with a third harmonic moves a mass that the cell drives too: cell = specimen + m x''.
  const double mass = 50.0, frequency = 50.0, omega = 2.0 * k_pi * frequency;
  for (const Axis axis : {Axis::x, Axis::ry}) {
    RigTest test = loops(frequency, 12, 200);
    test.axis = axis;
    std::vector<double> specimen;
    std::mt19937 random(5);
    std::normal_distribution<double> noise(0.0, 1e-3 * k_amplitude);
    for (std::size_t i = 0; i < test.time.size(); ++i) {
      const double phase = omega * test.time[i];
      const double x = k_amplitude * (std::sin(phase) + 0.05 * std::sin(3.0 * phase));
      const double rate = k_amplitude * omega * (std::cos(phase) + 0.15 * std::cos(3.0 * phase));
      const double acceleration = -k_amplitude * omega * omega * (std::sin(phase) + 0.45 * std::sin(3.0 * phase));
      specimen.push_back(kelvin_voigt(x, rate));
      test.displacement[i] = x + noise(random);
      test.force[i] = specimen.back() + mass * acceleration;
    }
    RigRecord rig = record_of({test});
    const double uncorrected = Prepared(rig).last().storage_stiffness;
    (is_rotation(axis) ? rig.moving_inertia : rig.moving_mass) = mass;
    const Prepared prepared(rig);
    // noise of a harmonic's amplitude: 1e-3 sqrt(2 / 200), of the third one nine times that, on m omega^2 = 0.1 K
    EXPECT_NEAR(prepared.last().storage_stiffness, k_stiffness, 5e-4 * k_stiffness);
    EXPECT_NEAR(uncorrected, k_stiffness - mass * omega * omega, 5e-4 * k_stiffness);
    for (std::size_t i = 400; i < 600; ++i) {
      EXPECT_NEAR(prepared.test.force[i], specimen[i], 1e-3 * k_stiffness * k_amplitude) << i;
    }
    ASSERT_THAT(codes(prepared.corrections), ElementsAre("moving_mass"));
    EXPECT_THAT(prepared.corrections[0].text, HasSubstr(is_rotation(axis) ? "50 kg m^2" : "50 kg between"));
  }
}

TEST(Correction, OfInertiaLeavesARampAlone) {
  RigTest test = loops(0.01);
  test.kind = TestKind::static_ramp;
  RigRecord rig = record_of({test});
  rig.moving_mass = 1e6;
  EXPECT_THAT(Prepared(rig).corrections, IsEmpty());
}

TEST(Correction, OfTemperatureGivesTheForceAtTheReference) {
  RigTest test = loops(1.0, 20);
  for (std::size_t i = 0; i < test.force.size(); ++i) {
    test.temperature.push_back(293.15 + 1.0 * test.time[i]);
    test.force[i] *= 1.0 - 0.005 * test.time[i];
  }
  RigRecord rig = record_of({test});
  const Prepared uncorrected(rig);
  EXPECT_LT(uncorrected.last().storage_stiffness, 0.91 * k_stiffness);
  EXPECT_THAT(uncorrected.text("thermal_softening"), HasSubstr("% a kelvin"));
  rig.thermal = ThermalCorrection{-0.005, 293.15};
  const Prepared prepared(rig);
  EXPECT_NEAR(prepared.last().storage_stiffness, k_stiffness, 1e-6 * k_stiffness);
  EXPECT_EQ(prepared.text("thermal_softening"), "");
  ASSERT_THAT(codes(prepared.corrections), ElementsAre("thermal"));
  EXPECT_THAT(prepared.corrections[0].text, HasSubstr("raised by 0.00 to 11.11 %"));
}

TEST(Correction, OfAReversedForceMakesTheTestUsable) {
  RigTest test = loops();
  for (double& force : test.force) force = -force;
  EXPECT_FALSE(Prepared(test).test.unusable.empty());
  const Prepared prepared(asking(test, CorrectionKind::reverse_force));
  EXPECT_NEAR(prepared.last().storage_stiffness, k_stiffness, 1e-6 * k_stiffness);
  EXPECT_THAT(prepared.warnings, IsEmpty());
  EXPECT_THAT(codes(prepared.corrections), ElementsAre("reverse_force"));
}

TEST(Correction, OfSwappedColumnsIsTheReadersAndListed) {
  EXPECT_THAT(codes(Prepared(asking(loops(), CorrectionKind::swap_columns)).corrections), ElementsAre("swap_columns"));
}

// Spring and stop behind a fixture with a gap: in contact with one side while pulled, with the other while pushed, and
// left where its force vanished in between.
RigTest with_play(double width) {
  RigTest test = loops(1.0, 10, 400);
  double specimen = 0.0, deflection = 0.0;
  int contact = 0;
  const auto force = [&] { return k_stiffness * specimen + 1e7 * deflection; };
  const int fine = 50;  // steps a sample, so that contact is lost where the force vanishes
  for (int i = 0; i < fine * static_cast<int>(test.time.size() - 1) + 1; ++i) {
    const double x = k_amplitude * std::sin(2.0 * k_pi * i / (400.0 * fine)), before = specimen;
    if (contact == 0 && x - 0.5 * width > specimen) contact = 1;
    if (contact == 0 && x + 0.5 * width < specimen) contact = -1;
    if (contact != 0) specimen = x - 0.5 * width * contact;
    deflection = advance_stop(deflection, specimen - before, 0.1e-3);
    if (i % fine == 0) test.force[static_cast<std::size_t>(i / fine)] = force();
    if (contact * force() <= 0.0) contact = 0;
  }
  return test;
}

TEST(Correction, OfBacklashGivesTheSpecimensLoop) {
  const double width = 0.2e-3;
  const RigTest test = with_play(width);
  const Prepared uncorrected(test), prepared(asking(test, CorrectionKind::remove_backlash));
  // The force at the ends is right in both; the path to it is longer by the gap without the correction.
  const double reach = k_amplitude - 0.5 * width;
  const double secant = k_stiffness + 1e7 * 0.1e-3 / reach;
  EXPECT_NEAR(prepared.last().secant_stiffness, secant, 0.01 * secant);
  EXPECT_NEAR(uncorrected.last().secant_stiffness, secant * reach / k_amplitude, 0.01 * secant);
  ASSERT_THAT(codes(prepared.corrections), ElementsAre("remove_backlash"));
  EXPECT_NE(uncorrected.text("backlash"), "");
  EXPECT_EQ(prepared.text("backlash"), "");
  const double right = identify(record_of({asking(test, CorrectionKind::remove_backlash)})).fit.tests[0].nrmse;
  EXPECT_LT(right, 0.005);  // the band that counts as standing is 0.3 % of the range on either side
}

TEST(Correction, OfCreepGivesTheStandingLoop) {
  // A hardening spring: on a linear one a wandering middle is nothing but a wandering force zero.
  RigTest test = sine_test(k_amplitude, 1.0, 16, 200, [](double x, double rate) {
    return kelvin_voigt(x, rate) + k_stiffness * x * x * x / (k_amplitude * k_amplitude);
  });
  std::mt19937 random(9);
  std::normal_distribution<double> noise(0.0, 2e-6);
  const auto creep = [](double t) { return 0.3e-3 * std::log1p(t / 0.8); };
  for (std::size_t i = 0; i < test.time.size(); ++i) test.displacement[i] += creep(test.time[i]) + noise(random);
  const Prepared uncorrected(test), prepared(asking(test, CorrectionKind::remove_creep));
  EXPECT_NE(uncorrected.text("drift"), "");
  EXPECT_EQ(prepared.text("drift"), "");
  ASSERT_THAT(codes(prepared.corrections), ElementsAre("remove_creep"));
  const auto farthest = [&](const Prepared& one) {  // from the specimen's own motion, whose middle is the force's zero
    double worst = 0.0;
    for (std::size_t i = 200; i < test.time.size(); ++i) {
      const double truth = k_amplitude * std::sin(2.0 * k_pi * test.time[i]);
      worst = std::max(worst, std::abs(one.test.displacement[i] - truth));
    }
    return worst;
  };
  // The truth has the fitted form, but within the first cycle it bends, and a cycle tells its mean only: 1.9 %
  // measured.
  EXPECT_LT(farthest(prepared), 0.03 * creep(16.0));
  EXPECT_GT(farthest(uncorrected), 0.99 * creep(16.0));
}

TEST(Correction, OfConditioningGivesTheSettledForce) {
  RigTest test = loops(1.0, 14);
  for (std::size_t i = 0; i < test.time.size(); ++i) test.force[i] *= 1.0 + 0.3 * std::exp(-test.time[i] / 4.0);
  test.discard_cycles = 0;
  const auto stiffness = [](const RigTest& source) {
    const Prepared prepared(source);
    double sum = 0.0;
    for (const Cycle& cycle : prepared.test.cycles) sum += cycle.measured.storage_stiffness / 14.0;
    return sum;
  };
  EXPECT_GT(stiffness(test), 1.05 * k_stiffness);
  // ranges are read at the two extremes of a cycle, the decay goes on between them
  EXPECT_NEAR(stiffness(asking(test, CorrectionKind::remove_conditioning)), k_stiffness, 0.005 * k_stiffness);
  const Prepared prepared(asking(test, CorrectionKind::remove_conditioning));
  ASSERT_THAT(codes(prepared.corrections), ElementsAre("remove_conditioning"));
}

TEST(Correction, OfJumpsUsesThePartsBesideThem) {
  for (const double jump : {12.5, -3.0}) {
    RigTest test = loops(1.0, 16);
    for (std::size_t i = 1687; i < test.time.size(); ++i) test.time[i] += jump;
    EXPECT_THAT(codes(Prepared(test).warnings), ElementsAre("time_gap"));
    test.corrections.push_back(CorrectionKind::segment_at_jumps);
    const Prepared prepared(test);
    EXPECT_THAT(prepared.warnings, IsEmpty()) << jump;
    EXPECT_THAT(codes(prepared.corrections), ElementsAre("segment_at_jumps"));
    EXPECT_EQ(prepared.test.blocks, 2);
    EXPECT_NEAR(prepared.test.frequency, 1.0, 1e-6);
    EXPECT_NEAR(prepared.last().storage_stiffness, k_stiffness, 1e-6 * k_stiffness);
    const TestFit fit = identify(record_of({test})).fit.tests[0];
    EXPECT_NEAR(fit.fitted.storage_stiffness, k_stiffness, 0.002 * k_stiffness);
    EXPECT_NEAR(fit.fitted.dissipated_energy, k_pi * 2.0 * k_pi * k_damping * 1e-6, 0.01 * 2.0);
  }
}

TEST(Correction, OfAPhaseBreakUsesTheCyclesBesideIt) {
  RigTest test = loops(1.0, 16);
  // 60 of a cycle's 200 samples are lost and the clock counts on
  for (auto* channel : {&test.displacement, &test.force}) {
    channel->erase(channel->begin() + 1630, channel->begin() + 1690);
  }
  test.time.resize(test.force.size());
  const Prepared uncorrected(test);
  EXPECT_THAT(codes(uncorrected.warnings), ElementsAre("phase_break"));
  EXPECT_THAT(uncorrected.text("phase_break"), HasSubstr("in cycle 9 (-28"));
  EXPECT_EQ(uncorrected.test.cycles_used(), 0);
  EXPECT_NEAR(uncorrected.last().dissipated_energy, k_pi * 2.0 * k_pi * k_damping * 1e-6,
              1e-3);  // measured all the same
  const Prepared prepared(asking(test, CorrectionKind::segment_at_jumps));
  EXPECT_THAT(prepared.warnings, IsEmpty());
  EXPECT_EQ(prepared.test.cycles[8].note, "phase break");
  EXPECT_EQ(prepared.test.cycles[9].note, "first cycle after a jump");
  EXPECT_EQ(prepared.test.blocks, 2);
  EXPECT_NEAR(prepared.test.frequency, 1.0, 1e-6);
  EXPECT_NEAR(prepared.last().storage_stiffness, k_stiffness, 1e-6 * k_stiffness);
}

}  // namespace
}  // namespace grouser
