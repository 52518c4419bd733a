#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "model/errors.h"
#include "reports/channels.h"
#include "reports/figure_block.h"
#include "reports/report.h"
#include "tests/support/mock_run.h"
#include "tests/support/temporary_folder.h"

namespace grouser {
namespace {

class RunFigures : public testing::Test {
 protected:
  RunFolder run(const mock::RunOptions& options = {}) {
    mock::write_run(folder_.path(), options);
    return open_run(folder_.path());
  }
  test::TemporaryFolder folder_;
};

TEST_F(RunFigures, EachOfTheCatalogueCanBeMade) {
  const RunFolder mock = run();
  std::set<std::string> names;
  for (const FigureEntry& entry : run_figures()) {
    EXPECT_FALSE(entry.meaning.empty()) << entry.name;
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name << " stands twice";
    const Figure figure = make_run_figure(mock, entry.name);
    EXPECT_EQ(figure.name, entry.name);
    EXPECT_FALSE(figure.title.empty() || figure.caption.empty()) << entry.name;
    ASSERT_FALSE(figure.panels.empty()) << entry.name;
    for (const Panel& panel : figure.panels) {
      EXPECT_FALSE(panel.series.empty()) << entry.name;
      for (const Series& series : panel.series) {
        EXPECT_EQ(series.x.size(), series.y.size()) << entry.name << " " << series.name;
        EXPECT_GT(series.x.size(), 0u) << entry.name << " " << series.name;
      }
    }
    EXPECT_FALSE(figure.panels.back().x_label.empty()) << entry.name;
  }
  EXPECT_THAT(names, testing::IsSupersetOf({"step_size", "tension", "contact_forces"}));
}

TEST_F(RunFigures, ATorqueDrivenRunIsAskedForATorqueAndForNoSpeed) {
  const Figure figure = make_run_figure(run({.drive = mock::Drive::torque}), "speed");
  ASSERT_EQ(figure.panels.size(), 3u);
  EXPECT_EQ(figure.panels[0].series.size(), 2u);
  // The feed is what the sprockets really turn: 45 rad/s in the middle of the run.
  EXPECT_NEAR(*std::ranges::max_element(figure.panels[0].series[1].y), 45.0 * 1.94 / (2.0 * k_pi), 1e-9);
  EXPECT_EQ(figure.panels[2].title, "Torque asked for");
  EXPECT_NEAR(*std::ranges::max_element(figure.panels[2].series[0].y), 8.0, 1e-12);
}

TEST_F(RunFigures, ADriversWishIsDrawnBesideTheSpeed) {
  const RunFolder mock = run({.drive = mock::Drive::cruise});
  const Figure figure = make_run_figure(mock, "speed");
  ASSERT_EQ(figure.panels[0].series.size(), 3u);
  EXPECT_NEAR(*std::ranges::max_element(figure.panels[0].series[2].y), 45.0 * 1.94 / (2.0 * k_pi), 1e-9);
  EXPECT_NEAR(asked_speed(mock, Side::left, 1.0).value(), 45.0, 1e-12);  // so that the steady drive is found
  EXPECT_EQ(make_run_figure(mock, "torque_spectrum").panels.size(), 1u);
}

TEST_F(RunFigures, RefuseAnUnknownNameAndSayTheKnownOnes) {
  const RunFolder mock = run();
  try {
    (void)make_run_figure(mock, "tensoin");
    FAIL() << "an unknown figure was made";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("contact_forces_zoom"));
  }
}

TEST_F(RunFigures, NameTheDatasetThatIsMissing) {
  const RunFolder mock = run({.probes = false});
  try {
    (void)make_run_figure(mock, "sprocket_torque");
    FAIL() << "a figure was made from nothing";
  } catch (const InputError& error) {
    EXPECT_EQ(error.findings().front().place, "/probes/time");
  }
}

TEST_F(RunFigures, SpeedIsTheFeedOfTheTrackWhereTheMockRolls) {
  const RunFolder mock = run({.duration = 3.0});
  const std::vector<double> speed = forward_speed(mock);
  // 10 teeth x 0.194 m x 45 rad/s / 2 pi; the mock rolls without slip.
  EXPECT_NEAR(*std::ranges::max_element(speed), 13.894, 1e-3);
  EXPECT_NEAR(track_feed_speed(mock, Side::left, 45.0), 13.894, 1e-3);
}

TEST_F(RunFigures, SteadyWindowIsWhereBothSprocketsHoldTheirSpeed) {
  const std::optional<TimeWindow> window = steady_window(run({.duration = 3.0, .turn = true}));
  ASSERT_TRUE(window);
  EXPECT_DOUBLE_EQ(window->begin, 1.0);
  EXPECT_DOUBLE_EQ(window->end, 2.0);
}

TEST_F(RunFigures, SpectrumShowsTheLinkPassingLine) {
  const Figure figure = make_run_figure(run({.duration = 6.0}), "torque_spectrum");
  const Series& left = figure.panels.front().series.front();
  const auto peak = std::ranges::max_element(left.y) - left.y.begin();
  EXPECT_NEAR(left.x[static_cast<std::size_t>(peak)], 71.6, 0.8);  // one line of a spectrum over 1.33 s
  // 4 kN m in the mock; a Hann window reads a line between two bins up to 15 % low.
  EXPECT_NEAR(left.y[static_cast<std::size_t>(peak)], 4.0, 0.6);
  ASSERT_EQ(figure.panels.front().marks.size(), 1u);
  EXPECT_NEAR(figure.panels.front().marks.front().at, 71.62, 0.01);
}

TEST_F(RunFigures, StepLimitsShareOutAllSteps) {
  const Figure figure = make_run_figure(run(), "step_limits");
  const std::vector<Series>& series = figure.panels.front().series;
  for (std::size_t bin = 0; bin < series.front().y.size(); ++bin) {
    double sum = 0.0;
    for (const Series& limit : series) sum += limit.y[bin];
    EXPECT_NEAR(sum, 100.0, 1e-9);
  }
}

TEST(AmplitudeSpectrum, ReadsASineTrueAndIgnoresDrift) {
  std::vector<double> samples;
  for (int i = 0; i < 1000; ++i) samples.push_back(3.0 * std::sin(2.0 * k_pi * 20.0 * i / 500.0) + 40.0 + 0.01 * i);
  const Spectrum spectrum = amplitude_spectrum(samples, 500.0);
  const auto peak = std::ranges::max_element(spectrum.amplitude) - spectrum.amplitude.begin();
  EXPECT_NEAR(spectrum.frequency[static_cast<std::size_t>(peak)], 20.0, 1e-9);  // falls on a bin
  EXPECT_NEAR(spectrum.amplitude[static_cast<std::size_t>(peak)], 3.0,
              0.01);  // leakage of the removed line's remainder
  EXPECT_LT(spectrum.amplitude.front(), 0.05);
}

TEST(PeakPreservingRows, KeepEveryPeakThatStandsAlone) {
  std::vector<double> flat(50000, 1.0), peaks(50000, 0.0);
  for (const std::size_t i : {17u, 20001u, 49000u}) peaks[i] = 5.0;
  peaks[33333] = -5.0;
  const std::vector<std::size_t> rows = peak_preserving_rows({&flat, &peaks}, 1000);
  EXPECT_LE(rows.size(), 1000u);
  EXPECT_TRUE(std::ranges::is_sorted(rows));
  EXPECT_THAT(rows, testing::IsSupersetOf({std::size_t{0}, std::size_t{17}, std::size_t{20001}, std::size_t{33333},
                                           std::size_t{49000}, std::size_t{49999}}));
}

TEST(PeakPreservingRows, KeepAllWhenTheyAreFew) {
  const std::vector<double> few{1.0, 2.0, 3.0};
  EXPECT_EQ(peak_preserving_rows({&few}, 1000).size(), 3u);
}

}  // namespace
}  // namespace grouser
