#include <gtest/gtest.h>

#include <algorithm>

#include "model/fit.h"
#include "reports/fit_figures.h"
#include "tests/support/mock_run.h"
#include "tests/support/temporary_folder.h"

namespace grouser {
namespace {

FitRecord mock_fit() {
  const test::TemporaryFolder folder;
  mock::write_fit_folder(folder.path());
  return read_fit(folder.path() / "fit.json");
}

int count(const Panel& panel, SeriesStyle style) {
  return static_cast<int>(std::ranges::count(panel.series, style, &Series::style));
}

TEST(FitFigures, ShowEveryLoopMeasuredAndFitted) {
  const std::optional<Figure> figure = figure_loops(mock_fit(), Axis::x);
  ASSERT_TRUE(figure);
  for (const Panel& panel : figure->panels) {
    EXPECT_EQ(count(panel, SeriesStyle::points), 1) << panel.title;
    EXPECT_EQ(count(panel, SeriesStyle::line), 1) << panel.title;
    for (const Series& series : panel.series) EXPECT_FALSE(series.x.empty()) << panel.title;
  }
}

TEST(FitFigures, PutMeasuredPointsBesideEveryFittedLineAndNameTheGroupsOnce) {
  const std::optional<Figure> figure = figure_dynamic_stiffness(mock_fit(), Axis::x);
  ASSERT_TRUE(figure);
  bool named = false;
  for (const Panel& panel : figure->panels) {
    EXPECT_EQ(count(panel, SeriesStyle::points), count(panel, SeriesStyle::line)) << panel.title;
    EXPECT_GT(count(panel, SeriesStyle::points), 0) << panel.title;
    for (const Series& series : panel.series) {
      EXPECT_FALSE(series.x.empty()) << panel.title;
      named = named || !series.name.empty();
    }
  }
  EXPECT_TRUE(named);
}

}  // namespace
}  // namespace grouser
