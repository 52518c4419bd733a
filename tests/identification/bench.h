#pragma once
#include <cmath>
#include <string>
#include <vector>

#include "model/rig.h"
#include "test_data/generator/campaign.h"

namespace grouser {

/// A rig in memory that runs the reference campaign's rubber; tests bend what they need.
struct Bench {
  std::vector<AxisCampaign> campaign = reference_campaign();

  [[nodiscard]] const AxisCampaign& axis(Axis a) const { return campaign[static_cast<std::size_t>(index_of(a))]; }
  [[nodiscard]] const PlannedTest& plan(Axis a, const std::string& name) const;
  /// Measured record of a planned test, with the errors of its axis or with others.
  [[nodiscard]] RigTest measure(Axis a, const std::string& name) const;
  [[nodiscard]] RigTest measure(Axis a, const std::string& name, const RigErrors& errors) const;
};

[[nodiscard]] RigTest as_rig_test(const GeneratedTest& generated);
[[nodiscard]] RigRecord record_of(std::vector<RigTest> tests);

/// A sinusoid x with the force of a given function of (x, x_dot).
template <typename Force>
[[nodiscard]] RigTest sine_test(double amplitude, double frequency, int cycles, int samples_per_cycle, Force force) {
  RigTest test;
  test.name = "sine";
  test.frequency = frequency;
  test.time_measured = true;
  for (int i = 0; i <= cycles * samples_per_cycle; ++i) {
    const double t = i / (frequency * samples_per_cycle), phase = 2.0 * 3.14159265358979323846 * frequency * t;
    const double x = amplitude * std::sin(phase),
                 rate = amplitude * 2.0 * 3.14159265358979323846 * frequency * std::cos(phase);
    test.time.push_back(t);
    test.displacement.push_back(x);
    test.force.push_back(force(x, rate));
  }
  return test;
}

}  // namespace grouser
