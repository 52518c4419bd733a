#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "identification/axis_problem.h"
#include "identification/evaluate_fit.h"
#include "model/rig.h"
#include "test_data/generator/rubber.h"

namespace grouser {

/// Force noise as a fraction of a test's force range.
inline constexpr double k_law_noise = 0.002;

/// Force of a known law along a path, with noise, as a rig would record it.
[[nodiscard]] inline RigTest record_law(const AxisLaw& law, Axis axis, std::string name, std::vector<double> time,
                                        std::vector<double> displacement, std::uint64_t seed) {
  RigTest test;
  test.name = std::move(name);
  test.axis = axis;
  test.time = std::move(time);
  test.displacement = std::move(displacement);
  test.time_measured = true;
  test.force = replay(law, test.time, test.displacement);
  const auto [low, high] = std::ranges::minmax(test.force);
  PortableRandom random(seed);
  for (double& force : test.force) force += k_law_noise * (high - low) * random.normal();
  return test;
}

[[nodiscard]] inline RigTest loop_of(const AxisLaw& law, Axis axis, double amplitude, double frequency,
                                     std::uint64_t seed, int samples_per_cycle = 200) {
  std::vector<double> time, x;
  for (int i = 0; i <= 6 * samples_per_cycle; ++i) {
    time.push_back(i / (frequency * samples_per_cycle));
    x.push_back(amplitude * std::sin(2.0 * std::numbers::pi * i / samples_per_cycle));
  }
  RigTest test = record_law(law, axis, "loop " + std::to_string(seed), std::move(time), std::move(x), seed);
  test.frequency = frequency;
  return test;
}

/// Six symmetric slow ramps.
[[nodiscard]] inline RigTest ramp_of(const AxisLaw& law, Axis axis, double amplitude, double period, std::uint64_t seed,
                                     int samples_per_cycle = 800) {
  std::vector<double> time, x;
  for (int i = 0; i <= 6 * samples_per_cycle; ++i) {
    const double phase = static_cast<double>(i) / samples_per_cycle;
    time.push_back(period * phase);
    x.push_back(amplitude * 2.0 / std::numbers::pi * std::asin(std::sin(2.0 * std::numbers::pi * phase)));
  }
  RigTest test = record_law(law, axis, "ramp", std::move(time), std::move(x), seed);
  test.kind = TestKind::static_ramp;
  test.rate = 4.0 * amplitude / period;
  return test;
}

/// A campaign as fit_axis() sees it; the tests must stay where they are.
struct LawCampaign {
  RigRecord rig;
  std::vector<PreparedTest> tests;
  AxisData data;

  explicit LawCampaign(std::vector<RigTest> records) {
    rig.tests = std::move(records);
    std::vector<FitWarning> warnings;
    std::vector<AppliedCorrection> corrections;
    for (const RigTest& test : rig.tests) tests.push_back(prepare_test(test, rig, warnings, corrections));
    std::vector<const PreparedTest*> usable;
    for (const PreparedTest& test : tests) {
      if (test.unusable.empty()) usable.push_back(&test);
    }
    data = gather(usable);
  }
  LawCampaign(const LawCampaign&) = delete;
  LawCampaign& operator=(const LawCampaign&) = delete;
};

}  // namespace grouser
