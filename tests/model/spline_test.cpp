#include "model/spline.h"

#include <gtest/gtest.h>

#include <cmath>

namespace grouser {
namespace {

/// f = 1e8 x + 1e13 x^3 with exact slopes: a cubic spring must be reproduced, not approximated.
SpringSpline cubic_spring() {
  SpringSpline spring;
  for (const double x : {-1e-3, -4e-4, 1e-4, 5e-4, 1.2e-3}) {
    spring.displacement.push_back(x);
    spring.force.push_back(1e8 * x + 1e13 * x * x * x);
    spring.slope.push_back(1e8 + 3e13 * x * x);
  }
  return spring;
}

TEST(Spring, ReproducesACubicAndItsSlope) {
  const SpringSpline spring = cubic_spring();
  for (double x = -1e-3; x <= 1.2e-3; x += 1.7e-5) {
    const auto value = evaluate(spring, x);
    EXPECT_NEAR(value.force, 1e8 * x + 1e13 * x * x * x, 1e-9 * 1e5);  // round-off of 1e5 N
    EXPECT_NEAR(value.slope, 1e8 + 3e13 * x * x, 1e-8 * 1e8);
  }
}

TEST(Spring, GoesOnAsAStraightLine) {
  const SpringSpline spring = cubic_spring();
  const double end_slope = spring.slope.back();
  EXPECT_DOUBLE_EQ(evaluate(spring, 2.2e-3).force, spring.force.back() + 1e-3 * end_slope);
  EXPECT_DOUBLE_EQ(evaluate(spring, 2.2e-3).slope, end_slope);
  EXPECT_DOUBLE_EQ(evaluate(spring, -2e-3).force, spring.force.front() - 1e-3 * spring.slope.front());
}

TEST(Spring, StoresTheIntegralOfItsForce) {
  const SpringSpline spring = cubic_spring();
  const auto exact = [](double x) { return 0.5e8 * x * x + 0.25e13 * x * x * x * x; };
  for (const double x : {-9e-4, -1e-4, 0.0, 3e-4, 1.1e-3}) EXPECT_NEAR(stored_energy(spring, x), exact(x), 1e-12 * 1e2);
  const double beyond = 1e-3;  // past the last knot: a rectangle and a triangle
  const double expected = exact(1.2e-3) + spring.force.back() * beyond + 0.5 * spring.slope.back() * beyond * beyond;
  EXPECT_NEAR(stored_energy(spring, 2.2e-3), expected, 1e-12 * expected);
}

TEST(Spring, ForceIsTheDerivativeOfItsEnergy) {
  const SpringSpline spring = cubic_spring();
  const double h = 1e-8;
  for (const double x : {-2e-3, -7e-4, 2e-4, 1.15e-3, 1.9e-3}) {
    const double slope = (stored_energy(spring, x + h) - stored_energy(spring, x - h)) / (2.0 * h);
    EXPECT_NEAR(slope, evaluate(spring, x).force, 1e-5 * 1e5);  // round-off of the difference quotient
  }
}

TEST(MonotoneSlopes, KeepNoisyRisingDataRising) {
  const std::vector<double> x{0.0, 1.0, 1.1, 2.0, 5.0, 5.2, 8.0}, y{0.0, 0.1, 2.0, 2.0, 2.1, 7.0, 7.01};
  SpringSpline spring{x, y, fritsch_carlson_slopes(x, y)};
  double last = evaluate(spring, 0.0).force;
  for (double at = 0.0; at <= 8.0; at += 0.001) {
    const double force = evaluate(spring, at).force;
    EXPECT_GE(force, last - 1e-12);
    last = force;
  }
  EXPECT_EQ(spring.slope[2], 0.0);  // next to a level stretch
}

TEST(MonotoneSlopes, OfAStraightLineAreItsSlope) {
  for (const double slope : fritsch_carlson_slopes({-1.0, 0.0, 3.0, 4.0}, {-2.0, 0.0, 6.0, 8.0})) EXPECT_EQ(slope, 2.0);
}

TEST(LargestSlope, FindsTheSteepestPlaceBetweenKnots) {
  // Smoothstep: slopes 0 at both ends, 1.5 in the middle.
  const SpringSpline spring{{0.0, 1.0}, {0.0, 1.0}, {0.0, 0.0}};
  EXPECT_DOUBLE_EQ(largest_slope(spring, 0.0, 1.0), 1.5);
  EXPECT_DOUBLE_EQ(largest_slope(spring, 0.0, 0.25), evaluate(spring, 0.25).slope);
}

TEST(LinearSpring, IsLinearOutsideItsRangeToo) {
  const SpringSpline spring = SpringSpline::linear(1e8, 1e-3);
  EXPECT_DOUBLE_EQ(evaluate(spring, 7e-4).force, 7e4);
  EXPECT_DOUBLE_EQ(evaluate(spring, -3e-3).force, -3e5);
  EXPECT_NEAR(stored_energy(spring, -3e-3), 0.5 * 1e8 * 9e-6, 1e-9);
}

}  // namespace
}  // namespace grouser
