/// A second of run A's cruise, for one vehicle to sixteen, on one thread and two. The column CPU is the processor time
/// of all threads, per_link its share of a link: linear growth keeps it. What threads gain shows in the wall time
/// alone.
#include <benchmark/benchmark.h>

#include <thread>
#include <vector>

#include "tests/benchmarks/stages.h"

namespace {

using namespace grouser;
using namespace grouser::benchmarks;

void cruise(std::vector<Stepper>& vehicles, std::size_t from, std::size_t to, double until) {
  for (std::size_t v = from; v < to; ++v) {
    while (vehicles[v].state().time < until) {
      if (vehicles[v].step(until) != StepStatus::ok) std::abort();
    }
  }
}

void cruise_second(benchmark::State& loop) {
  const auto num_vehicles = static_cast<std::size_t>(loop.range(0)),
             num_threads = static_cast<std::size_t>(loop.range(1));
  const Scene& scene = cruise_scene();
  std::vector<Stepper> vehicles;
  for (std::size_t v = 0; v < num_vehicles; ++v) vehicles.emplace_back(scene.system, scene.state, scene.knobs);
  double until = scene.state.time;
  for ([[maybe_unused]] const auto each : loop) {
    until += 1.0;
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < num_threads; ++t) {
      threads.emplace_back(
          [&, t] { cruise(vehicles, t * num_vehicles / num_threads, (t + 1) * num_vehicles / num_threads, until); });
    }
    for (std::thread& thread : threads) thread.join();
  }
  const double links = 152.0 * static_cast<double>(num_vehicles);
  loop.counters["per_link"] =
      benchmark::Counter(links, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(cruise_second)
    ->ArgNames({"vehicles", "threads"})
    ->ArgsProduct({{1, 2, 4, 8, 16}, {1}})
    ->ArgsProduct({{2, 16}, {2}})
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
