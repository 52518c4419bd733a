// Play and hard stops are said when the data show them, and only then.
#include "identification/joint_limits.h"

#include <gtest/gtest.h>

#include <cmath>

#include "identification/identify.h"
#include "tests/identification/bench.h"

namespace grouser {
namespace {

constexpr double k_degree = 3.14159265358979323846 / 180.0;

template <typename Force>
AxisFit with_backbone(double low, double high, Force force) {
  AxisFit fit;
  for (int i = 0; i <= 40; ++i) {
    const double x = low + (high - low) * i / 40.0;
    fit.backbone.push_back({x, force(x), 0.0, 0.0});
  }
  return fit;
}

double beyond(double x, double limit) { return std::copysign(std::max(std::abs(x) - limit, 0.0), x); }

TEST(JointLimits, OfStiffeningRubberAreNone) {
  // 65 x + 20 x^3 kN, mm: at 1 mm nearly twice as stiff as at rest; and the same with both terms equal.
  for (const double k3 : {20e12, 65e12}) {
    AxisFit fit = with_backbone(-1e-3, 1e-3, [&](double x) { return 65e6 * x + k3 * x * x * x; });
    find_joint_limits(fit);
    EXPECT_FALSE(fit.clearance.has_value());
    EXPECT_TRUE(fit.hard_stops.empty());
  }
}

TEST(JointLimits, OfAThreefoldKinkAreNone) {
  AxisFit fit = with_backbone(-1e-3, 1e-3, [](double x) { return 1e7 * x + 2e7 * beyond(x, 0.8e-3); });
  find_joint_limits(fit);
  EXPECT_TRUE(fit.hard_stops.empty());  // the bar is fourfold
}

TEST(JointLimits, ShowPlayWithItsWidth) {
  AxisFit fit = with_backbone(-1e-3, 1.2e-3, [](double x) { return 1e6 * x + 1e8 * beyond(x - 0.1e-3, 0.2e-3); });
  find_joint_limits(fit);
  ASSERT_TRUE(fit.clearance.has_value());
  // breaks are searched in eighths of a station's distance (55 um): half a step
  EXPECT_NEAR(fit.clearance->low, -0.1e-3, 4e-6);
  EXPECT_NEAR(fit.clearance->high, 0.3e-3, 4e-6);
  EXPECT_NEAR(fit.clearance->stiffness_ratio, 1.0 / 101.0,
              5e-3);  // a break 2 um off: 1 % of the stiff piece in 200 um of play
}

// Play of 6 degrees each way within stops at 52 (stronger: searched first) or at 45, with soft stops (play is
// stronger).
TEST(JointLimits, ShowPlayAndStopsOfOneJoint) {
  for (const double stop : {52.0, 45.0}) {
    const double stiff = stop > 50.0 ? 8e4 : 8e3;
    AxisFit fit = with_backbone(-60 * k_degree, 60 * k_degree, [&](double x) {
      return 10 * x + 1600 * beyond(x, 6 * k_degree) + stiff * beyond(x, stop * k_degree);
    });
    find_joint_limits(fit);
    ASSERT_TRUE(fit.clearance.has_value()) << stop;
    EXPECT_NEAR(fit.clearance->low, -6 * k_degree, 0.2 * k_degree);  // half an eighth of 3 degrees
    EXPECT_NEAR(fit.clearance->high, 6 * k_degree, 0.2 * k_degree);
    ASSERT_EQ(fit.hard_stops.size(), 2u) << stop;
    EXPECT_NEAR(fit.hard_stops[0].at, -stop * k_degree, 0.4 * k_degree);
    EXPECT_NEAR(fit.hard_stops[1].at, stop * k_degree, 0.4 * k_degree);
  }
}

// Wherever it stands between two stations, 3 degrees apart, and on either side.
TEST(JointLimits, ShowAStopOnOneSide) {
  for (const double side : {-1.0, 1.0}) {
    for (double stop = 51.1; stop < 54.0; stop += 0.2) {
      AxisFit fit = with_backbone(-60 * k_degree, 60 * k_degree, [&](double x) {
        return 1600 * x + side * 8e4 * std::max(side * x - stop * k_degree, 0.0);
      });
      find_joint_limits(fit);
      EXPECT_FALSE(fit.clearance.has_value()) << stop;
      ASSERT_EQ(fit.hard_stops.size(), 1u) << stop;
      EXPECT_NEAR(fit.hard_stops[0].at, side * stop * k_degree, 0.2 * k_degree);  // half an eighth of 3 degrees
      EXPECT_NEAR(fit.hard_stops[0].stiffness_ratio, 51.0, 2.0) << stop;
    }
  }
}

IdentifyResult identified(const AxisCampaign& campaign) {
  std::vector<RigTest> tests;
  for (const PlannedTest& plan : campaign.tests) {
    tests.push_back(as_rig_test(run_test(campaign, plan)));
    if (plan.preset != 0.0) tests.back().preset = plan.preset;
  }
  return identify(record_of(std::move(tests)));
}

// The law is asked for its own settled response, so no error of a single mounting (0.3 %) stands between.
void expect_reproduced(const IdentifyResult& result, const AxisCampaign& campaign) {
  for (const TestFit& test : result.fit.tests) EXPECT_LT(test.nrmse, 0.015) << test.name;  // noise: 1 % of the smallest
  const AxisFit& fit = result.fit.axes.at(0);
  const Backbone truth = true_backbone(campaign.rubber, fit.backbone.front().x, fit.backbone.back().x, 120.0);
  const double span = truth.force.back() - truth.force.front();
  for (std::size_t i = 0; i < truth.force.size(); ++i) {
    // gain and left-over conditioning of the ramp: .6 % of half the span; a spline with knots 3 degrees apart rounds
    // the stop's corner by a tenth of 9 * 1600 N m/rad * 3 degrees: 75 N m, 1 % of the span
    EXPECT_NEAR(fit.backbone[i].value, truth.force[i], 0.013 * span) << fit.backbone[i].x / k_degree;
  }
}

TEST(JointLimits, OfLargeTorsionToSixtyDegreesAboutItsPresetIsReproduced) {
  const AxisCampaign campaign = large_torsion_campaign(false);
  const IdentifyResult result = identified(campaign);
  expect_reproduced(result, campaign);
  const AxisFit& fit = result.fit.axes.at(0);
  EXPECT_NEAR(fit.preset, 14 * k_degree, 1e-9);
  EXPECT_GE(fit.backbone.back().x, 59.5 * k_degree);
  EXPECT_TRUE(fit.hard_stops.empty());
  EXPECT_FALSE(fit.clearance.has_value());
}

TEST(JointLimits, OfLargeTorsionFindsTheStopAngleThatTheDataShow) {
  const AxisCampaign campaign = large_torsion_campaign(true);
  const IdentifyResult result = identified(campaign);
  expect_reproduced(result, campaign);
  const AxisFit& fit = result.fit.axes.at(0);
  ASSERT_EQ(fit.hard_stops.size(), 2u);  // the ramp meets it on both sides
  // a knot's distance: 120 degrees over the 24 or 40 intervals that such a spring takes
  EXPECT_NEAR(fit.hard_stops[0].at, -52 * k_degree, 3 * k_degree);
  EXPECT_NEAR(fit.hard_stops[1].at, 52 * k_degree, 3 * k_degree);
}

TEST(JointLimits, ShowTheClearanceOfAMeasuredJoint) {
  AxisCampaign campaign = Bench().axis(Axis::z);
  campaign.rubber.clearance = 0.2e-3;
  campaign.rubber.springpot = 0.0;
  campaign.rubber.branches.clear();
  for (FrictionStop& stop : campaign.rubber.stops) stop.stiffness *= 0.1;  // play is not filled with rubber
  const IdentifyResult result = identified(campaign);
  const AxisFit& fit = result.fit.axes.at(0);
  ASSERT_TRUE(fit.clearance.has_value());
  EXPECT_NEAR(fit.clearance->high, 0.2e-3, 0.05e-3);  // half a knot's distance of 1.6 mm over 14 intervals
  EXPECT_NEAR(fit.clearance->low, -0.2e-3, 0.05e-3);
  EXPECT_LT(fit.clearance->stiffness_ratio, 0.25);
}

}  // namespace
}  // namespace grouser
