#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "reports/fit_figures.h"
#include "reports/gain_trend.h"
#include "reports/loop_points.h"
#include "tests/support/mock_run.h"

namespace grouser {
namespace {

int count(const Panel& panel, SeriesStyle style) {
  return static_cast<int>(std::ranges::count(panel.series, style, &Series::style));
}

class FitFigures : public testing::Test {
 protected:
  const AxisFit& axis(Axis wanted) const { return *std::ranges::find(fit_.axes, wanted, &AxisFit::axis); }
  std::vector<const TestFit*> tests(Axis wanted) const { return tests_of(fit_.tests, wanted); }
  FitRecord fit_ = mock::fit_record();
};

TEST_F(FitFigures, ShowEveryLoopMeasuredAndFittedInReadingOrder) {
  const std::optional<Figure> figure = figure_loops(tests(Axis::x), "fit");
  ASSERT_TRUE(figure);
  ASSERT_EQ(figure->panels.size(), 6u);
  EXPECT_EQ(figure->panels[0].title, "loop_x_100_1");  // by amplitude, then frequency
  EXPECT_EQ(figure->panels[1].title, "loop_x_100_10");
  EXPECT_EQ(figure->panels[3].title, "loop_x_500_1");
  for (const Panel& panel : figure->panels) {
    ASSERT_EQ(panel.series.size(), 2u) << panel.title;
    EXPECT_EQ(panel.series[0].name, "measured");
    EXPECT_EQ(panel.series[1].name, "fit");
    for (const Series& series : panel.series) EXPECT_FALSE(series.x.empty()) << panel.title;
  }
}

TEST_F(FitFigures, ALoopThatWasLeftOutStandsWithoutAFitAndHasNoResidual) {
  fit_.tests[0].cycles_used = 0;
  EXPECT_EQ(figure_loops(tests(Axis::x), "fit")->panels[0].series.size(), 1u);
  EXPECT_EQ(figure_residuals(tests(Axis::x))->panels.size(), 5u);
}

TEST_F(FitFigures, ResidualsShareOneScaleInPerCentOfTheForceRange) {
  const std::optional<Figure> figure = figure_residuals(tests(Axis::x));
  ASSERT_TRUE(figure);
  const TestFit& test = *tests(Axis::x)[0];
  const auto [low, high] = std::ranges::minmax(test.curve.force);
  EXPECT_NEAR(figure->panels[0].series[0].y[3], 100.0 * (test.curve.force[3] - test.curve.fitted[3]) / (high - low),
              1e-12);
  for (const Panel& panel : figure->panels) EXPECT_EQ(panel.y_range, figure->panels[0].y_range);
}

TEST_F(FitFigures, GiveEveryAmplitudeItsBandItsLineAndItsPoints) {
  const std::optional<Figure> figure = figure_stiffness(axis(Axis::x), tests(Axis::x));
  ASSERT_TRUE(figure);
  ASSERT_EQ(figure->panels.size(), 4u);
  const Panel& over_frequency = figure->panels[0];
  ASSERT_EQ(over_frequency.bands.size(), 2u);  // two amplitudes
  EXPECT_EQ(count(over_frequency, SeriesStyle::line), 2);
  EXPECT_EQ(count(over_frequency, SeriesStyle::points), 2);
  EXPECT_EQ(over_frequency.series[0].name, "0.1 mm");
  const ResponsePoint& cell = axis(Axis::x).responses[0];
  EXPECT_DOUBLE_EQ(over_frequency.bands[0].low[0], 1e-6 * cell.storage_stiffness.low);
  EXPECT_DOUBLE_EQ(over_frequency.series[1].y[0], 1e-6 * tests(Axis::x)[0]->measured.storage_stiffness);
  EXPECT_EQ(figure->panels[2].series[0].name, "0.1 Hz");
}

TEST_F(FitFigures, LeaveOutWhatTheCampaignDidNotVary) {
  // The hinge was tested at one amplitude: nothing runs over amplitude.
  const std::optional<Figure> figure = figure_stiffness(axis(Axis::ry), tests(Axis::ry));
  ASSERT_TRUE(figure);
  for (const Panel& panel : figure->panels) EXPECT_EQ(panel.x_label, "Frequency [Hz]");
  EXPECT_FALSE(figure_energy(axis(Axis::ry), tests(Axis::ry)));
}

TEST_F(FitFigures, WithoutIntervalsShowTheLawsAnswerToEveryLoop) {
  AxisFit bare = axis(Axis::x);
  bare.responses.clear();
  const std::optional<Figure> figure = figure_energy(bare, tests(Axis::x));
  ASSERT_TRUE(figure);
  EXPECT_EQ(figure->panels[0].bands[0].low, figure->panels[0].bands[0].high);
  EXPECT_DOUBLE_EQ(figure->panels[0].series[0].y[0], tests(Axis::x)[0]->fitted.dissipated_energy);
}

TEST_F(FitFigures, MarkPlayStopsAndPreset) {
  std::set<std::string> labels;
  for (const Axis each : {Axis::x, Axis::ry}) {
    const std::optional<Figure> figure = figure_backbone(axis(each));
    ASSERT_TRUE(figure);
    for (const Mark& mark : figure->panels[0].marks) labels.insert(mark.label);
  }
  EXPECT_EQ(labels, (std::set<std::string>{"play", "preset", "stop"}));
}

TEST_F(FitFigures, TellTheChosenSizeOfTheLawFromTheOthers) {
  const std::optional<Figure> figure = figure_selection(axis(Axis::x));
  ASSERT_TRUE(figure);
  const auto chosen = std::ranges::find(figure->panels[0].series, "chosen", &Series::name);
  ASSERT_NE(chosen, figure->panels[0].series.end());
  EXPECT_EQ(chosen->x, std::vector<double>{5.0});
}

TEST_F(FitFigures, HaveStableNames) {
  const AxisFit& x = axis(Axis::x);
  const auto loops = tests(Axis::x);
  std::vector<std::string> names;
  for (const std::optional<Figure>& figure :
       {figure_loops(loops, "fit"), figure_residuals(loops), figure_gain(loops), figure_stiffness(x, loops),
        figure_energy(x, loops), figure_backbone(x), figure_selection(x)})
    names.push_back(figure->name);
  EXPECT_EQ(names, (std::vector<std::string>{"loops_x", "residuals_x", "gain_x", "stiffness_x", "energy_x",
                                             "backbone_x", "selection_x"}));
}

TEST(LoopPoints, PartATestOfSeveralAmplitudesAndMeanEach) {
  TestFit test;
  test.cycles_used = 4;
  for (const double amplitude : {1.0, 1.02, 2.0, 2.02}) {
    CycleFit cycle;
    cycle.used = true;
    cycle.amplitude = amplitude;
    cycle.measured.dissipated_energy = 10.0 * amplitude;
    test.per_cycle.push_back(cycle);
  }
  const std::vector<LoopPoint> points = loop_points({&test});
  ASSERT_EQ(points.size(), 2u);
  EXPECT_DOUBLE_EQ(points[0].amplitude, 1.01);
  EXPECT_DOUBLE_EQ(points[1].measured.dissipated_energy, 20.1);
}

TEST(LoopPoints, LevelsGatherValuesThatWereMeantToBeEqual) {
  const std::vector<double> levels = levels_of({0.0505, 0.1, 0.0495, 0.102, 1.0});
  ASSERT_EQ(levels.size(), 3u);
  EXPECT_DOUBLE_EQ(levels[0], 0.05);
  EXPECT_EQ(level_index(levels, 0.099), 1u);
}

// Gains made of two known slopes come back exactly; alternating errors widen the interval round an absent one.
TEST(GainTrend, FindsTheSlopesItWasMadeOf) {
  std::vector<TestFit> tests;
  for (const double frequency : {0.1, 1.0, 10.0})
    for (const double amplitude : {1e-4, std::sqrt(10.0) * 1e-4, 1e-3}) {
      TestFit test;
      test.cycles_used = 3;
      test.frequency = frequency;
      test.amplitude = amplitude;
      test.gain = 0.01 + 0.02 * std::log10(frequency) + (tests.size() % 2 == 0 ? 1e-3 : -1e-3);
      tests.push_back(test);
    }
  const GainTrends trends = gain_trends(tests_of(tests, Axis::x));
  ASSERT_TRUE(trends.frequency && trends.amplitude);
  EXPECT_NEAR(trends.frequency->per_decade, 0.02, 1e-12);  // the errors are balanced over both factors
  EXPECT_TRUE(trends.frequency->is_real());
  EXPECT_NEAR(trends.amplitude->per_decade, 0.0, 1e-12);
  EXPECT_FALSE(trends.amplitude->is_real());
  // Half width by hand: residuals +-1e-3 about their mean 1/9e-3, 6 degrees of freedom, t = 2.447, sum of squares of
  // log10 f about its mean = 6.
  const double variance = (9.0 - 1.0 / 9.0) * 1e-6 / 6.0;
  EXPECT_NEAR(trends.frequency->half_width, 2.447 * std::sqrt(variance / 6.0), 2e-6);  // t to three digits
}

TEST(GainTrend, SaysNothingOfTooFewTests) {
  std::vector<TestFit> tests(4);
  for (std::size_t i = 0; i < tests.size(); ++i) {
    tests[i].cycles_used = 3;
    tests[i].amplitude = 1.0;
    tests[i].frequency = std::pow(10.0, static_cast<double>(i));
  }
  EXPECT_FALSE(gain_trends(tests_of(tests, Axis::x)).frequency);  // 4 tests, 2 unknowns: two degrees of freedom
}

}  // namespace
}  // namespace grouser
