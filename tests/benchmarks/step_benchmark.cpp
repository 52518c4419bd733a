/// Time of a step of the reference vehicle and of its parts, from rest.
#include <benchmark/benchmark.h>

#include <limits>

#include "simulator/assembly.h"
#include "simulator/bushings.h"
#include "simulator/step.h"

namespace {

using namespace grouser;

struct Scene {
  System system = compile(read_scenario(GROUSER_SOURCE_DIR "/test_data/scenarios/run_a.json"));
  Assembled rest = assemble(system);
};

const Scene& scene() {
  static const Scene reference;
  return reference;
}

/// An accepted step: forces, accelerations, error control, update.
void step_of_the_vehicle(benchmark::State& loop) {
  Stepper stepper(scene().system, scene().rest.state, scene().rest.knobs);
  for ([[maybe_unused]] const auto each : loop) {
    if (stepper.step(std::numeric_limits<double>::infinity()) != StepStatus::ok) loop.SkipWithError("the run failed");
  }
  loop.counters["real_time_factor"] =
      benchmark::Counter(stepper.state().time, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(step_of_the_vehicle);

/// Forces and accelerations at one state.
void evaluation(benchmark::State& loop) {
  State state = scene().rest.state;
  Workspace work = make_workspace(scene().system);
  Acceleration acceleration = make_acceleration(scene().system);
  for ([[maybe_unused]] const auto each : loop) {
    evaluate(scene().system, scene().rest.knobs, scene().rest.state.history, 1e-4, state, work, acceleration);
    benchmark::DoNotOptimize(acceleration.linear);
  }
}
BENCHMARK(evaluation);

/// The 152 bushings alone.
void bushings(benchmark::State& loop) {
  State state = scene().rest.state;
  Workspace work = make_workspace(scene().system);
  place_links(scene().system, state, work);
  for ([[maybe_unused]] const auto each : loop) {
    bushing_forces(scene().system, scene().rest.knobs, scene().rest.state.history, 1e-4, state, work);
    benchmark::DoNotOptimize(work.bushing_force);
  }
}
BENCHMARK(bushings);

}  // namespace

BENCHMARK_MAIN();
