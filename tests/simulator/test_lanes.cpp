#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "simulator/lanes.h"

/// Built twice, with AVX-512's own instructions and without them.
namespace grouser::test {
namespace {

const double k_nan = std::nan("");

Lanes random_lanes(std::mt19937& random, double reach) {
  std::uniform_real_distribution<double> uniform(-reach, reach);
  Lanes x;
  for (int lane = 0; lane < k_lanes; ++lane) x.set(lane, uniform(random));
  return x;
}

TEST(Lanes, DoInEveryLaneWhatNumbersDo) {
  std::mt19937 random(20261122);
  for (int n = 0; n < 1000; ++n) {
    const Lanes a = random_lanes(random, 4.0), b = random_lanes(random, 4.0);
    const Lanes sum = a + b, least = a.min(b), largest = a.max(b), root = a.abs().sqrt();
    double total = 0.0, peak = -INFINITY, low = INFINITY;
    for (int lane = 0; lane < k_lanes; ++lane) {
      const double x = a[lane], y = b[lane];
      ASSERT_EQ(sum[lane], x + y);
      ASSERT_EQ((a * b)[lane], x * y);
      ASSERT_EQ((2.0 / a)[lane], 2.0 / x);
      ASSERT_EQ(least[lane], std::min(x, y));
      ASSERT_EQ(largest[lane], std::max(x, y));
      ASSERT_EQ(root[lane], std::sqrt(std::abs(x)));
      ASSERT_EQ(a.rint()[lane], std::rint(x));
      ASSERT_EQ(a.floor()[lane], std::floor(x));
      ASSERT_EQ(choose(a < b, a, b)[lane], std::min(x, y));
      ASSERT_EQ(bits_of(a <= b) >> lane & 1u, x <= y ? 1u : 0u);
      total += x;
      peak = std::max(peak, x);
      low = std::min(low, x);
    }
    ASSERT_NEAR(a.sum(), total, 1e-14);
    ASSERT_EQ(a.max_lane(), peak);
    ASSERT_EQ(a.min_lane(), low);
  }
  EXPECT_EQ(Lanes(2.5).rint()[3], 2.0);  // halves to the even number
}

TEST(Lanes, SumTheSameInBothHalvesOfAMirror) {
  // A sum must not depend on what stands in lanes that hold zeros, or a mirrored vehicle would not stay mirrored.
  std::mt19937 random(7);
  const Lanes x = random_lanes(random, 1.0);
  EXPECT_EQ(x.sum(), -(-x).sum());
}

TEST(LaneMask, SaysYesLaneByLane) {
  Lanes x, y;
  for (int lane = 0; lane < k_lanes; ++lane) x.set(lane, lane), y.set(lane, 7 - lane);
  EXPECT_EQ(bits_of(x < y), 0b00001111u);
  EXPECT_EQ(bits_of(x > y), 0b11110000u);
  EXPECT_EQ(bits_of(x <= 4.0), 0b00011111u);
  EXPECT_EQ(bits_of((!(x < y)) & LaneMask::first(6)), 0b00110000u);
  EXPECT_EQ(bits_of((x < y) | LaneMask::first(6)), 0b00111111u);
  EXPECT_EQ(bits_of(LaneMask::first(0)), 0u);
  EXPECT_EQ(bits_of(LaneMask::first(76)), k_all_lanes);
  EXPECT_EQ(bits_of(k_nan < x), 0u);  // what is not a number is not less
  EXPECT_EQ(bits_of(k_nan <= x), 0u);
}

TEST(LaneTable, FindsTheRowOfEveryPlace) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> gap(0.1, 1.0);
  for (std::size_t size : {1u, 2u, 7u, 8u, 9u, 15u, 16u, 17u, 31u, 33u, 100u}) {
    std::vector<std::array<double, 3>> rows;
    double begin = -0.3 * static_cast<double>(size);
    for (std::size_t i = 0; i < size; ++i) {
      rows.push_back({begin, static_cast<double>(i), 1.0 / (1.0 + static_cast<double>(i))});
      begin += gap(random);
    }
    const LaneTable<3> table(rows);
    const auto row_at = [&](double x) {
      std::size_t row = 0;
      while (row + 1 < size && rows[row + 1][0] <= x) ++row;
      return rows[row];
    };
    const auto expect_rows = [&](const Lanes& x) {
      const std::array<Lanes, 3> found = table.at(x);
      for (int lane = 0; lane < k_lanes; ++lane) {
        const auto row = row_at(x[lane]);
        for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(found[c][lane], row[c]) << size << " rows at " << x[lane];
      }
    };
    for (int n = 0; n < 200; ++n) expect_rows(random_lanes(random, static_cast<double>(size)));
    for (const auto& row : rows) expect_rows(row[0]);  // a row begins where it says
  }
}

}  // namespace
}  // namespace grouser::test
