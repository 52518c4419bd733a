#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "model/errors.h"
#include "reports/channels.h"
#include "reports/figure_block.h"
#include "reports/report.h"
#include "reports/run_figures.h"
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
  const RunFolder mock = run({.contact_forces = true});
  std::set<std::string> names;
  for (const FigureEntry& entry : run_figures()) {
    EXPECT_FALSE(entry.meaning.empty()) << entry.name;
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name << " stands twice";
    const Figure figure = make_run_figure(mock, entry.name);
    EXPECT_EQ(figure.name, entry.name);
    EXPECT_FALSE(figure.title.empty() || figure.caption.empty()) << entry.name;
    ASSERT_FALSE(figure.panels.empty()) << entry.name;
    for (const Panel& panel : figure.panels) {
      EXPECT_FALSE(panel.series.empty() && !panel.map) << entry.name;
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

// The mock loads every seventh link by 30 kN and 0.2 kN more a link.
TEST_F(RunFigures, WheelLoadsAddUpToTheForceOnTheTrack) {
  const RunFolder mock = run({.contact_forces = true});
  double sum_of_links = 0.0;
  for (int i = 0; i < mock.vehicle.side(Side::left).track.num_links; i += 7) sum_of_links += 30.0 + 0.2 * i;
  for (const Panel& panel : make_run_figure(mock, "wheel_loads").panels) {
    ASSERT_EQ(panel.series.size(), mock.vehicle.side(Side::left).stations.size());
    for (const std::size_t row : {std::size_t{0}, std::size_t{77}, panel.series[0].y.size() - 1}) {
      double sum = 0.0;
      for (const Series& wheel : panel.series) sum += wheel.y[row];
      EXPECT_NEAR(sum, sum_of_links, 1e-4);  // forces are stored in single precision
    }
  }
}

TEST_F(RunFigures, WheelTravelIsTheHeightOfTheArmsEnd) {
  const RunFolder mock = run();
  const Station& station = mock.vehicle.side(Side::left).stations[2];
  const Vector3d arm = station.wheel.center - station.pivot;
  const double radius = std::hypot(arm.x(), arm.z()), design = std::atan2(arm.z(), arm.x());
  const Series travel = make_run_figure(mock, "wheel_travel").panels[0].series[2];
  for (const std::size_t row : {std::size_t{20}, std::size_t{60}}) {
    const double angle = 0.02 * std::sin(9.0 * travel.x[row]);  // about +y, which turns x towards -z
    EXPECT_NEAR(travel.y[row], 1e3 * radius * (std::sin(design - angle) - std::sin(design)), 1e-9);
  }
}

TEST_F(RunFigures, TheTensionMapKeepsTheLargestOfEachCell) {
  const RunFolder mock = run({.duration = 5.0});  // 1001 samples, more than cells
  const Figure figure = make_run_figure(mock, "tension_map");
  ASSERT_EQ(figure.panels.size(), 2u);
  const HeatMap& map = *figure.panels[0].map;
  EXPECT_EQ(map.rows, 76u);
  EXPECT_LT(map.columns, 1000u);
  const Array force = mock.channels.read("/tracks/left/bushing_force");
  for (const std::size_t link : {0u, 33u, 75u}) {
    double largest = 0.0, shown = 0.0;
    for (std::size_t row = 0; row < force.rows(); ++row) largest = std::max(largest, 1e-3 * force.row(row)[3 * link]);
    for (std::size_t column = 0; column < map.columns; ++column)
      shown = std::max(shown, map.values[link * map.columns + column]);
    EXPECT_DOUBLE_EQ(shown, largest);
  }
  EXPECT_EQ(map.color_range(), figure.panels[1].map->color_range()) << "the sides have one scale";
}

TEST_F(RunFigures, HistogramsShareOutAllSamples) {
  const RunFolder mock = run();
  for (const char* name : {"tension_histogram", "step_histogram"})
    for (const Panel& panel : make_run_figure(mock, name).panels)
      EXPECT_NEAR(std::accumulate(panel.series[0].y.begin(), panel.series[0].y.end(), 0.0), 100.0, 1e-9) << name;
}

TEST(Histogram, CountsEachValueInItsBin) {
  const Series shares = histogram("", {0.0, 0.1, 0.9, 1.0}, 0.0, 1.0, 4);
  EXPECT_THAT(shares.x, testing::ElementsAre(0.125, 0.375, 0.625, 0.875));
  EXPECT_THAT(shares.y, testing::ElementsAre(50.0, 0.0, 0.0, 50.0));
}

TEST_F(RunFigures, LoopsOfABushingTurnOnceAnOscillation) {
  const Figure figure = make_run_figure(run({.duration = 9.0}), "bushing_loops");
  ASSERT_EQ(figure.panels.size(), 3u);
  const Series& hinge = figure.panels[2].series[0];
  EXPECT_NEAR(hinge.x.back() - hinge.x.front(), 0.0, 25.0);  // degrees; 0.2 rad to both sides
  // A lap of 76 links of 0.194 m at 13.894 m/s, at 2000 Hz.
  EXPECT_NEAR(static_cast<double>(hinge.x.size()), 76 * 0.194 / 13.894 * 2000.0, 2.0);
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
