#include <gtest/gtest.h>

#include <cmath>

#include "reports/number_text.h"

namespace grouser {
namespace {

TEST(NumberText, KeepsTheAskedDigits) {
  EXPECT_EQ(number_text(13.982), "13.98");
  EXPECT_EQ(number_text(13.982, 3), "14.0");  // the zero is a digit
  EXPECT_EQ(number_text(17.0, 3), "17");      // here it would be padding
  EXPECT_EQ(number_text(0.0), "0");
}

TEST(NumberText, WritesATrueMinusAndPowersOfTen) {
  EXPECT_EQ(number_text(-2.5), "−2.5");
  EXPECT_EQ(number_text(8.1e-5, 3), "8.1 × 10⁻⁵");
  EXPECT_EQ(number_text(-1.5e9, 3), "−1.5 × 10⁹");
}

TEST(NumberText, SaysWhenThereIsNoNumber) { EXPECT_EQ(number_text(std::nan("")), "–"); }

TEST(NumberText, GroupsLongNumbers) {
  EXPECT_EQ(count_text(954), "954");
  EXPECT_EQ(count_text(8127), "8127");
  EXPECT_EQ(count_text(151234), "151\u202f234");
  EXPECT_EQ(count_text(-1234567), "−1\u202f234\u202f567");
}

TEST(NumberText, SignsAChangeButNotARoundedZero) {
  EXPECT_EQ(signed_percent_text(0.0123), "+1.2 %");
  EXPECT_EQ(signed_percent_text(-0.0123, 2), "−1.23 %");
  EXPECT_EQ(signed_percent_text(-0.0004), "0.0 %");
  EXPECT_EQ(signed_percent_text(std::nan("")), "–");
  EXPECT_EQ(fixed_percent_text(0.05, 2), "5.00 %");
}

TEST(QuantityText, TakesThePrefixThatFits) {
  EXPECT_EQ(quantity_text(178800.0, "N"), "178.8 kN");
  EXPECT_EQ(quantity_text(-42.0, "N"), "−42 N");
  EXPECT_EQ(quantity_text(1.13e-4, "s", 3), "113 µs");
  EXPECT_EQ(quantity_text(0.007, "m", 2), "7 mm");
  EXPECT_EQ(quantity_text(1e8, "N/m"), "100 kN/mm");
  EXPECT_EQ(quantity_text(1.2, "rad/s"), "1.2 rad/s");
  EXPECT_EQ(quantity_text(0.25, "1"), "0.25");
}

TEST(QuantityText, WritesRoundOffAsZero) {
  EXPECT_EQ(quantity_text(1.87e-18, "m"), "0 m");
  EXPECT_EQ(quantity_text(-3e-12, "N"), "0 N");
  EXPECT_EQ(quantity_text(2e-8, "m", 2), "0.02 µm");
  EXPECT_EQ(quantity_text(1e-12, "1", 2), "1.0 × 10⁻¹²");  // a ratio may be that small
}

TEST(QuantityText, RoundsBeforeItChoosesThePrefix) { EXPECT_EQ(quantity_text(999.97, "N", 4), "1.000 kN"); }

}  // namespace
}  // namespace grouser
