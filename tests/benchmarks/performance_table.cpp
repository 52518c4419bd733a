/// Prints the tables of docs/performance.md: every stage of a step against the limit of this machine, run A as a whole,
/// and how cost grows with the number of vehicles and falls with threads. Processor time, but where wall time is named.
/// performance_table [run] [stages] [scaling] [parallel]: these only.
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "tests/benchmarks/cost_model.h"
#include "tests/benchmarks/timing.h"
#include "tests/benchmarks/whole_run.h"

namespace {

using namespace grouser;
using namespace grouser::benchmarks;

constexpr double k_endless = std::numeric_limits<double>::infinity();

void print_stages(const Machine& machine) {
  fmt::print("\nMachine, one core: {:.1f} G operations/s, {:.2f} G divisions and roots/s, {:.0f} GB/s.\n\n",
             1e-9 * machine.operations, 1e-9 * machine.roots, 1e-9 * machine.bytes);
  fmt::print("| stage | operations | divisions, roots | bytes | limit [us] | measured [us] | multiple |\n");
  fmt::print("| --- | ---: | ---: | ---: | ---: | ---: | ---: |\n");
  const auto row = [&](const std::string& name, const Cost& cost, double least, double measured) {
    fmt::print("| {} | {:.0f} | {:.0f} | {:.0f} | {:.2f} | {:.2f} | {:.1f} |\n", name, cost.operations, cost.roots,
               8.0 * cost.numbers, 1e6 * least, 1e6 * measured, measured / least);
  };
  const std::map<std::string, Cost> costs = count_costs(cruise_scene());
  Cost all;
  double all_limit = 0.0, all_measured = 0.0;
  for (const Stage& stage : stages()) {
    if (!costs.contains(stage.name)) continue;  // the evaluation as a whole
    const Cost& cost = costs.at(stage.name);
    Scene scene = cruise_scene();
    const double measured = seconds_per_call([&] {
      stage.run(scene);
      benchmark::ClobberMemory();
    });
    row(stage.name, cost, limit(machine, cost), measured);
    all = all + cost;
    all_limit += limit(machine, cost);
    all_measured += measured;
  }
  row("sum of stages", all, all_limit, all_measured);
  Stepper stepper(cruise_scene().system, cruise_scene().state, cruise_scene().knobs);
  const double step = seconds_per_call([&] {
    if (stepper.step(k_endless) != StepStatus::ok) std::abort();
  });
  row("accepted step in cruise", all, all_limit, step);
}

void print_run(const std::filesystem::path& folder) {
  const WholeRun run = run_a_on(processors().front(), folder);
  const double step = run.steps_alone / static_cast<double>(run.accepted);
  fmt::print("\n| run A with full output, kept to one processor | |\n| --- | ---: |\n");
  fmt::print("| accepted steps, rejected steps | {}, {} |\n", run.accepted, run.rejected);
  fmt::print("| mean step | {:.4f} ms |\n", 1e3 * run.duration / static_cast<double>(run.accepted));
  fmt::print("| processor time of {:g} s, output included, assembly apart | {:.2f} s |\n", run.duration,
             run.processor_time);
  fmt::print("| **real-time factor by processor time** | **{:.3f}** |\n", run.processor_time / run.duration);
  fmt::print("| of that the steps alone; of one | {:.3f}; {:.1f} us |\n", run.steps_alone / run.duration, 1e6 * step);
  fmt::print("| of that output and watching, of which on the writer's thread | {:.3f}, {:.3f} |\n",
             (run.processor_time - run.steps_alone) / run.duration, run.writer_time / run.duration);
  fmt::print("| real-time factor by wall time; share of it that the processor was ours | {:.3f}; {:.0f} % |\n",
             run.wall_time / run.duration, 100.0 * run.processor_time / run.wall_time);
  const auto& resident = run.resident_bytes;
  fmt::print("| resident after a quarter, a half, all of the run | {:.1f}, {:.1f}, {:.1f} MB |\n", 1e-6 * resident[0],
             1e-6 * resident[1], 1e-6 * resident[2]);
  if (const double command = resident_bytes_of_command(folder); command > 0.0)
    fmt::print("| resident at most, `grouser simulate` with all its libraries | {:.0f} MB |\n", 1e-6 * command);
}

/// Steps of each of several vehicles.
void step_all(std::vector<Stepper>& vehicles, std::size_t from, std::size_t to) {
  constexpr int k_steps = 200;
  for (int i = 0; i < k_steps; ++i) {
    for (std::size_t v = from; v < to; ++v) {
      if (vehicles[v].step(k_endless) != StepStatus::ok) std::abort();
    }
  }
}

std::vector<Stepper> vehicles_in_cruise(std::size_t count) {
  const Scene& scene = cruise_scene();
  std::vector<Stepper> vehicles;
  for (std::size_t v = 0; v < count; ++v) vehicles.emplace_back(scene.system, scene.state, scene.knobs);
  return vehicles;
}

constexpr int k_rounds = 5;

void print_scaling() {
  fmt::print("\n| vehicles stepped in turn | links | time a link over that of one vehicle |\n| ---: | ---: | ---: |\n");
  double of_one = 0.0;
  for (const std::size_t count : {1, 2, 4, 8, 16}) {
    std::vector<Stepper> vehicles = vehicles_in_cruise(count);
    const double time = shortest_of(k_rounds, CLOCK_THREAD_CPUTIME_ID, [&] { step_all(vehicles, 0, count); });
    if (count == 1) of_one = time;
    fmt::print("| {} | {} | {:.2f} |\n", count, 152 * count, time / (of_one * static_cast<double>(count)));
  }
}

/// Wall time of vehicles shared out to threads.
double wall_time(std::vector<Stepper>& vehicles, std::size_t num_threads) {
  return shortest_of(k_rounds, CLOCK_MONOTONIC, [&] {
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < num_threads; ++t) {
      const std::size_t n = vehicles.size();
      threads.emplace_back([&, t] { step_all(vehicles, t * n / num_threads, (t + 1) * n / num_threads); });
    }
    for (std::thread& thread : threads) thread.join();
  });
}

void print_parallel(const std::filesystem::path& folder) {
  const std::vector<int> all = processors();
  fmt::print("\n| wall time on {} processors | |\n| --- | ---: |\n", all.size());
  if (all.size() >= 2) {
    const double one = wall_time_of_runs_on({all[0]}, folder), two = wall_time_of_runs_on({all[0], all[1]}, folder);
    fmt::print("| two processes of run A on a processor each, over one | {:.2f} |\n", two / one);
  }
  std::vector<Stepper> sixteen = vehicles_in_cruise(16);
  const double on_one = wall_time(sixteen, 1);
  fmt::print("| sixteen vehicles on one thread, over two threads | {:.2f} |\n", on_one / wall_time(sixteen, 2));
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> asked(argv + 1, argv + argc);
  const auto wanted = [&](const char* part) {
    return asked.empty() || std::find(asked.begin(), asked.end(), part) != asked.end();
  };
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / fmt::format("grouser_performance_{}", getpid());
  if (wanted("run")) print_run(folder);  // first: its process begins as a copy of this one
  if (wanted("stages")) print_stages(measure_machine());
  if (wanted("scaling")) print_scaling();
  if (wanted("parallel")) print_parallel(folder);
  std::filesystem::remove_all(folder);
  return 0;
}
