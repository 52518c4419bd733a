// Large torsion with a stop at its end, and a joint with play: springs that need many knots.
#include <gtest/gtest.h>

#include <numbers>

#include "identification/axis_fit.h"
#include "tests/identification/law_campaign.h"

namespace grouser {
namespace {

constexpr double k_degree = std::numbers::pi / 180.0;

// A kink in stiffness at `at`, rounded over `width`: integral of the logistic function.
double ramp_up(double x, double at, double width) {
  const double u = (x - at) / width;
  return width * (u > 30.0 ? u : std::log1p(std::exp(u)));
}

template <typename Force>
AxisLaw law_with_spring(double reach, Force force) {
  AxisLaw law;
  constexpr int knots = 601;
  for (int i = 0; i < knots; ++i) {
    law.spring.displacement.push_back(-reach + 2.0 * reach * i / (knots - 1));
    law.spring.force.push_back(force(law.spring.displacement.back()));
  }
  law.spring.slope = fritsch_carlson_slopes(law.spring.displacement, law.spring.force);
  return law;
}

double worst_nrmse(const LawCampaign& campaign, const AxisSolution& solution) {
  double worst = 0.0;
  const AxisLaw law = make_law(solution.dictionary, solution.coefficients);
  for (const PreparedTest& test : campaign.tests) {
    worst = std::max(worst, evaluate_fit(test, replay(law, test.time, test.displacement)).nrmse);
  }
  return worst;
}

TEST(LargeTorsion, IsFittedToSixtyDegreesWithItsHardStop) {
  const double stiffness = 3.0e3, stop = 52.0 * k_degree, width = 1.5 * k_degree;  // rubber rounds the contact
  AxisLaw truth = law_with_spring(61.0 * k_degree, [&](double x) {
    return stiffness * (x + 10.0 * (ramp_up(x, stop, width) - ramp_up(-x, stop, width)));
  });
  truth.stops = {{0.3 * stiffness, 4.0 * k_degree}};
  const LawCampaign campaign({ramp_of(truth, Axis::ry, 60.0 * k_degree, 60.0, 1),
                              loop_of(truth, Axis::ry, 20.0 * k_degree, 0.5, 2),
                              loop_of(truth, Axis::ry, 45.0 * k_degree, 0.5, 3)});
  const AxisSolution solution = fit_axis(campaign.data);
  EXPECT_GE(solution.dictionary.spring.intervals(), 24);
  EXPECT_LT(worst_nrmse(campaign, solution), 1.5 * k_law_noise);  // noise itself is 1
  const SpringSpline spring = make_law(solution.dictionary, solution.coefficients).spring;
  EXPECT_NEAR(evaluate(spring, 59.0 * k_degree).slope, 11.0 * stiffness, 0.1 * 11.0 * stiffness);
  EXPECT_NEAR(evaluate(spring, 30.0 * k_degree).slope, stiffness, 0.1 * stiffness);
}

TEST(Clearance, IsFittedAsAZoneThatHardlyResists) {
  const double stiffness = 8.0e7, play = 0.15e-3, width = 0.01e-3;
  AxisLaw truth = law_with_spring(1.05e-3, [&](double x) {
    return 0.02 * stiffness * x + stiffness * (ramp_up(x, play, width) - ramp_up(-x, play, width));
  });
  truth.stops = {{0.02 * stiffness, 0.02e-3}};
  const LawCampaign campaign({ramp_of(truth, Axis::x, 1.0e-3, 120.0, 1), loop_of(truth, Axis::x, 0.4e-3, 1.0, 2),
                              loop_of(truth, Axis::x, 0.8e-3, 1.0, 3)});
  const AxisSolution solution = fit_axis(campaign.data);
  EXPECT_GE(solution.dictionary.spring.intervals(), 24);
  EXPECT_LT(worst_nrmse(campaign, solution), 1.5 * k_law_noise);
  const SpringSpline spring = make_law(solution.dictionary, solution.coefficients).spring;
  EXPECT_LT(evaluate(spring, 0.0).slope, 0.1 * stiffness);
  EXPECT_NEAR(evaluate(spring, 0.7e-3).slope, 1.02 * stiffness, 0.05 * stiffness);
}

}  // namespace
}  // namespace grouser
