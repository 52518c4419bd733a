#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "test_data/generator/random_campaign.h"

namespace grouser {

/// How often stated 95 % intervals hold the truth, and how wide they are.
struct Coverage {
  int stated = 0, held = 0;
  double sum_half_width = 0.0;  ///< each relative to the truth; of the backbone, to half its force range

  void add(bool holds, double half_width);
  void add(const Coverage& other);
  [[nodiscard]] double fraction() const { return static_cast<double>(held) / stated; }
  [[nodiscard]] double mean_half_width() const { return sum_half_width / stated; }
};

/// What is counted together, with the bar of its mean half width (0: none).
struct CoverageFamily {
  const char* name;
  double half_width_bar;
};
inline constexpr std::array k_coverage_families{CoverageFamily{"energy", 0.015}, CoverageFamily{"loss factor", 0.0},
                                                CoverageFamily{"storage stiffness", 0.0},
                                                CoverageFamily{"backbone", 0.015}, CoverageFamily{"tangent", 0.03}};

/// A random rubber's campaign identified and held against the truth.
struct SeedCoverage {
  /// Every quantity ("energy at 0.05 mm", "backbone, station 1 of 5", ...) with the family that it belongs to.
  std::map<std::string, Coverage> quantities;
  std::array<Coverage, k_coverage_families.size()> families;
  OutsideMechanism outside = OutsideMechanism::none;
  /// Of the fitted law: largest relative error over the 25 cells, and of the tangent over its stations.
  double worst_energy = 0.0, worst_storage_stiffness = 0.0, worst_tangent = 0.0;
};

/// Intervals that are looked at: energy at .05, .2 and 1 mm (any frequency), loss factor at .1, 5 and 70 Hz (any
/// amplitude), storage stiffness everywhere, backbone at five stations about its own mean, tangent at five stations.
[[nodiscard]] SeedCoverage coverage_of_seed(std::uint64_t seed);

}  // namespace grouser
