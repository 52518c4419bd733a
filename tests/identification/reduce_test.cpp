// A reduced record must tell the same as the full one.
#include "identification/reduce.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "model/bushing_law.h"
#include "tests/identification/bench.h"

namespace grouser {
namespace {

constexpr double k_amplitude = 1e-3;

// Spring, two stops and a cubic, along a given motion: corners, steep starts after reversals, harmonics.
Signals rubber(std::vector<double> displacement, double step) {
  Signals signals;
  signals.displacement = std::move(displacement);
  double small = 0.0, large = 0.0, before = 0.0;
  for (std::size_t i = 0; i < signals.displacement.size(); ++i) {
    const double x = signals.displacement[i];
    small = advance_stop(small, x - before, 0.05e-3);
    large = advance_stop(large, x - before, 0.4e-3);
    before = x;
    signals.time.push_back(step * static_cast<double>(i));
    signals.force.push_back(1e7 * x + 2e12 * x * x * x + 4e6 * small + 3e6 * large);
  }
  return signals;
}

double triangle(double phase) {
  return phase < 0.25 ? 4.0 * phase : phase < 0.75 ? 2.0 - 4.0 * phase : 4.0 * phase - 4.0;
}

Signals motion(bool ramp, int cycles, double samples_per_cycle) {
  std::vector<double> x;
  for (int i = 0; i <= static_cast<int>(cycles * samples_per_cycle); ++i) {
    const double turns = i / samples_per_cycle, phase = turns - std::floor(turns);
    x.push_back(k_amplitude * (ramp ? triangle(phase) : std::sin(2.0 * std::numbers::pi * turns)));
  }
  return rubber(std::move(x), 1e-4);
}

LoopMeasures last_loop(const Signals& signals, double frequency = 0.0) {
  const CycleSpan span = find_cycles(signals.displacement).back();
  LoopMeasures loop = loop_measures(signals.displacement, signals.force, signals.force, span, 0.0);
  if (frequency > 0.0) {
    const auto k = dynamic_stiffness(signals.time, signals.displacement, signals.force, span, frequency);
    loop.storage_stiffness = k.real();
    loop.loss_stiffness = k.imag();
  }
  return loop;
}

void expect_same(const LoopMeasures& reduced, const LoopMeasures& full, double tolerance) {
  EXPECT_NEAR(reduced.dissipated_energy, full.dissipated_energy, tolerance * full.dissipated_energy);
  EXPECT_NEAR(reduced.effective_stiffness, full.effective_stiffness, tolerance * full.effective_stiffness);
  EXPECT_NEAR(reduced.secant_stiffness, full.secant_stiffness, tolerance * full.secant_stiffness);
  EXPECT_NEAR(reduced.storage_stiffness, full.storage_stiffness, tolerance * full.storage_stiffness);
  // corners of the stops shift within a bin; the loss is a tenth of the stiffness
  EXPECT_NEAR(reduced.loss_stiffness, full.loss_stiffness, tolerance * full.storage_stiffness);
}

TEST(Reduce, KeepsTheLoopsOfASine) {
  const Signals full = motion(false, 4, 12345.6);
  const Signals reduced = reduce(full, {0}).signals;
  EXPECT_LT(reduced.time.size(), 4u * 420u);
  EXPECT_GT(reduced.time.size(), 4u * 380u);
  expect_same(last_loop(reduced, 1e4 / 12345.6), last_loop(full, 1e4 / 12345.6), 5e-4);  // what the fit is promised
}

TEST(Reduce, KeepsTheTipsOfARamp) {
  const Signals full = motion(true, 4, 9871.0);
  const Signals reduced = reduce(full, {0}).signals;
  expect_same(last_loop(reduced), last_loop(full), 5e-4);
  // the tip itself lies between two samples: half a step of 4 / 9871
  EXPECT_NEAR(*std::ranges::max_element(reduced.displacement), k_amplitude, 2.1e-4 * k_amplitude);
}

TEST(Reduce, LeavesAShortRecordAlone) {
  const Signals full = motion(false, 4, 500.0);
  EXPECT_EQ(reduce(full, {0}).signals.displacement, full.displacement);
}

TEST(Reduce, AveragesNoiseAsAMeanDoes) {
  Signals noisy = motion(false, 6, 40000.0);
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 1.0);
  for (double& x : noisy.displacement) x += 1e-6 * noise(random);
  for (double& f : noisy.force) f += 30.0 * noise(random);
  const Signals reduced = reduce(noisy, {0}).signals;
  EXPECT_NEAR(noise_level(reduced.force), 3.0, 0.3);  // 100 samples a bin; the estimate has 2400 values
  expect_same(last_loop(reduced, 0.25), last_loop(motion(false, 6, 40000.0), 0.25), 2e-3);  // 3 N / sqrt(200) of 12 kN
}

TEST(Reduce, DoesNotAverageAcrossAJumpOfTime) {
  Signals full = motion(false, 8, 4000.0);
  for (std::size_t i = 14000; i < full.time.size(); ++i) full.time[i] -= 1.0;
  const std::vector<std::size_t> parts = parts_of(full.time);
  ASSERT_EQ(parts, (std::vector<std::size_t>{0, 14000}));
  const ReducedRecord reduced = reduce(full, parts);
  ASSERT_EQ(reduced.parts.size(), 2u);
  EXPECT_EQ(reduced.signals.time[reduced.parts[1]], full.time[14000]);
  EXPECT_NEAR(reduced.signals.time[reduced.parts[1] - 1], full.time[13999], 1e-9);
}

TEST(Parts, OfARecordWithAFewDoubledStampsAreOne) {
  std::vector<double> time;
  for (int i = 0; i < 1000; ++i) time.push_back(i % 97 == 0 && i > 0 ? time.back() : 1e-3 * i);
  EXPECT_EQ(parts_of(time).size(), 1u);
}

}  // namespace
}  // namespace grouser
