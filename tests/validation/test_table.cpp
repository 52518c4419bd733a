#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/validation/table.h"

namespace grouser::validation {
namespace {

Chapter chapter_with(const Row& row) {
  Chapter chapter("Springs");
  chapter.section("Pulled", "One spring.");
  chapter.add(row);
  return chapter;
}
const Row k_row{"force | pull", "N", 2.0, 2.001, within(0.01, "round-off"), "closed form: k x"};

TEST(ValidationRow, PassesWithinItsLimitOnly) {
  Row row = k_row;
  EXPECT_TRUE(row.passes());
  row.measured = 2.02;
  EXPECT_FALSE(row.passes());
  row.limit = fraction(0.01, -2.0, "a tenth of a digit");  // the size counts, not the sign
  EXPECT_NEAR(row.error(), 0.01, 1e-15);
  row.measured = 2.021;
  EXPECT_FALSE(row.passes());
}

TEST(ValidationRow, NothingMeasuredIsAFailure) {
  Row row = k_row;
  row.measured = std::nan("");
  EXPECT_FALSE(row.passes());
  EXPECT_THAT(chapter_with(row).failures(), testing::SizeIs(1));
  const Worst found = worst_of(Eigen::Vector2d(1.0, std::nan("")), Eigen::Vector2d(1.0, 2.0));
  EXPECT_TRUE(std::isnan(found.measured));
  EXPECT_TRUE(std::isnan(worse({1.0, 5.0}, found).measured));
}

TEST(ValidationChapter, IsReadBackRowByRow) {
  const std::string document = "# Validation\n\n## Before\n\n" + chapter_with(k_row).text() + "\n## After\n\nrest\n";
  EXPECT_EQ(chapter_in(document, "Springs"), chapter_with(k_row).text());
  EXPECT_THAT(rows_in(document, "Springs"), testing::ElementsAre("force \\| pull; limit 0.01 N (round-off)"));
  EXPECT_THAT(rows_in(document, "After"), testing::IsEmpty());
  EXPECT_THAT(rows_in(document, "Dampers"), testing::IsEmpty());
}

TEST(ValidationChapter, TellsDigitsFromLimits) {
  Row other = k_row;
  other.measured = 2.002;
  const auto rows = [](const Row& row) { return rows_in("\n" + chapter_with(row).text(), "Springs"); };
  EXPECT_EQ(rows(other), rows(k_row));
  other.limit.error = 0.02;
  EXPECT_NE(rows(other), rows(k_row));
}

}  // namespace
}  // namespace grouser::validation
