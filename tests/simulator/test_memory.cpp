#include <gtest/gtest.h>

#include <cstdio>
#include <limits>

#include "simulator/assembly.h"
#include "simulator/simulate.h"
#include "simulator/step.h"
#include "tests/support/allocation_count.h"
#include "tests/support/temporary_folder.h"

/// What steps and runs take from the heap.
namespace grouser::test {
namespace {

Scenario shipped(const std::string& name, std::map<std::string, std::string> set) {
  set.emplace("assembly.settle_time_s", "6");
  ScenarioOverrides overrides;
  overrides.set = std::move(set);
  return read_scenario(GROUSER_SOURCE_DIR "/test_data/scenarios/" + name, overrides);
}

TEST(Memory, AStepOfDoublePinsTakesNothingFromTheHeap) {
  if (!allocations_are_counted()) GTEST_SKIP() << "a sanitizer owns the heap";
  const System system = compile(shipped("run_a_double_pin.json", {}));
  const Assembled rest = assemble(system);
  Stepper stepper(system, rest.state, rest.knobs);
  for (int i = 0; i < 10; ++i) ASSERT_EQ(stepper.step(1e9), StepStatus::ok);
  const long before = allocation_count();
  bool ok = true;
  for (int i = 0; i < 100; ++i) ok = ok && stepper.step(1e9) == StepStatus::ok;
  EXPECT_EQ(allocation_count() - before, 0);
  EXPECT_TRUE(ok);
}

TEST(Memory, OfARunIsFlat) {
  if (!allocations_are_counted()) GTEST_SKIP() << "a sanitizer owns the heap";
  constexpr double k_duration = 6.0, k_early = k_duration / 4.0, k_window = 0.6;  // s, longer than a chunk
  const TemporaryFolder folder;
  long early = std::numeric_limits<long>::max(), late = early;  // least of a window: a checkpoint may be under way
  const auto watch = [&](const ProgressReport& report) {
    double time = 0.0;
    if (std::sscanf(report.what.c_str(), "%lf of 6 s", &time) != 1) return true;
    if (time > k_early && time < k_early + k_window) early = std::min(early, heap_bytes());
    if (time > k_duration - k_window) late = std::min(late, heap_bytes());
    return true;
  };
  const RunSummary summary = simulate(shipped("run_a.json", {{"duration_s", "6"}}), folder / "run", watch);
  EXPECT_EQ(summary.status, RunStatus::completed);
  // HDF5's index of chunks: measured 60 bytes a chunk. One number kept of every step would be 320 kB.
  EXPECT_LT(late - early, 128L << 10);
}

}  // namespace
}  // namespace grouser::test
