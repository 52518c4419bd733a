#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <random>
#include <sstream>

#include "simulator/results.h"
#include "simulator/simulate.h"
#include "simulator/track_watch.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/vehicle_scene.h"

/// Whole runs through simulate(), and what watches them.
namespace grouser::test {
namespace {

/// run_a or run_b of test_data on rubber_bushing(), with a quick assembly.
Scenario short_run(const TemporaryFolder& folder, const std::string& name, std::map<std::string, std::string> set) {
  write_bushing(rubber_bushing(), folder / "bushing.json");
  set.emplace("assembly.settle_time_s", "3");
  ScenarioOverrides overrides;
  overrides.bushing_file = (folder / "bushing.json").string();
  overrides.set = std::move(set);
  return read_scenario(GROUSER_SOURCE_DIR "/test_data/scenarios/" + name, overrides);
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ostringstream all;
  all << std::ifstream(file, std::ios::binary).rdbuf();
  return all.str();
}

TEST(Run, TheSameInputGivesTheSameBytes) {
  const TemporaryFolder folder;
  const Scenario scenario = short_run(folder, "run_a.json", {{"duration_s", "0.05"}});
  for (const char* name : {"first", "second"}) {
    EXPECT_EQ(simulate(scenario, folder / name).status, RunStatus::completed);
  }
  const std::string first = bytes_of(folder / "first/run.h5"), second = bytes_of(folder / "second/run.h5");
  EXPECT_GT(first.size(), 10000u);
  EXPECT_TRUE(first == second);
}

TEST(Run, ATrackThatLeavesItsGuideEndsTheRunWithWhereAndWhen) {
  // Without the walls of guide and teeth the steered left track walks off sideways (P 4).
  const TemporaryFolder folder;
  const Scenario scenario = short_run(folder, "run_b.json",
                                      {{"duration_s", "2"},
                                       {"vehicle./left/track/link/guide/stiffness_N_per_m", "1e3"},
                                       {"vehicle./left/sprocket/side_stiffness_N_per_m", "1e3"}});
  const RunSummary summary = simulate(scenario, folder / "run");
  EXPECT_EQ(summary.status, RunStatus::failed);
  EXPECT_NE(summary.message.find("left track thrown at 0."), std::string::npos) << summary.message;
  EXPECT_LT(summary.simulated_time, 1.0);  // long before it would blow up
  // What was computed is kept, and says the same.
  EXPECT_EQ(read_run_summary(folder / "run/run.json").status, RunStatus::failed);
  EXPECT_GT(RunReader(folder / "run/run.h5").read("/time").rows(), 40u);
}

TEST(ToothCounter, SeesAJumpOfOneToothAndNoneInTheDrive) {
  const System system = driven(9.0, 9.0);
  const auto& rest = reference_scene().rest;
  Stepper stepper(system, rest.state, rest.knobs);
  ToothCounter counter(system, stepper.state(), Side::left);
  while (stepper.state().time < 0.5) {  // two teeth
    ASSERT_EQ(stepper.step(0.5), StepStatus::ok);
    counter.update(system, stepper.state());
  }
  const double driven_teeth = counter.skipped();
  EXPECT_LT(std::abs(driven_teeth), 0.15);
  State jumped = stepper.state();
  jumped.chassis.angle[system.sprocket_body[0]] += 2.0 * k_pi / 10.0;
  counter.update(system, jumped);
  EXPECT_NEAR(counter.skipped() - driven_teeth, -1.0, 1e-9);
}

TEST(SpectralLine, FindsALineAndItsBackground) {
  std::vector<double> time, value;
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 50.0);
  for (int i = 0; i < 6000; ++i) {  // 3 s at 2 kHz
    time.push_back(i / 2000.0);
    value.push_back(3000.0 + 700.0 * std::sin(2.0 * k_pi * 71.62 * time.back() + 0.3) + noise(random));
  }
  const SpectralLine line = spectral_line(time, value, 0.5, 2.5, 71.62);
  // White noise of 50 in 4000 samples: some 2 in a Hann window's amplitude.
  EXPECT_NEAR(line.amplitude, 700.0, 8.0);
  EXPECT_GT(line.background, 0.5);
  EXPECT_LT(line.background, 4.0);
  const SpectralLine nothing = spectral_line(time, value, 0.5, 2.5, 150.0);
  EXPECT_LT(nothing.amplitude, 10.0);
}

}  // namespace
}  // namespace grouser::test
