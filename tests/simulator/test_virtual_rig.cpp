#include "simulator/virtual_rig.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "identification/evaluate_fit.h"
#include "model/errors.h"
#include "model/geometry.h"
#include "tests/support/scenes.h"

namespace grouser::test {
namespace {

struct Path {
  std::vector<double> time, displacement;
};

/// A preset, then two sines over it, sampled unevenly.
Path path(double amplitude) {
  Path made;
  for (int i = 0; i < 1500; ++i) {
    const double t = 1e-3 * (i + 0.3 * std::sin(i));
    made.time.push_back(t);
    made.displacement.push_back(amplitude * (0.2 + 0.5 * std::sin(9.0 * t) + 0.3 * std::sin(61.0 * t)));
  }
  return made;
}

double range(const std::vector<double>& values) {
  const auto [low, high] = std::ranges::minmax(values);
  return high - low;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = a.size() == b.size() ? 0.0 : 1e300;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

/// Everything the law has, on every axis.
Bushing growing_rubber() {
  Bushing bushing = rubber_bushing();
  for (std::size_t a = 0; a < k_num_axes; ++a) {
    const double yield = bushing.axes[a].stops.back().yield;
    bushing.axes[a].yield_growth = 0.1 / (yield * yield);
  }
  return bushing;
}

constexpr double k_degree = k_pi / 180.0;

struct Case {
  Axis axis;
  double amplitude, tolerance;  ///< of the force range
};
// Round-off along the law's own coordinates; about rx and rz angle^2 / 6 of the moment, which is up to 0.8 of its
// range.
const Case k_cases[] = {{Axis::x, 1e-3, 1e-12},
                        {Axis::y, 1e-3, 1e-12},
                        {Axis::z, 1e-3, 1e-12},
                        {Axis::rx, 0.3 * k_degree, 5e-6},
                        {Axis::ry, 60.0 * k_degree, 1e-12},
                        {Axis::rz, 0.3 * k_degree, 5e-6}};

TEST(VirtualRig, ReadsWhatTheIdentifiedLawSays) {
  const Bushing bushing = growing_rubber();
  for (const auto& [axis, amplitude, tolerance] : k_cases) {
    const Path driven = path(amplitude);
    const RigWrench wrench = run_virtual_rig(bushing, axis, driven.time, driven.displacement);
    const std::vector<double> law = replay(bushing.axis(axis), driven.time, driven.displacement);
    const std::vector<double>& cell = wrench[static_cast<std::size_t>(index_of(axis))];
    EXPECT_LT(largest_difference(cell, law), tolerance * range(law)) << name_of(axis);
  }
}

TEST(VirtualRig, MovesOneAxisWithoutLoadOnTheOthers) {
  const Bushing bushing = growing_rubber();
  for (const auto& [axis, amplitude, tolerance] : k_cases) {
    const Path driven = path(amplitude);
    const RigWrench wrench = run_virtual_rig(bushing, axis, driven.time, driven.displacement);
    for (int other = 0; other < k_num_axes; ++other) {
      if (other == index_of(axis)) continue;
      for (const double load : wrench[static_cast<std::size_t>(other)]) {
        ASSERT_EQ(load, 0.0) << name_of(axis) << " loads " << k_axis_names[static_cast<std::size_t>(other)];
      }
    }
  }
}

TEST(VirtualRig, HingeOf60DegreesIsALinearSpringWhereTheLawIsOne) {
  std::vector<double> time, angle;
  for (int i = -60; i <= 60; ++i) {
    time.push_back(0.01 * (i + 60));
    angle.push_back(i * k_degree);
  }
  const RigWrench wrench = run_virtual_rig(elastic_bushing(), Axis::ry, time, angle);
  // The springs' round-off at 60 degrees: 1500 N m/rad times two units in the last place of an angle.
  for (std::size_t i = 0; i < angle.size(); ++i) ASSERT_NEAR(wrench[4][i], 1500.0 * angle[i], 1e-12);
}

TEST(VirtualRig, StartsRelaxedWhereTheTestStarts) {
  Bushing bushing = no_bushing();
  bushing.axis(Axis::ry).stops = {{100.0, 0.1}};
  bushing.axis(Axis::ry).branches = {{100.0, 1.0}};
  const double preset = 14.0 * k_degree;
  const RigWrench wrench = run_virtual_rig(bushing, Axis::ry, {0.0, 0.1}, {preset, preset});
  EXPECT_EQ(wrench[4][0], 0.0);
  EXPECT_EQ(wrench[4][1], 0.0);
}

TEST(VirtualRig, NeedsALawOnTheTestedAxisOnly) {
  Bushing bushing;
  bushing.axis(Axis::y).spring = SpringSpline::linear(2e7, 1.0);
  const RigWrench wrench = run_virtual_rig(bushing, Axis::y, {0.0, 1.0}, {0.0, 1e-3});
  EXPECT_NEAR(wrench[1][1], 2e4, 1e-8);  // round-off of a line through points 1 m away
}

// ------------------------------------------------------------------------------------------------------- by a protocol

/// One stop beside a linear spring along x: every figure of a settled ramp has a closed form.
constexpr double k_spring = 9e7, k_stop = 1e7, k_yield = 2e-4;  // N/m, N/m, m
Bushing spring_and_stop() {
  Bushing bushing;
  bushing.axis(Axis::x).spring = SpringSpline::linear(k_spring, 1e-3);
  bushing.axis(Axis::x).stops = {{k_stop, k_yield}};
  return bushing;
}

/// The paper's ramps: 2 mm/min to 10 ton.
RigTest ramps_to_ten_ton() {
  RigTest test;
  test.name = "ramp";
  test.kind = TestKind::static_ramp;
  test.rate = 2e-3 / 60.0;
  test.protocol = TestProtocol{.to_force = 98066.5, .turns = 3, .samples_per_turn = 100, .sample_rate = {}};
  return test;
}

/// Ramps out and back, as index ranges of equal numbers of steps.
std::vector<std::size_t> turns_of(const RigTest& test) {
  const std::size_t legs = 2u * static_cast<std::size_t>(test.protocol->turns), steps = (test.force.size() - 1) / legs;
  std::vector<std::size_t> turns;
  for (std::size_t leg = 1; leg < legs; leg += 2) turns.push_back(leg * steps);
  return turns;
}

/// Work of the machine on the specimen, by trapezoids.
double work(const RigTest& test, std::size_t begin, std::size_t end) {
  double sum = 0.0;
  for (std::size_t i = begin + 1; i <= end; ++i)
    sum += 0.5 * (test.force[i] + test.force[i - 1]) * (test.displacement[i] - test.displacement[i - 1]);
  return sum;
}

TEST(Protocol, TurnsARampWhereTheForceIsMet) {
  // All that a law may hold: yields that grow with strain and branches that remember the ramp before.
  const RigTest made = run_protocol(growing_rubber(), ramps_to_ten_ton());
  ASSERT_EQ(made.force.size(), 301u);
  for (const std::size_t turn : turns_of(made)) {
    EXPECT_NEAR(made.force[turn], 98066.5, 1e-6 * 98066.5);  // what the search promises
    EXPECT_EQ(made.displacement[turn + 50], 0.0);
    EXPECT_EQ(std::ranges::max(std::span(made.force).subspan(turn - 50, 101)), made.force[turn]);
  }
}

TEST(Protocol, RecordsWhatTheSameMotionGivesWithoutASearch) {
  const RigTest made = run_protocol(growing_rubber(), ramps_to_ten_ton());
  const RigWrench again = run_virtual_rig(growing_rubber(), Axis::x, made.time, made.displacement);
  // Round-off of the rates, which the replay takes from differences; a trial step that was left in the memory would
  // show as much as the stops hold.
  EXPECT_LT(largest_difference(made.force, again[0]), 1e-10 * range(made.force));
}

TEST(Protocol, KeepsTheRateBetweenAllSamples) {
  for (const bool by_rate : {false, true}) {
    RigTest test = ramps_to_ten_ton();
    if (by_rate) test.protocol->sample_rate = 0.7;
    const RigTest made = run_protocol(growing_rubber(), test);
    double longest = 0.0;
    for (std::size_t i = 1; i < made.time.size(); ++i) {
      const double h = made.time[i] - made.time[i - 1];
      // Round-off of the time, up to 200 s, over a step of half a second or more.
      ASSERT_NEAR(std::abs(made.displacement[i] - made.displacement[i - 1]) / h, *test.rate, 1e-12 * *test.rate);
      longest = std::max(longest, h);
    }
    if (!by_rate) continue;
    EXPECT_LE(longest, 1.0 / 0.7 + 1e-12);
    EXPECT_GT(longest, 0.9 / 0.7);  // a way of 40 steps is cut no finer than into 41
  }
}

TEST(Protocol, RefusesMoreSamplesThanAnyoneReads) {
  RigTest test = ramps_to_ten_ton();
  test.protocol->sample_rate = 1e12;
  EXPECT_THROW(static_cast<void>(run_protocol(growing_rubber(), test)), NumericalError);
}

TEST(Protocol, EnergiesOfASpringAndAStopHaveAClosedForm) {
  RigTest test = ramps_to_ten_ton();
  test.protocol->samples_per_turn = 4000;
  const RigTest made = run_protocol(spring_and_stop(), test);
  // Beyond the yield F = k X + k_s r, and on the way back the stop slips at -k_s r once it has gone 2 r.
  const double reach = (98066.5 - k_stop * k_yield) / k_spring;
  const std::vector<std::size_t> turns = turns_of(made);
  EXPECT_NEAR(made.displacement[turns[0]], reach, 2e-6 * reach);
  // Virgin loading to X: k X^2 / 2 + k_s r (X - r / 2). A settled loop: 2 k_s r (X - 2 r),
  // for the deflection swings between -r and r. Trapezoids miss k_s dx^2 / 2 at most at each corner: 1e-5.
  const double loading = 0.5 * k_spring * reach * reach + k_stop * k_yield * (reach - 0.5 * k_yield);
  EXPECT_NEAR(work(made, 0, turns[0]), loading, 1e-5 * loading);
  const double loop = 2.0 * k_stop * k_yield * (reach - 2.0 * k_yield);
  EXPECT_NEAR(work(made, turns[0], turns[1]), loop, 1e-5 * loop);
  EXPECT_NEAR(work(made, turns[1], turns[2]), loop, 1e-5 * loop);
}

TEST(Protocol, LoopsAreSinesAboutThePreset) {
  RigTest test;
  test.axis = Axis::ry;
  test.preset = 14.0 * k_degree;
  test.amplitude = 10.0 * k_degree;
  test.frequency = 2.0;
  test.protocol = TestProtocol{.turns = 3, .samples_per_turn = 40, .sample_rate = {}};
  const RigTest made = run_protocol(elastic_bushing(), test);
  ASSERT_EQ(made.force.size(), 121u);
  EXPECT_NEAR(made.time.back(), 1.5, 1e-15);
  EXPECT_NEAR(made.displacement[10], 24.0 * k_degree, 1e-15);
  EXPECT_NEAR(made.displacement[30], 4.0 * k_degree, 1e-15);
  for (std::size_t i = 0; i < made.force.size(); ++i) ASSERT_NEAR(made.force[i], 1500.0 * made.displacement[i], 1e-12);
}

TEST(Protocol, PullsTheOtherWayFromAPreset) {
  RigTest test = ramps_to_ten_ton();
  test.preset = 5e-4;
  test.protocol->to_force = -1e4;
  const RigTest made = run_protocol(spring_and_stop(), test);
  const std::size_t turn = turns_of(made)[0];
  // The stop is relaxed at the preset and slips long before: F = k x - k_s r.
  EXPECT_NEAR(made.displacement[turn], (-1e4 + k_stop * k_yield) / k_spring, 1e-6 * 5.5e4 / k_spring);
  EXPECT_EQ(made.displacement.back(), 5e-4);
}

TEST(Protocol, SaysWhereTheForceIsNeverMet) {
  Bushing bushing = spring_and_stop();
  bushing.axis(Axis::x).spring = SpringSpline::linear(0.0, 1e-3);
  try {
    static_cast<void>(run_protocol(bushing, ramps_to_ten_ton()));
    FAIL() << "a stop of 2 kN gave 98 kN";
  } catch (const NumericalError& error) {
    EXPECT_NE(std::string(error.what()).find("test ramp: the ramp does not meet 98066.5 N"), std::string::npos)
        << error.what();
    EXPECT_NE(std::string(error.what()).find("2000 N"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace grouser::test
