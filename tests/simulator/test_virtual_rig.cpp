#include "simulator/virtual_rig.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "identification/evaluate_fit.h"
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

}  // namespace
}  // namespace grouser::test
