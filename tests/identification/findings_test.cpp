// Each finding with a record that shows it and with a near miss that does not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "identification/cycle_findings.h"
#include "tests/identification/prepared.h"

namespace grouser {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr double k_pi = std::numbers::pi, k_stiffness = 5e7, k_amplitude = 1e-3;
constexpr double k_force_range = 2.0 * k_stiffness * k_amplitude;

double kelvin_voigt(double x, double rate) { return k_stiffness * x + 1e5 * rate; }

RigTest loops(int cycles = 12, int samples = 200) { return sine_test(k_amplitude, 1.0, cycles, samples, kelvin_voigt); }

/// Loops whose force is multiplied by a function of the cycle number (a real one).
template <typename Factor>
RigTest scaled_loops(int cycles, Factor factor) {
  RigTest test = loops(cycles);
  for (std::size_t i = 0; i < test.force.size(); ++i) test.force[i] *= factor(test.time[i]);
  return test;
}

/// Loops whose displacement is multiplied by a function of the cycle number, and the force with it.
template <typename Factor>
RigTest stretched_loops(int cycles, Factor factor) {
  RigTest test = scaled_loops(cycles, factor);
  for (std::size_t i = 0; i < test.displacement.size(); ++i) test.displacement[i] *= factor(test.time[i]);
  return test;
}

RigTest shifted(RigTest test, double displacement, double force) {
  for (double& x : test.displacement) x += displacement;
  for (double& f : test.force) f += force;
  return test;
}

TEST(Offset, OfTheForceIsNamedAboveFivePerCentOfItsRange) {
  const Prepared off(shifted(loops(), 0.0, 0.07 * k_force_range));
  EXPECT_THAT(codes(off.warnings), ::testing::ElementsAre("offset"));
  EXPECT_THAT(off.text("offset"), HasSubstr("(7 %): the zero of the force"));
  EXPECT_THAT(Prepared(shifted(loops(), 0.0, 0.04 * k_force_range)).warnings, IsEmpty());
}

TEST(Offset, OfTheDisplacementIsNamedWithoutAPreset) {
  RigTest test = shifted(loops(), 0.2e-3, 0.0);
  EXPECT_THAT(Prepared(test).text("offset"), HasSubstr("0.2 mm (10 % of their range)"));
  test.preset = 0.2e-3;
  EXPECT_THAT(Prepared(test).warnings, IsEmpty());
  test.preset = 0.5e-3;
  EXPECT_THAT(Prepared(test).text("offset"), HasSubstr("states a preset of 0.5 mm"));
  EXPECT_THAT(Prepared(shifted(loops(), 0.08e-3, 0.0)).warnings, IsEmpty());
}

TEST(Offset, OfARotationReadsInDegrees) {
  RigTest test = shifted(loops(), 0.2e-3, 0.0);
  test.axis = Axis::ry;
  EXPECT_THAT(Prepared(test).text("offset"), HasSubstr("0.01146 deg"));
}

TEST(Offset, OfAnAsymmetricSpringIsNone) {
  const auto law = [](double x, double rate) { return kelvin_voigt(x, rate) + 3e10 * x * x; };  // 60 % at the ends
  EXPECT_THAT(Prepared(sine_test(k_amplitude, 1.0, 12, 200, law)).warnings, IsEmpty());
}

TEST(Offset, OfARampIsNamedWhereItStarts) {
  RigTest ramp;
  ramp.kind = TestKind::static_ramp;
  ramp.time_measured = true;
  for (int i = 0; i <= 1200; ++i) {
    const double phase = std::fmod(i / 300.0, 1.0);
    ramp.time.push_back(0.1 * i);
    ramp.displacement.push_back(k_amplitude * (1.0 - std::abs(1.0 - 2.0 * phase)));
    ramp.force.push_back(k_stiffness * ramp.displacement.back() + (phase < 0.5 ? 500.0 : -500.0) + 4000.0);
  }
  EXPECT_THAT(Prepared(ramp).text("offset"), HasSubstr("ramp starts at 0 mm with 4.5 kN"));
  EXPECT_THAT(Prepared(shifted(ramp, 0.0, -2500.0)).warnings, IsEmpty());  // 4 %
}

TEST(Preload, IsAMeanStretchAndItsForceThatNoPresetStates) {
  const auto about = [](double middle) {
    RigTest test = loops();
    for (std::size_t i = 0; i < test.force.size(); ++i) {
      test.displacement[i] += middle;
      test.force[i] += k_stiffness * middle;
    }
    return test;
  };
  EXPECT_THAT(codes(Prepared(about(0.3e-3)).warnings), ::testing::ElementsAre("preload"));
  EXPECT_THAT(Prepared(about(0.08e-3)).warnings, IsEmpty());
  RigTest stated = about(0.3e-3);
  stated.preset = 0.3e-3;
  EXPECT_THAT(Prepared(stated).warnings, IsEmpty());
}

TEST(Backlash, IsNotACubicSpringOrASmallGap) {
  const auto cubic = [](double x, double rate) { return 1e14 * x * x * x + 10.0 * rate; };
  EXPECT_EQ(Prepared(sine_test(k_amplitude, 1.0, 12, 400, cubic)).text("backlash"), "");
  const auto gap = [](double width) {  // elastic, so that contact and force have one sign
    return [width](double x, double rate) {
      const double in = std::abs(x) - 0.5 * width;
      return in > 0.0 ? std::copysign(k_stiffness * in, x) + 1e4 * rate * std::min(1.0, in / 2e-5) : 0.0;
    };
  };
  EXPECT_EQ(Prepared(sine_test(k_amplitude, 1.0, 12, 400, gap(0.02e-3))).text("backlash"), "");  // 1 % of the range
  const Prepared play(sine_test(k_amplitude, 1.0, 12, 400, gap(0.2e-3)));
  EXPECT_THAT(play.text("backlash"), HasSubstr("in both directions"));
}

TEST(Conditioning, IsNamedWithItsAmountAndTheCyclesDropped) {
  const auto mullins = [](double share) {
    RigTest test =
        sine_test(k_amplitude, 1.0, 12, 200, [](double x, double rate) { return k_stiffness * (x + 0.02 * rate); });
    for (std::size_t i = 0; i < test.force.size(); ++i) test.force[i] *= 1.0 + share * std::exp(-test.time[i] / 1.5);
    return test;
  };
  const Prepared prepared(mullins(0.3));
  EXPECT_THAT(prepared.text("conditioning_cycles"), HasSubstr("6 conditioning cycles are not used"));
  EXPECT_EQ(Prepared(mullins(0.02)).text("conditioning_cycles"), "");
}

TEST(Conditioning, OfManyTestsIsOneWarning) {
  std::vector<FitWarning> warnings(5, FitWarning{"conditioning_cycles", "a", "loop area +20 %"});
  warnings.push_back({"drift", "b", "mean force"});
  gather_common_findings(warnings);
  EXPECT_EQ(codes(warnings), (std::vector<std::string>{"drift", "conditioning_cycles"}));
  EXPECT_EQ(warnings[1].test, "");
  EXPECT_THAT(warnings[1].text, HasSubstr("5 tests"));
}

TEST(TrailingCycles, AreNamedAndNotUsed) {
  const auto fading = [](int at) { return [at](double cycle) { return cycle < at ? 1.0 : 0.6; }; };
  const Prepared two(stretched_loops(12, fading(10))), four(stretched_loops(12, fading(8)));
  EXPECT_THAT(two.text("trailing_cycles"), HasSubstr("cycles 11, 12 at the end run at 0.6 mm instead of 1 mm"));
  EXPECT_FALSE(two.test.cycles[11].used);
  EXPECT_TRUE(two.test.cycles[9].used);
  EXPECT_EQ(four.text("trailing_cycles"), "");  // a block of its own
  EXPECT_TRUE(four.test.cycles[11].used);
}

TEST(Jumps, MayLeaveNoCycleToUse) {
  RigTest test = loops(2);
  for (auto* channel : {&test.time, &test.displacement, &test.force}) channel->resize(280);
  for (std::size_t i = 30; i < test.time.size(); ++i) test.time[i] += 5.0;  // one whole cycle is left, after the jump
  test.corrections.push_back(CorrectionKind::segment_at_jumps);
  const Prepared prepared(test);
  EXPECT_THAT(codes(prepared.warnings), ::testing::ElementsAre("unusable_test"));
  EXPECT_EQ(prepared.test.unusable, "no cycle is left to use");
}

TEST(Clock, RisesStrictlyWhateverTheJumps) {
  RigTest test = loops(12);
  test.time[700] -= 50.0;  // a part of one sample
  for (std::size_t i = 1300; i < 1304; ++i) test.time[i] = test.time[1299];
  test.corrections.push_back(CorrectionKind::segment_at_jumps);
  const Prepared prepared(test);
  for (std::size_t i = 1; i < prepared.test.time.size(); ++i) {
    EXPECT_GT(prepared.test.time[i], prepared.test.time[i - 1]) << i;
  }
}

TEST(PhaseBreak, IsNotAnotherWaveFormNorNoise) {
  RigTest triangle = loops(), noisy = loops();
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 0.01 * k_amplitude);
  double before = 0.0;
  for (std::size_t i = 0; i < triangle.time.size(); ++i) {
    const double phase = std::fmod(triangle.time[i] + 0.25, 1.0);
    const double x = k_amplitude * (1.0 - 4.0 * std::abs(phase - 0.5));
    triangle.displacement[i] = x;
    triangle.force[i] = kelvin_voigt(x, i > 0 ? (x - before) * 200.0 : 0.0);
    before = x;
    noisy.displacement[i] += noise(random);
  }
  EXPECT_EQ(Prepared(triangle).text("phase_break"), "");
  EXPECT_EQ(Prepared(noisy).text("phase_break"), "");
}

TEST(PhaseBreak, IsNotAStepOfTheAmplitude) {
  const Prepared prepared(stretched_loops(16, [](double cycle) { return cycle < 8.1 ? 0.4 : 1.0; }));
  EXPECT_EQ(prepared.text("phase_break"), "");
  EXPECT_GT(prepared.test.cycles_used(), 6);
}

TEST(ThermalSoftening, IsASteadyFallThatConditioningIsNot) {
  const Prepared warming(scaled_loops(40, [](double cycle) { return 1.0 - 0.002 * cycle; }));
  EXPECT_THAT(warming.text("thermal_softening"), HasSubstr("no temperature is recorded"));
  const Prepared settling(scaled_loops(40, [](double cycle) { return 1.0 + 0.2 * std::exp(-cycle / 10.0); }));
  EXPECT_EQ(settling.text("thermal_softening"), "");
}

TEST(ThermalSoftening, NeedsForceAndTemperatureToGoTogether) {
  RigTest test = scaled_loops(20, [](double cycle) { return 1.0 - 0.006 * cycle; });
  for (const double t : test.time) test.temperature.push_back(295.0 + 2.0 * t);
  EXPECT_THAT(Prepared(test).text("thermal_softening"), HasSubstr("0.33 % a kelvin"));  // .6 % in 2 K, of .91
  RigTest constant = loops(20);
  constant.temperature = test.temperature;
  EXPECT_EQ(Prepared(constant).text("thermal_softening"), "");
}

TEST(ClippedSensor, IsNotTheCrestOfACoarseConverter) {
  RigTest coarse = loops(6, 20000);
  for (double& x : coarse.displacement) x = std::round(x / 1e-6) * 1e-6;  // 10 bits of its range, oversampled
  EXPECT_EQ(Prepared(coarse).text("clipped_sensor"), "");
  for (double& x : coarse.displacement) x = std::min(x, 0.9e-3);
  EXPECT_THAT(Prepared(coarse).text("clipped_sensor"), HasSubstr("displacement stands at 0.0009"));
}

TEST(MixedChannels, OfARotationReadInItsUnits) {
  RigTest test = loops();
  test.axis = Axis::rx;
  for (double& f : test.force) f = -f;
  EXPECT_THAT(Prepared(test).text("reversed_polarity"), HasSubstr("N m/rad"));
}

TEST(FewSamples, StartBelowFiftyACycle) {
  EXPECT_THAT(codes(Prepared(loops(12, 49)).warnings), Contains("few_samples"));
  EXPECT_THAT(codes(Prepared(loops(12, 51)).warnings), Not(Contains("few_samples")));
}

// Two million samples: what is known of the record must come out of the few that are kept.
TEST(LongRecord, OfTwoMillionSamplesIsPreparedInFull) {
  RigTest test = loops(100, 20000);
  std::mt19937 random(11);
  for (std::size_t i = 0; i < test.force.size(); ++i) {
    // uniform: a normal distribution would take longer than the preparation
    test.force[i] += 6e-4 * k_force_range * (static_cast<double>(random()) / 4294967296.0 - 0.5);
  }
  const Prepared prepared(test);
  EXPECT_THAT(prepared.warnings, IsEmpty());
  EXPECT_EQ(prepared.test.cycles.size(), 100u);
  EXPECT_LT(prepared.test.force.size(), 21u * 420u);  // ten used cycles and ten before them
  EXPECT_NEAR(prepared.test.frequency, 1.0, 1e-6);
  const double energy = k_pi * 2.0 * k_pi * 1e5 * k_amplitude * k_amplitude;
  // 17 N of noise, averaged over 50 samples, on 400 steps of 10 um: 5e-4 J, three of them
  EXPECT_NEAR(prepared.last().dissipated_energy, energy, 1.6e-3);
  EXPECT_NEAR(prepared.last().storage_stiffness, k_stiffness, 5e-4 * k_stiffness);
}

TEST(LongRecord, WithoutAClockAndWithAPhaseBreakIsUsedBesideIt) {
  RigTest test = loops(100, 20000);
  test.time_measured = false;
  for (auto* channel : {&test.displacement, &test.force}) {
    channel->erase(channel->begin() + 1607000, channel->begin() + 1613000);
  }
  test.time.resize(test.force.size());
  for (std::size_t i = 0; i < test.time.size(); ++i) test.time[i] = static_cast<double>(i);
  EXPECT_THAT(codes(Prepared(test).warnings), Contains("phase_break"));
  test.corrections.push_back(CorrectionKind::segment_at_jumps);
  const Prepared prepared(test);
  EXPECT_THAT(prepared.warnings, IsEmpty());
  EXPECT_EQ(prepared.test.cycles[80].note, "phase break");
  EXPECT_NEAR(prepared.test.frequency, 1.0, 4e-3);  // counted cycles by the stated frequency; one of them is short
  EXPECT_NEAR(prepared.last().storage_stiffness, k_stiffness, 5e-4 * k_stiffness);
}

}  // namespace
}  // namespace grouser
