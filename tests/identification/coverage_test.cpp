// Stated 95 % intervals hold the truth of rubbers that nobody has seen before. The full count is coverage_benchmark's.
#include "tests/identification/coverage.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace grouser {
namespace {

constexpr int k_seeds = 20;

const std::vector<SeedCoverage>& seeds() {
  static const std::vector<SeedCoverage> result = [] {
    std::vector<SeedCoverage> all;
    for (std::uint64_t seed = 6000; seed < 6000 + k_seeds; ++seed) all.push_back(coverage_of_seed(seed));
    return all;
  }();
  return result;
}

template <typename Of>
double median(const Of& of) {
  std::vector<double> values;
  for (const SeedCoverage& seed : seeds()) values.push_back(of(seed));
  std::ranges::sort(values);
  return values.at(k_seeds / 2);
}

TEST(Coverage, OfEveryFamilyIsHonestAndNarrow) {
  for (std::size_t f = 0; f < k_coverage_families.size(); ++f) {
    Coverage sum;
    for (const SeedCoverage& seed : seeds()) sum.add(seed.families[f]);
    // Bar of the full count: 90 %. Quantities of one rubber share its tests' gains, so a seed is worth about three
    // independent ones; two binomial deviations of 60 at 90 % are 8 %.
    EXPECT_GE(sum.fraction(), 0.90 - 0.08) << k_coverage_families[f].name;
    const double bar = k_coverage_families[f].half_width_bar;
    if (bar > 0.0) {
      EXPECT_LE(sum.mean_half_width(), bar) << k_coverage_families[f].name;
    }
  }
}

TEST(Recovery, OfTheTruthIsWithinItsBarsInTheMedian) {
  EXPECT_LE(median([](const SeedCoverage& seed) { return seed.worst_energy; }), 0.02);
  EXPECT_LE(median([](const SeedCoverage& seed) { return seed.worst_storage_stiffness; }), 0.015);
  EXPECT_LE(median([](const SeedCoverage& seed) { return seed.worst_tangent; }), 0.02);
}

}  // namespace
}  // namespace grouser
