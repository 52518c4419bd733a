#include "identification/signal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace grouser {
namespace {

constexpr double k_pi = std::numbers::pi;

TEST(FindCycles, CountsEveryTurnOfASine) {
  std::vector<double> x;
  for (int i = 0; i <= 9 * 150; ++i) x.push_back(std::sin(2.0 * k_pi * i / 150.0));
  const auto cycles = find_cycles(x);
  ASSERT_EQ(cycles.size(), 9u);
  for (std::size_t k = 0; k < 9; ++k) {
    EXPECT_NEAR(static_cast<double>(cycles[k].begin), 150.0 * static_cast<double>(k), 1.0);
    EXPECT_NEAR(static_cast<double>(cycles[k].end), 150.0 * static_cast<double>(k + 1), 1.0);
  }
}

TEST(FindCycles, SurvivesPreloadDriftNoiseAndAnAmplitudeStep) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 0.01);
  std::vector<double> x;
  for (int i = 0; i <= 12 * 150; ++i) {
    const double amplitude = i < 6 * 150 ? 1.0 : 4.0;
    x.push_back(7.0 + 3e-4 * i + amplitude * std::sin(2.0 * k_pi * i / 150.0) + noise(random));
  }
  EXPECT_EQ(find_cycles(x).size(), 12u);
}

TEST(FindCycles, CutsARampWhereItTurns) {
  std::vector<double> x;
  for (int i = 0; i <= 3 * 200; ++i) x.push_back(1.0 - std::abs(1.0 - (i % 200) / 100.0));
  const auto cycles = find_cycles(x);
  ASSERT_EQ(cycles.size(), 3u);
  EXPECT_EQ(cycles[1].begin, 200u);
  EXPECT_EQ(cycles[1].end, 400u);
}

TEST(FindCycles, FindsNoneInARampThatDoesNotReturn) {
  std::vector<double> x;
  for (int i = 0; i < 500; ++i) x.push_back(0.01 * i);
  EXPECT_TRUE(find_cycles(x).empty());
}

TEST(NoiseLevel, IsThatOfTheNoiseUnderASmoothSignal) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 0.02);
  std::vector<double> x;
  for (int i = 0; i < 4000; ++i) x.push_back(5.0 * std::sin(2.0 * k_pi * i / 150.0) + noise(random));
  EXPECT_NEAR(noise_level(x), 0.02, 0.002);  // a median of 4000 correlated values: some per cent
}

TEST(Smooth, KeepsACubicAndQuietsNoise) {
  std::vector<double> cubic, quiet;
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 1.0);
  for (int i = 0; i < 400; ++i) {
    cubic.push_back(1.0 + i * (0.2 + i * (0.01 - 1e-5 * i)));
    quiet.push_back(noise(random));
  }
  const std::vector<double> kept = smooth(cubic, 15);
  for (std::size_t i = 0; i < 400; ++i) EXPECT_NEAR(kept[i], cubic[i], 1e-9 * (1.0 + std::abs(cubic[i])));
  EXPECT_NEAR(noise_level(smooth(quiet, 15)), 0.0, 0.25);
}

TEST(FitSine, MeasuresFrequencyUnderOffsetAndDrift) {
  std::vector<double> t, x;
  for (int i = 0; i <= 1350; ++i) {
    t.push_back(i / 150.0 / 5.08);
    x.push_back(3.0 + 0.2 * t.back() + 0.5 * std::sin(2.0 * k_pi * 5.08 * t.back() + 0.3));
  }
  const SineFit fit = fit_sine(t, x, {0, 1350}, 5.0);
  EXPECT_NEAR(fit.frequency, 5.08, 1e-8);
  EXPECT_NEAR(fit.amplitude, 0.5, 1e-8);
  EXPECT_LT(fit.relative_residual, 1e-8);
}

}  // namespace
}  // namespace grouser
