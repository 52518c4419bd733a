#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "reports/common_base.h"

namespace grouser {
namespace {

TimeSeries sampled(double from, double to, double step, const std::function<double(double)>& curve) {
  TimeSeries series;
  const auto count = static_cast<int>(std::lround((to - from) / step));
  for (int i = 0; i <= count; ++i) {
    series.time.push_back(from + step * i);
    series.value.push_back(curve(series.time.back()));
  }
  return series;
}
double ramp(double t) { return 3.0 * t - 1.0; }

TEST(CommonBase, CoversWhatBothCurvesAndTheWindowDo) {
  const TimeSeries a = sampled(0.0, 10.0, 0.01, ramp), b = sampled(2.5, 20.0, 0.01, ramp);
  const CommonBase all = common_base(a, b, k_all_time), part = common_base(a, b, {3.0, 4.0});
  EXPECT_NEAR(all.begin, 2.5, 1e-12);
  EXPECT_NEAR(all.end(), 10.0, 1e-9);
  EXPECT_NEAR(part.begin, 3.0, 1e-12);
  EXPECT_NEAR(part.end(), 4.0, 1e-9);
}

// A straight line stays one, interpolated or averaged.
TEST(CommonBase, KeepsAStraightLineWhateverTheSampling) {
  const CommonBase base = common_base(sampled(0.0, 10.0, 0.0073, ramp), sampled(0.05, 9.0, 0.002, ramp), k_all_time);
  EXPECT_NEAR(base.step, 0.0073, 1e-12);
  const std::vector<double> time = base.time();
  for (std::size_t i = 1; i + 1 < time.size(); ++i) {
    EXPECT_NEAR(base.reference[i], ramp(time[i]), 1e-9);
    EXPECT_NEAR(base.other[i], ramp(time[i]), 1e-9);
  }
}

// 1 kHz against 100 Hz: a tone of 170 Hz, which 100 Hz cannot show, comes down to its mean over 10 ms,
// |sin(pi f h) / (pi f h)| = 0.15 of it; taken as it stands at the instants it would be a full one of 30 Hz.
TEST(CommonBase, DoesNotTurnAToneThatItCannotShowIntoAnother) {
  const auto tone = [](double t) { return std::sin(2.0 * std::numbers::pi * 170.0 * t); };
  const CommonBase base =
      common_base(sampled(0.0, 2.0, 0.01, [](double) { return 0.0; }), sampled(0.0, 2.0, 1e-4, tone), k_all_time);
  const double left = std::abs(std::sin(std::numbers::pi * 1.7) / (std::numbers::pi * 1.7));
  for (std::size_t i = 1; i + 1 < base.other.size(); ++i) EXPECT_LE(std::abs(base.other[i]), 1.01 * left);
}

TEST(CommonBase, TakesTheLongestPieceBetweenGaps) {
  TimeSeries measured;
  for (int i = 0; i < 1000; ++i) {
    const double t = 0.01 * i;
    if ((t > 2.0 && t < 2.5) || (t > 8.0 && t < 8.3)) continue;
    measured.time.push_back(t);
    measured.value.push_back(ramp(t));
  }
  const CommonBase base = common_base(measured, sampled(0.0, 10.0, 0.005, ramp), k_all_time);
  EXPECT_NEAR(base.begin, 2.5, 1e-9);
  EXPECT_NEAR(base.end(), 8.0, 1e-9);
  EXPECT_NE(base.remark.find("2 gaps"), std::string::npos) << base.remark;
}

TEST(CommonBase, ASampleNowAndThenThatIsMissingIsNoGap) {
  TimeSeries measured = sampled(0.0, 5.0, 0.01, ramp);
  measured.time.erase(measured.time.begin() + 100, measured.time.begin() + 103);
  measured.value.erase(measured.value.begin() + 100, measured.value.begin() + 103);
  EXPECT_EQ(common_base(measured, sampled(0.0, 5.0, 0.01, ramp), k_all_time).remark, "");
}

TEST(CommonBase, StaysWithinWhatARatingCanCost) {
  const CommonBase base = common_base(sampled(0.0, 100.0, 1e-3, ramp), sampled(0.0, 100.0, 1e-3, ramp), k_all_time);
  EXPECT_EQ(base.reference.size(), k_most_instants);
  EXPECT_NEAR(base.end(), 100.0, 1e-9);
}

TEST(CommonBase, SaysWhyThereIsNone) {
  const TimeSeries early = sampled(0.0, 1.0, 0.01, ramp), late = sampled(3.0, 4.0, 0.01, ramp);
  EXPECT_NE(common_base(early, late, k_all_time).problem.find("one curve covers 0 s to 1 s, the other 3 s to 4 s"),
            std::string::npos)
      << common_base(early, late, k_all_time).problem;
  EXPECT_NE(common_base(early, early, {0.0, 0.1}).problem.find("only 11 samples"), std::string::npos);
  EXPECT_NE(common_base(early, {{1.0}, {2.0}}, k_all_time).problem, "");
}

}  // namespace
}  // namespace grouser
