#include "model/bushing_law.h"

#include <gtest/gtest.h>

#include <random>

namespace grouser {
namespace {

TEST(FrictionStop, LoopAreaIsTheClosedForm) {
  // A stop driven over +-X loses 4 k r (X - r) a cycle.
  const double stiffness = 2e7, yield = 1e-4, amplitude = 5e-4, steps = 20000;
  double z = 0.0, x = 0.0, work = 0.0;
  for (int cycle = 0; cycle < 2; ++cycle) {
    work = 0.0;
    for (int i = 1; i <= steps; ++i) {
      const double next = amplitude * std::sin(2.0 * 3.14159265358979323846 * i / steps);
      const double z_next = advance_stop(z, next - x, yield);
      work += 0.5 * stiffness * (z + z_next) * (next - x);
      z = z_next;
      x = next;
    }
  }
  const double exact = 4.0 * stiffness * yield * (amplitude - yield);
  EXPECT_NEAR(work, exact, 1e-3 * exact);  // trapezoid over the corners of the loop
}

TEST(FrictionStop, UpdateDoesNotDependOnHowAMonotoneStepIsDivided) {
  double coarse = advance_stop(-8e-5, 1.3e-4, 1e-4), fine = -8e-5;
  for (int i = 0; i < 130; ++i) fine = advance_stop(fine, 1e-6, 1e-4);
  EXPECT_NEAR(coarse, fine, 1e-17);
}

TEST(MaxwellBranch, StepIsExactForAConstantRate) {
  const MaxwellBranch branch{1e7, 0.02};
  const double rate = 0.3, time = 0.05;
  double force = 0.0;
  for (const double h : {1e-2, 3e-2, 1e-2}) {
    const MaxwellStep step = maxwell_step(branch, h);
    force = step.decay * force + step.gain * rate * h;
  }
  const double exact =
      branch.stiffness * branch.relaxation_time * rate * (1.0 - std::exp(-time / branch.relaxation_time));
  EXPECT_NEAR(force, exact, 1e-13 * exact);
}

TEST(MaxwellBranch, RelaxesByTheSameOnBothSidesOfTheSeries) {
  for (double x = 1e-9; x < 30.0; x *= 1.3) {
    const long double y = x, lost = -std::expm1(-y), share = lost / y;
    // The rest cancels in any closed form: its own series, 20 terms, where x is small.
    long double rest = 0.0L, term = 0.5L;
    for (int k = 0; k < 20; ++k, term *= -y / (k + 2)) rest += term;
    if (x > 1.0) rest = (1.0L - share) / y;
    const Relaxation<double> found = relaxation(x);
    EXPECT_NEAR(found.lost / static_cast<double>(lost), 1.0, 1e-15) << x;
    EXPECT_NEAR(found.share / static_cast<double>(share), 1.0, 1e-15) << x;
    EXPECT_NEAR(found.rest / static_cast<double>(rest), 1.0, 3e-15) << x;
  }
  EXPECT_EQ(relaxation(0.0).rest, 0.5);
}

TEST(MaxwellBranch, DissipatesAtEveryRandomStep) {
  std::mt19937 random(20261122);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int i = 0; i < 1000; ++i) {
    const MaxwellBranch branch{1e7, std::pow(10.0, 2.0 * uniform(random) - 2.0)};
    const double force = 1e4 * uniform(random), dx = 1e-3 * uniform(random), h = 1e-4 * (1.0 + 0.9 * uniform(random));
    const MaxwellStep step = maxwell_step(branch, h);
    const double next = step.decay * force + step.gain * dx;
    const double work = dx * (step.work_per_way * dx + step.gain_share * force);
    const double growth = step.compliance * (next * next - force * force);
    EXPECT_GE(work - growth, -1e-12 * 1e4 * 1e-3);  // round-off of the work
  }
}

/// Force of a law along a path from rest, one step a point, spaced by h.
std::vector<double> forces_along(const AxisLaw& law, const std::vector<double>& path, double h) {
  std::vector<double> stops(law.stops.size()), branches(law.branches.size()), forces;
  double before = 0.0;
  for (const double x : path) {
    const double dx = x - before;
    double force = evaluate(law.spring, x).force + law.viscous * dx / h;
    for (std::size_t s = 0; s < stops.size(); ++s) {
      stops[s] = advance_stop(stops[s], dx, law.stops[s].yield * yield_scale(law.yield_growth, x));
      force += law.stops[s].stiffness * stops[s];
    }
    for (std::size_t m = 0; m < branches.size(); ++m) {
      const MaxwellStep step = maxwell_step(law.branches[m], h);
      branches[m] = step.decay * branches[m] + step.gain * dx;
      force += branches[m];
    }
    forces.push_back(force);
    before = x;
  }
  return forces;
}

TEST(ScaledBushing, TakesScaledForcesOnAnyPath) {
  Bushing bushing;
  bushing.axis(Axis::z) = {{{-1e-3, 0.0, 2e-3}, {-9e4, 0.0, 3e5}, {8e7, 1e8, 2e8}},
                           {{1e7, 5e-5}, {4e6, 3e-4}},
                           2e4,
                           {{1e7, 0.02}, {3e6, 1.0}},
                           120.0,
                           {}};
  std::mt19937 random(20261122);
  std::uniform_real_distribution<double> uniform(-1.5e-3, 2.5e-3);
  std::vector<double> path(1000);
  for (double& x : path) x = uniform(random);
  const AxisScale scale{1.0, 1.0, 0.3, 1.0, 1.0, 1.0};
  const std::vector<double> of = forces_along(bushing.axis(Axis::z), path, 1e-3);
  const std::vector<double> of_scaled = forces_along(scaled(bushing, scale).axis(Axis::z), path, 1e-3);
  for (std::size_t i = 0; i < path.size(); ++i) {
    EXPECT_NEAR(of_scaled[i], 0.3 * of[i], 1e-14 * 3e5) << i;  // round-off of sums of forces up to 3e5 N
  }
}

}  // namespace
}  // namespace grouser
