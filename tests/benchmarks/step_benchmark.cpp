/// Time of a step of the reference vehicle and of each of its stages, at rest and in run A's cruise.
#include <benchmark/benchmark.h>

#include <limits>

#include "tests/benchmarks/stages.h"

namespace {

using namespace grouser;
using namespace grouser::benchmarks;

/// 0: at rest; 1: in cruise.
const Scene& scene(const benchmark::State& loop) { return loop.range(0) == 0 ? rest_scene() : cruise_scene(); }

/// Runs one stage on a copy of the scene again and again.
void repeat(benchmark::State& loop, const Stage& stage) {
  Scene copy = scene(loop);
  for ([[maybe_unused]] const auto each : loop) {
    stage.run(copy);
    benchmark::ClobberMemory();
  }
}

/// Accepted steps: forces, accelerations, error control, update.
void step(benchmark::State& loop) {
  const Scene& start = scene(loop);
  Stepper stepper(start.system, start.state, start.knobs);
  const double t = stepper.state().time;
  for ([[maybe_unused]] const auto each : loop) {
    if (stepper.step(std::numeric_limits<double>::infinity()) != StepStatus::ok) loop.SkipWithError("the run failed");
  }
  loop.counters["real_time_factor"] =
      benchmark::Counter(stepper.state().time - t, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::RegisterBenchmark("step", step)->ArgName("cruise")->Arg(0)->Arg(1);
  for (const Stage& stage : stages()) {
    benchmark::RegisterBenchmark(stage.name, [&stage](benchmark::State& loop) { repeat(loop, stage); })
        ->ArgName("cruise")
        ->Arg(0)
        ->Arg(1);
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
