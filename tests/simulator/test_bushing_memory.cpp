#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "model/bushing_law.h"
#include "simulator/bushings.h"
#include "tests/support/closed_forms.h"
#include "tests/support/pulled_pair.h"

namespace grouser::test {
namespace {

TEST(BushingMemory, FrictionStopLosesTheAreaOfItsLoop) {
  constexpr double k = 2e7, yield = 1e-4, amplitude = 4e-4;
  Bushing bushing = no_bushing();
  bushing.axis(Axis::x).stops = {{k, yield}};
  PulledPair pair(bushing);
  // A full loop of an elastic-plastic element: 4 k r (X - r), whatever the number of steps.
  for (const int steps : {40, 400}) {
    const auto cycle = [&] {
      for (int i = 1; i <= steps; ++i) {
        const double phase = 2.0 * k_pi * i / steps;
        pair.step(amplitude * std::sin(phase), 0.0, 1e-4);
      }
    };
    cycle();  // the first one starts in the middle of the elastic range
    pair.step_loss = 0.0;
    cycle();
    EXPECT_NEAR(pair.step_loss / (4.0 * k * yield * (amplitude - yield)), 1.0, 1e-11) << steps << " steps";
  }
}

TEST(BushingMemory, GrowingStopLosesTheAreaOfItsLoop) {
  constexpr double k = 2e7, yield = 1e-4, amplitude = 4e-4, growth = 1.0 / (amplitude * amplitude);
  Bushing bushing = no_bushing();
  bushing.axis(Axis::x).stops = {{k, yield}};
  bushing.axis(Axis::x).yield_growth = growth;
  const auto error = [&](int steps) {
    PulledPair pair(bushing);
    const auto cycle = [&] {
      for (int i = 1; i <= steps; ++i) pair.step(amplitude * std::sin(2.0 * k_pi * i / steps), 0.0, 1e-4);
    };
    cycle();
    pair.step_loss = 0.0;
    cycle();
    return std::abs(2.0 * pair.step_loss / growing_stop_area(k, yield, growth, amplitude) - 1.0);
  };
  // Of second order in the step: the parabola of the yield, and the step in which slip begins; dx / X = 2 pi / steps.
  EXPECT_LT(error(400), std::pow(2.0 * k_pi / 400, 2));
  EXPECT_LT(error(4000), std::pow(2.0 * k_pi / 4000, 2));
}

TEST(BushingMemory, SmallMotionInsideAStopLosesNothing) {
  Bushing bushing = no_bushing();
  bushing.axis(Axis::x).stops = {{2e7, 1e-4}};
  PulledPair pair(bushing);
  for (int i = 1; i <= 400; ++i) pair.step(0.99e-4 * std::sin(2.0 * k_pi * i / 100.0), 0.0, 1e-4);
  EXPECT_NEAR(pair.step_loss, 0.0, 1e-18 * 2e7);
}

TEST(BushingMemory, StopsInParallelFollowMasingsRule) {
  // Between turning points the loop is the first loading doubled: F = -F_max + 2 f((x + X) / 2).
  const std::vector<FrictionStop> stops{{1e7, 5e-5}, {5e6, 1e-4}, {3e6, 2e-4}};
  Bushing bushing = no_bushing();
  bushing.axis(Axis::x).stops = stops;
  PulledPair pair(bushing);
  const auto first_loading = [&](double x) {
    double f = 0.0;
    for (const FrictionStop& stop : stops) f += stop.stiffness * std::min(x, stop.yield);
    return f;
  };
  constexpr double amplitude = 3e-4;
  for (int i = 1; i <= 300; ++i) pair.step(-amplitude * i / 300.0, 0.0, 1e-4);
  const double least = pair.force();
  EXPECT_NEAR(least, -first_loading(amplitude), 1e-6);
  for (int i = 1; i <= 600; ++i) {
    const double x = -amplitude + 2.0 * amplitude * i / 600.0;
    pair.step(x, 0.0, 1e-4);
    ASSERT_NEAR(pair.force(), least + 2.0 * first_loading(0.5 * (x + amplitude)), 1e-6);  // of 1 kN: round-off
  }
}

TEST(BushingMemory, MaxwellBranchHasItsComplexStiffness) {
  // K* = i w c / (1 + i w c / k), loss per cycle pi c w X^2 / (1 + (w c / k)^2), c = k tau.
  constexpr double k = 1e7, tau = 2e-3, c = k * tau, amplitude = 2e-4;
  Bushing bushing = no_bushing();
  bushing.axis(Axis::x).branches = {{k, tau}};
  for (const double frequency : {1.0, 10.0, 71.6, 500.0}) {
    const double omega = 2.0 * k_pi * frequency, wt = omega * tau;
    const Harmonic at = shake(bushing, omega, amplitude, 2000);
    // Constant rate within each of 2000 steps a cycle: error (2 pi / 2000)^2 / 12 and less.
    EXPECT_NEAR(at.loss / (k_pi * c * omega * amplitude * amplitude / (1.0 + wt * wt)), 1.0, 3e-6) << frequency;
    // The polygon's own harmonics fold back into the samples: 1e-4 of |K*|.
    const double size = k * wt / std::sqrt(1.0 + wt * wt);
    EXPECT_NEAR(at.in_phase / size, wt / std::sqrt(1.0 + wt * wt), 1e-4) << frequency;
    EXPECT_NEAR(at.out_of_phase / size, 1.0 / std::sqrt(1.0 + wt * wt), 1e-4) << frequency;
  }
}

TEST(BushingMemory, MaxwellBranchRelaxesExponentially) {
  constexpr double k = 1e7, tau = 2e-3, x = 1e-4;
  Bushing bushing = no_bushing();
  bushing.axis(Axis::x).branches = {{k, tau}};
  PulledPair pair(bushing);
  pair.step(x, 0.0, 1e-12);  // a sudden stretch: the branch is a spring
  EXPECT_NEAR(pair.force(), k * x, 1e-6);
  for (int i = 0; i < 100; ++i) pair.step(x, 0.0, 5e-5);
  EXPECT_NEAR(pair.force(), k * x * std::exp(-100 * 5e-5 / tau),
              1e-7);  // exact for any step; the first one took 1e-12 s
  EXPECT_NEAR(pair.step_loss, 0.5 * k * x * x * (1.0 - std::exp(-200 * 5e-5 / tau)), 1e-7);
}

/// The whole law along x in up to 8e4 steps: work done on the joint against what it stores and loses.
void expect_balance(const Bushing& bushing) {
  const auto motion = [](double t) {
    return 3e-4 * std::sin(40.0 * t) + 2e-4 * std::sin(153.0 * t + 1.0) + 1e-4 * std::sin(611.0 * t);
  };
  const auto rate = [&](double t) { return (motion(t + 1e-6) - motion(t - 1e-6)) / 2e-6; };
  const auto defect = [&](int steps) {
    PulledPair pair(bushing);
    const double h = 0.5 / steps;
    pair.step(motion(0.0), rate(0.0), 0.0);
    const double start = pair.work.energy.bushing;
    double work_done = 0.0, lost = 0.0, power = pair.work.energy.bushing_power, x = motion(0.0);
    double pull = pair.force(0) - pair.force(1);  // joint 1 moves the other way
    pair.step_loss = 0.0;
    for (int i = 1; i <= steps; ++i) {
      const double t = i * h, next = motion(t);
      pair.step(next, rate(t), h);
      const double next_pull = pair.force(0) - pair.force(1), next_power = pair.work.energy.bushing_power;
      work_done += 0.5 * (pull + next_pull) * (next - x);
      lost += 0.5 * h * (power + next_power);
      pull = next_pull, power = next_power, x = next;
    }
    EXPECT_GT(pair.step_loss, 1.0);  // J: there is something to balance
    return std::abs(work_done - (pair.work.energy.bushing - start) - lost - 2.0 * pair.step_loss);
  };
  const double coarse = defect(20000), fine = defect(80000);
  EXPECT_LT(fine, 1e-4);          // J, the trapezoid of the work, of 20 J
  EXPECT_LT(fine, 0.2 * coarse);  // of second order, the corners of the stops apart
}

TEST(BushingMemory, WorkOfARandomMotionIsStoredOrLost) { expect_balance(rubber_bushing()); }

TEST(BushingMemory, WorkOfARandomMotionIsStoredOrLostWhenYieldsGrow) {
  Bushing bushing = rubber_bushing();
  bushing.axis(Axis::x).yield_growth = 1e7;  // yields 4.6 times as large at 0.6 mm
  expect_balance(bushing);
}

TEST(BushingMemory, ClosedPathsNeverGiveEnergy) {
  Bushing bushing = no_bushing();
  bushing.axis(Axis::x).stops = {{4e6, 5e-5}, {2e6, 2e-4}};
  bushing.axis(Axis::x).yield_growth = 2e7;
  std::mt19937 random(9);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  constexpr int k_steps = 2000;
  for (int path = 0; path < 100; ++path) {
    double size[5], phase[5];
    for (int n = 0; n < 5; ++n) size[n] = 4e-4 * unit(random) / (n + 1), phase[n] = k_pi * unit(random);
    const auto position = [&](int i) {
      double x = 0.0;
      for (int n = 0; n < 5; ++n) x += size[n] * std::sin(2.0 * k_pi * (n + 1) * i / k_steps + phase[n]);
      return x;
    };
    PulledPair pair(bushing);
    double work = 0.0, last = 0.0;
    for (int i = 0; i <= 2 * k_steps; ++i) {
      if (i == k_steps + 1) pair.step_loss = 0.0, work = 0.0;  // settled: every lap from here on is the same
      pair.step(position(i), 0.0, 1e-4);
      work += 0.5 * (pair.force() + last) * (position(i) - position(i - 1));
      last = pair.force();
    }
    ASSERT_GE(work, 0.0) << "path " << path;
    // Ten turns a lap at most, each with a step in which slip begins: dx^2 / 2 of the stops' stiffness, dx < 6e-6 m.
    ASSERT_NEAR(work, 2.0 * pair.step_loss, 10.0 * 0.5 * 6e6 * 6e-6 * 6e-6) << "path " << path;
  }
}

}  // namespace
}  // namespace grouser::test
