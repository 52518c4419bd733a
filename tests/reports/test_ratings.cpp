#include "reports/ratings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>

#include "reports/rating_limits.h"

namespace grouser {
namespace {

using std::numbers::pi;

std::vector<double> sampled(std::size_t n, double step, const std::function<double(double)>& curve) {
  std::vector<double> values(n);
  for (std::size_t i = 0; i < n; ++i) values[i] = curve(step * static_cast<double>(i));
  return values;
}
/// Ten whole periods of a sine, 1000 samples each.
std::vector<double> sine(double amplitude, double phase) {
  return sampled(10000, 1e-3, [=](double t) { return amplitude * std::sin(2.0 * pi * t - phase); });
}
/// The wave form of T. Geers by which such measures are usually shown, from time 0.14 on.
double decaying(double t, double amplitude, double decay, double frequency) {
  const double since = t - 0.14;
  return since < 0.0 ? 0.0 : amplitude * std::exp(-decay * since) * std::sin(2.0 * pi * frequency * since);
}

TEST(Ratings, AreTheSameToTheLastBitWhereverACurveLies) {
  const auto noisy = [random = std::mt19937(7)](double) mutable { return 40.0 + std::normal_distribution()(random); };
  const std::vector<double> reference = sampled(401, 1.0, noisy), other = sampled(401, 1.0, noisy);
  const Ratings first = rate(reference, other, 1e-3);
  std::vector<double> moved(reference.size() + 8);
  for (std::size_t offset = 0; offset < 8; ++offset) {
    std::copy(reference.begin(), reference.end(), moved.begin() + static_cast<std::ptrdiff_t>(offset));
    const Ratings again = rate(std::span(moved).subspan(offset, reference.size()), other, 1e-3);
    EXPECT_EQ(again.correlation, first.correlation) << offset;
    EXPECT_EQ(again.rmse, first.rmse) << offset;
    EXPECT_EQ(again.sprague_geers->phase, first.sprague_geers->phase) << offset;
  }
}

TEST(Ratings, EqualCurvesAreAlikeInEveryMeasure) {
  const Ratings ratings = rate(sine(3.0, 0.4), sine(3.0, 0.4), 1e-3);
  EXPECT_DOUBLE_EQ(ratings.iso->overall(), 1.0);
  EXPECT_EQ(ratings.rmse, 0.0);
  EXPECT_EQ(ratings.nrmse, 0.0);
  EXPECT_NEAR(*ratings.correlation, 1.0, 1e-12);
  EXPECT_EQ(ratings.peak_ratio, 1.0);
  EXPECT_EQ(ratings.lag, 0.0);
  EXPECT_NEAR(ratings.sprague_geers->magnitude, 0.0, 1e-15);
  EXPECT_NEAR(ratings.sprague_geers->phase, 0.0, 1e-7);  // acos near 1 loses half the digits
}

// M is the scale less one whatever the timing, P the angle over pi whatever the scale.
TEST(Ratings, SpragueAndGeersTellSizeFromTiming) {
  for (const double scale : {0.5, 0.9, 1.3})
    for (const double angle : {0.1, 1.0, 2.5}) {
      const SpragueGeers found = sprague_geers(sine(2.0, 0.0), sine(scale * 2.0, angle));
      EXPECT_NEAR(found.magnitude, scale - 1.0, 1e-12);
      EXPECT_NEAR(found.phase, angle / pi, 1e-12);
      EXPECT_NEAR(found.combined(), std::hypot(scale - 1.0, angle / pi), 1e-12);
    }
  EXPECT_NEAR(sprague_geers(sine(1.0, 0.0), sine(1.0, pi)).phase, 1.0, 1e-7);
}

// Of sines of one frequency: rms of the difference, sqrt(2) A sin(angle / 2), over a range of 2 A; cos(angle).
TEST(Ratings, ErrorAndCorrelationOfAShiftedSine) {
  const double angle = 0.7;
  const Ratings ratings = rate(sine(2.0, 0.0), sine(2.0, angle), 1e-3);
  EXPECT_NEAR(ratings.rmse, 2.0 * std::numbers::sqrt2 * std::sin(0.5 * angle), 1e-12);
  EXPECT_NEAR(*ratings.nrmse, std::numbers::sqrt2 * std::sin(0.5 * angle) / 2.0, 1e-12);
  EXPECT_NEAR(*ratings.correlation, std::cos(angle), 1e-12);
}

TEST(Ratings, PeaksAreComparedByTheirSize) {
  EXPECT_NEAR(*rate(sine(2.0, 0.0), sine(-2.6, 0.0), 1e-3).peak_ratio, 1.3, 1e-12);
}

// Constant distances from a reference of 10: full score up to 0.5, none from 5 on, the square of what is left between.
TEST(Ratings, TheCorridorIsFivePercentAndFiftyPercentOfTheLargestValue) {
  const std::vector<double> reference(100, 10.0);
  for (const auto& [distance, score] : {std::pair{0.49, 1.0}, {-0.49, 1.0}, {2.75, 0.25}, {-4.1, 0.04}, {5.0, 0.0}})
    EXPECT_NEAR(corridor_score(reference, std::vector<double>(100, 10.0 + distance)), score, 1e-12) << distance;
}

TEST(Ratings, TheLargestValueOfTheCorridorMayBeNegative) {
  const std::vector<double> reference{-10.0, 1.0}, other{-10.0, 3.75};
  EXPECT_NEAR(corridor_score(reference, other), 0.5 * (1.0 + 0.25), 1e-12);
}

// A pulse in a record of 1000 samples, moved by so many of them: the phase loses n / 200.
TEST(Ratings, AShiftIsFoundWithItsSign) {
  const auto pulse = [](double at) {
    return sampled(1000, 1e-3, [=](double t) { return std::exp(-std::pow((t - at) / 0.05, 2)); });
  };
  for (const int shift : {-150, -40, 0, 7, 60, 199}) {
    const Ratings ratings = rate(pulse(0.5), pulse(0.5 + 1e-3 * shift), 1e-3);
    EXPECT_NEAR(*ratings.lag, 1e-3 * shift, 1e-12);
    EXPECT_NEAR(ratings.iso->phase, 1.0 - std::abs(shift) / 200.0, 1e-12);
  }
}

TEST(Ratings, OfShiftsThatAreEquallyGoodTheSmallestIsTaken) {
  const std::vector<double> square{1, 1, -1, -1, 1, 1, -1, -1, 1, 1, -1, -1, 1, 1, -1, -1, 1, 1, -1, -1};
  std::vector<double> later(square);
  std::ranges::rotate(later, later.end() - 1);
  EXPECT_EQ(best_shift(square, later, 6), 1);
  EXPECT_EQ(best_shift(square, square, 6), 0);
}

// A scaled curve on the same slopes: e = 0.2 sum |T'| / sum |T'|.
TEST(Ratings, TheSlopeLosesHalfOfItsRelativeError) {
  EXPECT_NEAR(slope_score(sine(1.0, 0.3), sine(1.2, 0.3)), 0.9, 1e-12);
  EXPECT_NEAR(slope_score(sine(1.0, 0.3), sine(-1.0, 0.3)), 0.0, 1e-12);
}

/// Least cost over all paths, by trying them.
double least_cost(const std::vector<double>& a, const std::vector<double>& b, std::size_t i, std::size_t j,
                  std::size_t radius) {
  if ((i > j ? i - j : j - i) >= radius) return std::numeric_limits<double>::infinity();
  const double cost = std::pow(a[i] - b[j], 2);
  if (i == 0 && j == 0) return cost;
  double least = std::numeric_limits<double>::infinity();
  if (i > 0) least = std::min(least, least_cost(a, b, i - 1, j, radius));
  if (j > 0) least = std::min(least, least_cost(a, b, i, j - 1, radius));
  if (i > 0 && j > 0) least = std::min(least, least_cost(a, b, i - 1, j - 1, radius));
  return cost + least;
}

TEST(Ratings, TheWarpingPathIsTheCheapestInItsWindow) {
  std::mt19937 random(11);
  std::uniform_int_distribution<int> value(-3, 3);
  for (int round = 0; round < 40; ++round) {
    std::vector<double> reference(7), other(7);
    for (double& v : reference) v = value(random);
    for (double& v : other) v = value(random);
    for (const std::size_t radius : {1u, 2u, 4u, 7u}) {
      const auto path = warping_path(reference, other, radius);
      EXPECT_EQ(path.front(), (std::pair<std::size_t, std::size_t>{0, 0}));
      EXPECT_EQ(path.back(), (std::pair<std::size_t, std::size_t>{6, 6}));
      double cost = 0.0;
      for (std::size_t k = 0; k < path.size(); ++k) {
        const auto [i, j] = path[k];
        cost += std::pow(other[i] - reference[j], 2);
        EXPECT_LT(i > j ? i - j : j - i, radius);
        if (k == 0) continue;
        const auto [before_i, before_j] = path[k - 1];
        EXPECT_TRUE(i - before_i <= 1 && j - before_j <= 1 && i + j > before_i + before_j);
      }
      EXPECT_DOUBLE_EQ(cost, least_cost(other, reference, 6, 6, radius));
    }
  }
}

/// Scores of one pair.
struct Expected {
  std::function<double(double)> other;
  double corridor, phase, magnitude, slope, overall;
  std::ptrdiff_t shift;
};

// 401 samples over 2 s against the wave form of Geers; worked out apart from this program with NumPy (corrcoef of the
// shifted slices, gradient, convolve, a full table for the warping), agreement to what the table was printed with.
TEST(Ratings, AgreesWithAnIndependentComputationOfTheIsoRating) {
  const auto reference = sampled(401, 0.005, [](double t) { return decaying(t, 1.0, 1.0, 1.0); });
  const std::vector<Expected> table{
      {[](double t) { return decaying(t, 1.2, 1.0, 1.0); }, 0.8788157693, 1.0, 0.8841440744, 0.9, 0.9083551226, 0},
      {[](double t) { return decaying(t, 1.0, 1.0 / 1.2, 0.8); }, 0.3718391708, 0.7132169576, 0.8514390949,
       0.6675644016, 0.5951797591, 23},
      {[](double t) { return decaying(t, 1.0, 1.0 / 0.8, 1.2); }, 0.4397651357, 0.8004987531, 0.8758848412,
       0.6779245800, 0.6467676892, -16},
      {[](double t) { return decaying(t - 0.05, 0.9, 1.0, 1.0) + 0.03 * std::cos(40.0 * t); }, 0.7614877149,
       0.8753117207, 0.9455038431, 0.7992131457, 0.8286008278, 10}};
  for (const Expected& expected : table) {
    const IsoRating found = *rate(reference, sampled(401, 0.005, expected.other), 0.005).iso;
    EXPECT_NEAR(found.corridor, expected.corridor, 1e-9);
    EXPECT_NEAR(found.phase, expected.phase, 1e-9);
    EXPECT_NEAR(found.magnitude, expected.magnitude, 1e-9);
    EXPECT_NEAR(found.slope, expected.slope, 1e-9);
    EXPECT_NEAR(found.overall(), expected.overall, 1e-9);
    EXPECT_EQ(found.shift, expected.shift);
  }
}

TEST(Ratings, ACurveThatStandsStillHasNoShape) {
  const std::vector<double> flat(50, 4.0), moving = sampled(50, 0.1, [](double t) { return std::sin(t); });
  const Ratings against_flat = rate(flat, moving, 0.1), of_flat = rate(moving, flat, 0.1);
  EXPECT_FALSE(against_flat.iso || against_flat.nrmse || against_flat.correlation);
  EXPECT_TRUE(against_flat.peak_ratio && against_flat.sprague_geers);
  EXPECT_FALSE(of_flat.iso || of_flat.correlation);
  EXPECT_TRUE(of_flat.nrmse);
  EXPECT_FALSE(rate(std::vector<double>(50, 0.0), moving, 0.1).sprague_geers);
}

TEST(Ratings, GradesBeginAboveTheirBounds) {
  for (const auto& [rating, grade] : {std::pair{0.941, "excellent"}, {0.94, "good"}, {0.80, "fair"}, {0.58, "poor"}})
    EXPECT_STREQ(iso_grade(rating), grade);
}

TEST(RatingLimits, AreSetByNameInTheirUnits) {
  RatingLimits limits;
  EXPECT_EQ(limits.of("iso"), 0.80);
  EXPECT_EQ(limits.of("lag"), std::nullopt);
  limits.set("iso=0,6");
  limits.set("lag_ms=20");
  limits.set("correlation=none");
  EXPECT_EQ(limits.of("iso"), 0.6);
  EXPECT_DOUBLE_EQ(limits.of("lag").value(), 0.02);
  EXPECT_EQ(limits.of("correlation"), std::nullopt);
}

TEST(RatingLimits, SayWhatIsWrongWithThem) {
  RatingLimits limits;
  for (const auto& [assignment, word] : {std::pair{"isso=3", "did you mean iso?"},
                                         {"iso", "iso=NUMBER"},
                                         {"iso=-1", "at least 0"},
                                         {"iso=much", "iso=NUMBER"},
                                         {"lag=3", "with its unit"},
                                         {"lag_m=3", "a unit of time"}}) {
    try {
      limits.set(assignment);
      FAIL() << assignment;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace grouser
