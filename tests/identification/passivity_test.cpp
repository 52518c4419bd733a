// Whatever the data were, a fitted law takes work, never falls and goes on straight outside its range.
#include <gtest/gtest.h>

#include <algorithm>

#include "identification/axis_fit.h"
#include "tests/identification/law_campaign.h"

namespace grouser {
namespace {

AxisLaw random_law(PortableRandom& random) {
  AxisLaw law;
  law.spring.displacement = {-1e-3, 0.0, 1e-3};
  law.spring.force = {-1e5 * random.uniform(), 0.0, 1e5 * random.uniform()};
  law.spring.slope = fritsch_carlson_slopes(law.spring.displacement, law.spring.force);
  for (int j = 0; j < 3; ++j) law.stops.push_back({3e7 * random.uniform(), 0.4e-3 * random.uniform()});
  for (int k = 0; k < 3; ++k) law.branches.push_back({3e7 * random.uniform(), std::pow(10.0, -3.0 * random.uniform())});
  law.yield_growth = random.uniform() < 0.5 ? 0.0 : 3e6 * random.uniform();
  return law;
}

// Fitted to half a dozen loops of which one lies about its displacement: the fit may be poor, the law must not be.
AxisLaw fitted_law(PortableRandom& random, int trial) {
  const AxisLaw truth = random_law(random);
  std::vector<RigTest> tests;
  std::uint64_t seed = 100 * static_cast<std::uint64_t>(trial);
  for (const double amplitude : {0.2e-3, 0.8e-3}) {
    for (const double frequency : {0.5, 5.0, 50.0})
      tests.push_back(loop_of(truth, Axis::x, amplitude, frequency, ++seed));
  }
  for (double& x : tests[static_cast<std::size_t>(trial) % tests.size()].displacement) x *= 1.3;
  const LawCampaign campaign(std::move(tests));
  const AxisSolution solution = fit_axis(campaign.data);
  return make_law(solution.dictionary, solution.coefficients);
}

// Work over a path from rest to rest that reaches twice as far as the data.
double work_on_closed_path(const AxisLaw& law, PortableRandom& random) {
  std::vector<double> time{0.0}, x{0.0};
  for (int leg = 0; leg < 12; ++leg) {
    const double from = x.back(), to = leg == 11 ? 0.0 : 2e-3 * (2.0 * random.uniform() - 1.0);
    const double step = std::pow(10.0, -4.0 + 3.0 * random.uniform());
    for (int i = 1; i <= 200; ++i) {
      x.push_back(from + (to - from) * i / 200.0);
      time.push_back(time.back() + step);
    }
  }
  const std::vector<double> force = replay(law, time, x);
  double work = 0.0;
  for (std::size_t i = 1; i < x.size(); ++i) work += 0.5 * (force[i] + force[i - 1]) * (x[i] - x[i - 1]);
  return work;
}

TEST(FittedLaw, IsPassiveMonotoneAndStraightOutside) {
  PortableRandom random(3);
  for (int trial = 0; trial < 6; ++trial) {
    const AxisLaw law = fitted_law(random, trial);
    for (int path = 0; path < 40; ++path) EXPECT_GT(work_on_closed_path(law, random), 0.0) << trial;
    EXPECT_GE(law.yield_growth, 0.0);
    for (const FrictionStop& stop : law.stops) EXPECT_GT(stop.stiffness, 0.0);
    for (const MaxwellBranch& branch : law.branches) EXPECT_GT(branch.stiffness, 0.0);
    const double steepest = largest_slope(law.spring, -2e-3, 2e-3);  // of which round-off is a part in 1e15
    for (double x = -2e-3; x < 2e-3; x += 1e-6) {
      ASSERT_GE(evaluate(law.spring, x).slope, -1e-14 * steepest) << trial << " at " << x;
    }
    const double end = law.spring.displacement.back(), slope = law.spring.slope.back();
    EXPECT_NEAR(evaluate(law.spring, 3.0 * end).force, law.spring.force.back() + 2.0 * end * slope,
                1e-12 * (law.spring.force.back() + end * slope));
    EXPECT_EQ(evaluate(law.spring, 3.0 * end).slope, slope);
  }
}

}  // namespace
}  // namespace grouser
