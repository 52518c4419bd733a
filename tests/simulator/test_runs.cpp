#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <random>
#include <sstream>
#include <thread>

#include "model/errors.h"
#include "simulator/checkpoint.h"
#include "simulator/results.h"
#include "simulator/run_loop.h"
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

TEST(Run, TheSameInputGivesTheSameBytesAloneAndBesideOthers) {
  const TemporaryFolder folder;
  const Scenario scenario = short_run(folder, "run_a.json", {{"duration_s", "0.6"}});  // a checkpoint, chunks and parts
  const auto run = [&](int name) {
    EXPECT_EQ(simulate(scenario, folder / std::to_string(name)).status, RunStatus::completed);
    return bytes_of(folder / (std::to_string(name) + "/run.h5"));
  };
  const std::string alone = run(0);
  EXPECT_GT(alone.size(), 1000000u);
  constexpr int k_most = 4;  // stepping threads; each has a writer's thread beside it
  for (int at_once = 2; at_once <= k_most; at_once *= 2) {
    std::vector<std::string> beside(static_cast<std::size_t>(at_once));
    std::vector<std::thread> threads;
    for (int i = 0; i < at_once; ++i) {
      threads.emplace_back([&, i] { beside[static_cast<std::size_t>(i)] = run(10 * at_once + i); });
    }
    for (std::thread& thread : threads) thread.join();
    for (const std::string& bytes : beside) EXPECT_TRUE(bytes == alone);
  }
}

/// The parts of a checkpoint are taken for this vehicle or not at all, whatever its checksum says.
TEST(Checkpoint, RefusesPartsOfAnotherVehicleAndPartsThatAreCutShort) {
  const System& system = reference_scene().system;
  State state = reference_scene().rest.state;
  CheckpointWriter writer;
  writer(state);
  const std::string payload = writer.payload();
  const auto refusal = [](const std::string& bytes, State to) -> std::string {
    CheckpointReader reader(bytes, "run/checkpoint");
    try {
      reader(to);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal(payload, make_state(system)), "");
  State longer = make_state(system);
  longer.position = Field(3, system.link_array_length + k_lanes);
  EXPECT_THAT(refusal(payload, longer), testing::HasSubstr("run/checkpoint: expected 552 numbers"));
  EXPECT_THAT(refusal(payload.substr(0, payload.size() - 1), make_state(system)),
              testing::HasSubstr("an end before the last of them"));
}

/// Bytes with another number at a place.
template <typename T>
std::string with(std::string bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
  return bytes;
}

TEST(Checkpoint, RefusesPartsThatTheVehicleDoesNotHave) {
  const VehicleScene& scene = reference_scene();
  Stepper stepper(scene.system, scene.rest.state, scene.rest.knobs);
  CheckpointWriter writer;
  writer(stepper);
  // Behind the states: the limits of a step, four parts of a link and a body each, and numbers that may be any.
  constexpr std::size_t k_words = 19, k_indices = 4 * 2 + 2;
  const std::size_t size = writer.payload().size();
  for (const int wrong : {1'000'000'000, -2, -1'000'000'000}) {
    std::size_t refused = 0;
    for (std::size_t word = 1; word <= k_words; ++word) {
      CheckpointReader reader(with(writer.payload(), size - 4 * word, wrong), "run/checkpoint");
      try {
        reader(stepper);
      } catch (const InputError& error) {
        ++refused;
        EXPECT_THAT(error.what(), testing::HasSubstr("run/checkpoint: expected "));
      }
    }
    EXPECT_EQ(refused, k_indices) << wrong;
  }
}

/// What taking this checkpoint into a new run of the reference vehicle throws.
std::string refusal_by_run(const std::string& payload) {
  const TemporaryFolder folder;
  RunStart start;
  start.assembled = reference_scene().rest;
  RunLoop run(reference_scene().system, start, folder.path());
  run.begin();
  CheckpointReader reader(payload, "run/checkpoint");
  try {
    run.take(reader);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Checkpoint, RefusesTimesAndRowsThatTheRunDoesNotHave) {
  if (fegetexcept() != 0) GTEST_SKIP() << "floating-point traps are on, and a time that is no number is compared";
  const VehicleScene& scene = reference_scene();
  const TemporaryFolder folder;
  RunStart start;
  start.assembled = scene.rest;
  RunLoop run(scene.system, start, folder.path());
  run.begin();
  CheckpointWriter all, stepper_only, book_only;
  all(run);
  Stepper stepper(scene.system, scene.rest.state, scene.rest.knobs);
  stepper_only(stepper);
  EnergyBook book;
  book_only(book);
  // Nothing of it is wrong. Only a step fills the workspace in the way that the last look evaluates again.
  EXPECT_THAT(refusal_by_run(all.payload()), testing::HasSubstr("expected accelerations"));
  for (const double time : {-1.0, 1e300, std::nan("")})
    EXPECT_THAT(refusal_by_run(with(all.payload(), 0, time)), testing::HasSubstr("expected a time of the run"));
  const std::size_t samples = stepper_only.payload().size() + book_only.payload().size();
  for (const long count : {-1L << 60, 0L, 1L << 60})
    EXPECT_THAT(refusal_by_run(with(all.payload(), samples, count)), testing::HasSubstr("expected the rows of run.h5"));
}

TEST(Checkpoint, RefusesTablesThatRunH5DoesNotHave) {
  const TemporaryFolder folder;
  const System& system = reference_scene().system;
  RunStart start;
  start.assembled = reference_scene().rest;
  start.kept_rows.assign(4, 0);
  CheckpointWriter parts;
  parts(start);
  write_checkpoint(folder.path(), identity_of(system.scenario), parts);
  EXPECT_THAT([&] { (void)resume(system.scenario, folder.path()); },
              testing::ThrowsMessage<InputError>(testing::HasSubstr("numbers, as the vehicle has them, found 4")));
}

TEST(Checkpoint, ThatIsRefusedLeavesTheRunAsItWas) {
  const TemporaryFolder folder;
  const Scenario scenario = short_run(folder, "run_a.json", {{"duration_s", "1.2"}});
  const Progress until_halfway = [](const ProgressReport& report) { return report.fraction < 0.6; };
  ASSERT_EQ(simulate(scenario, folder / "run", until_halfway).status, RunStatus::stopped);
  const std::string before = bytes_of(folder / "run/run.h5");
  const System system = compile(scenario);
  RunStart start;
  start.assembled = assemble(system, nullptr);
  std::filesystem::create_directory(folder / "other");
  RunLoop other(system, start, folder / "other");
  other.begin();
  start.kept_rows.assign(ChannelRows(system).tables().size(), 0);
  CheckpointWriter parts;
  parts(start);
  parts(other);
  write_checkpoint(folder / "run", identity_of(scenario), parts);
  EXPECT_THROW(static_cast<void>(resume(scenario, folder / "run")), InputError);
  EXPECT_TRUE(bytes_of(folder / "run/run.h5") == before);
}

/// The same value for both tracks of the vehicle.
void set_both(std::map<std::string, std::string>& set, const std::string& path, const std::string& value) {
  for (const char* side : {"left", "right"}) set["vehicle./" + std::string(side) + path] = value;
}

TEST(Run, ATrackThatLeavesItsGuideEndsTheRunWithWhereAndWhen) {
  // P 4: guides of 1e4 N/m in run B at 50 kN; 0.1 m beside the wheel at 0.56 s, blow-up at 2.25 s.
  const TemporaryFolder folder;
  std::map<std::string, std::string> set{{"duration_s", "2"}, {"assembly.settle_time_s", "6"}};
  set_both(set, "/track/link/guide/stiffness_N_per_m", "1e4");
  set_both(set, "/track/pre_tension_kN", "50");
  const RunSummary summary = simulate(short_run(folder, "run_b.json", std::move(set)), folder / "run");
  EXPECT_EQ(summary.status, RunStatus::failed);
  EXPECT_THAT(summary.message, testing::HasSubstr("right track thrown at 0.5"));
  EXPECT_THAT(summary.message, testing::HasSubstr("beside right/idler, where its guide has 15 mm of play"));
  EXPECT_THAT(summary.message, testing::HasSubstr("link "));
  EXPECT_NEAR(summary.simulated_time, 0.56, 0.05);
  // What was computed is kept, and says the same.
  EXPECT_EQ(read_run_summary(folder / "run/run.json").status, RunStatus::failed);
  EXPECT_GT(RunReader(folder / "run/run.h5").read("/time").rows(), 40u);
}

TEST(Run, ASkippedToothEndsTheRunWithWhatLedToIt) {
  // P 4: at 50 kN on a tensioner of 1e6 N/m the slack gathers at the sprocket when the vehicle brakes, and pins climb
  // the teeth. The short brake before, at 0.6 s, leaves the span slack too; a turn later that has
  // no part in it.
  const TemporaryFolder folder;
  std::map<std::string, std::string> set{{"duration_s", "2.75"}, {"assembly.settle_time_s", "6"}};
  for (const char* side : {"left", "right"}) {
    set["drive." + std::string(side) + ".time_s"] = "[0, 0.6, 0.75, 2.0, 2.75]";
    set["drive." + std::string(side) + ".speed_rad_per_s"] = "[0, 4.8, 1.8, 13.5, 0.5]";
  }
  set_both(set, "/idler/tensioner/stiffness_N_per_m", "1e6");
  set_both(set, "/track/pre_tension_kN", "50");
  const RunSummary summary = simulate(short_run(folder, "run_a.json", std::move(set)), folder / "run");
  EXPECT_EQ(summary.status, RunStatus::failed);
  EXPECT_THAT(summary.message, testing::HasSubstr("left track skipped a tooth at 2.6"));
  EXPECT_THAT(summary.message, testing::HasSubstr("went slack at 2.0"));
  EXPECT_THAT(summary.message, testing::HasSubstr("a stiffer tensioner, more pre-tension"));
  const auto slack = std::find_if(summary.results.begin(), summary.results.end(),
                                  [](const RunResult& r) { return r.name == "left_first_slack_time_s"; });
  ASSERT_NE(slack, summary.results.end());
  EXPECT_NEAR(slack->value, 0.68, 0.05);  // s
}

TEST(Run, ChatterEndsTheRunWithTheAccountThatGrowsAndThePartThatBoundsTheStep) {
  // P 3: a fixed step of 0.18 ms neither blows up nor shows in the vehicle's motion, at rest or under way.
  for (const char* speed : {"[0, 45, 45, 0]", "[0, 0, 0, 0]"}) {
    const TemporaryFolder folder;
    const Scenario scenario = short_run(folder, "run_a.json",
                                        {{"duration_s", "1"},
                                         {"assembly.settle_time_s", "6"},
                                         {"drive.left.speed_rad_per_s", speed},
                                         {"drive.right.speed_rad_per_s", speed},
                                         {"integrator.fixed_step_ms", "0.19"}});
    const RunSummary summary = simulate(scenario, folder / "run");
    EXPECT_EQ(summary.status, RunStatus::failed);
    // In the first step that passes 1e-3; one step of this chatter adds up to a half.
    EXPECT_THAT(summary.message, testing::ContainsRegex("energy residual 1\\.[0-9]+e-03"));
    EXPECT_THAT(summary.message, testing::HasSubstr(" % of all losses"));
    EXPECT_THAT(summary.message,
                testing::ContainsRegex("% of the steps are bounded by links [a-z ]+, most often link"));
    EXPECT_THAT(summary.message,
                testing::ContainsRegex("integrator.fixed_step, which is [12]\\.[0-9]+ times the bound"));
    EXPECT_LT(summary.simulated_time, 0.3);
  }
}

TEST(Run, TheSlackOfAnIdlerIsNoneAtRestAndTheSpansOfTheSprocketCarryAlike) {
  const auto& [system, rest] = reference_scene();
  const Stepper stepper(system, rest.state, rest.knobs);
  for (const Side side : {Side::left, Side::right}) {
    const SpanTension upper = upper_run_tension(system, stepper.state(), stepper.work(), side);
    const SpanTension span = sprocket_span_tension(system, stepper.state(), stepper.work(), side);
    EXPECT_GE(span.joints, 2);
    EXPECT_LT(span.high - span.low, 0.05 * span.mean);  // one free span
    EXPECT_NEAR(span.mean / upper.mean, 1.0, 0.2);      // sprocket friction keeps apart what settling left
  }
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
