/// Prints the tables of docs/performance.md: every stage of a step against the limit of this machine, and how the cost
/// grows with the number of vehicles and falls with threads. Times are processor time; take ratios within one run.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <limits>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "tests/benchmarks/stages.h"

namespace {

using namespace grouser;
using namespace grouser::benchmarks;

double processor_time() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Shortest of several batches [s a call].
template <typename Work>
double seconds_per_call(Work work) {
  constexpr double k_batch_time = 2e-3;
  constexpr int k_batches = 40;
  long calls = 1;
  for (;; calls *= 2) {
    const double start = processor_time();
    for (long i = 0; i < calls; ++i) work();
    if (processor_time() - start > k_batch_time) break;
  }
  double shortest = std::numeric_limits<double>::infinity();
  for (int batch = 0; batch < k_batches; ++batch) {
    const double start = processor_time();
    for (long i = 0; i < calls; ++i) work();
    shortest = std::min(shortest, (processor_time() - start) / static_cast<double>(calls));
  }
  return shortest;
}

/// What this machine can do on one core, measured: per second.
struct Machine {
  double operations, roots, bytes;
};

/// Independent additions and multiplications of lanes in equal number: what the formulas consist of.
double operations_per_second() {
  constexpr int k_chains = 12, k_rounds = 1000;
  std::array<Lanes, k_chains> sum;
  sum.fill(1.0);
  const double seconds = seconds_per_call([&] {
    for (int round = 0; round < k_rounds; ++round) {
      for (int chain = 0; chain < k_chains; chain += 2) {
        sum[static_cast<std::size_t>(chain)] += 1e-9;
        sum[static_cast<std::size_t>(chain) + 1] *= 1.0 - 1e-12;
      }
    }
    benchmark::DoNotOptimize(sum);
  });
  return k_chains * k_rounds * k_lanes / seconds;
}

/// Divisions and square roots in equal number.
double roots_per_second() {
  constexpr int k_chains = 8, k_rounds = 1000;
  std::array<Lanes, k_chains> value;
  value.fill(2.0);
  const double seconds = seconds_per_call([&] {
    for (int round = 0; round < k_rounds; ++round) {
      for (int chain = 0; chain < k_chains; chain += 2) {
        value[static_cast<std::size_t>(chain)] = 3.0 / value[static_cast<std::size_t>(chain)];
        value[static_cast<std::size_t>(chain) + 1] = value[static_cast<std::size_t>(chain) + 1].sqrt();
      }
    }
    benchmark::DoNotOptimize(value);
  });
  return k_chains * k_rounds * k_lanes / seconds;
}

/// a = b + s c over arrays that fill what a step works on.
double bytes_per_second() {
  constexpr std::size_t k_length = 16384;
  std::vector<double> a(k_length), b(k_length, 1.0), c(k_length, 2.0);
  const double seconds = seconds_per_call([&] {
    for (std::size_t i = 0; i < k_length; i += k_lanes) store(&a[i], load(&b[i]) + 3.0 * load(&c[i]));
    benchmark::DoNotOptimize(a.data());
    benchmark::ClobberMemory();
  });
  return 3.0 * 8.0 * k_length / seconds;
}

/// Additions, multiplications and choices, divisions and roots, and numbers loaded and stored by a stage.
struct Cost {
  double operations = 0.0, roots = 0.0, numbers = 0.0;
  friend Cost operator*(double n, const Cost& c) { return {n * c.operations, n * c.roots, n * c.numbers}; }
  friend Cost operator+(const Cost& a, const Cost& b) {
    return {a.operations + b.operations, a.roots + b.roots, a.numbers + b.numbers};
  }
};

/// Counted by hand from the formulas in the stages' sources, to about a tenth. A touching window or block counts with
/// all its eight lanes: the lanes that touch nothing are part of what the method costs.
std::map<std::string, Cost> count_costs(const Scene& scene) {
  const System& system = scene.system;
  double links = 0.0, stops = 0.0, branches = 0.0, wheels = 0.0, points = 0.0, teeth = 0.0;
  for (const CompiledTrack& track : system.tracks) {
    links += track.num_links;
    wheels += static_cast<double>(track.discs.size());
    points = static_cast<double>(track.ground_points.size());
    teeth = track.sprocket.teeth;
    stops = branches = 0.0;
    for (const CompiledAxis& axis : track.bushing) {
      stops += static_cast<double>(axis.stops.size());
      branches += static_cast<double>(axis.branches.size());
    }
  }
  const double joints = system.num_revolute_joints(), lanes = k_lanes, sides = k_num_sides;
  double low_blocks = 0.0;  // of links that may touch the ground
  for (const CompiledTrack& track : system.tracks) {
    for (int i = 0; i < track.num_links; i += k_lanes) {
      low_blocks += bits_of(load(scene.state.position[2] + track.offset + i) < 0.25) != 0 ? 1.0 : 0.0;
    }
  }
  const Cost broad_phase{11.0 * links / sides, 0.0, 3.0 * links / sides};
  std::map<std::string, Cost> cost;
  cost["place chassis"] = joints * Cost{190.0, 0.0, 80.0};
  cost["place links"] = links * Cost{45.0, 0.0, 19.0};
  // kinematics 240, six springs 6 x 35 with two pieces each, wrench 80; 14 a stop, 17 a branch
  cost["bushings"] = links * (Cost{530.0, 6.0, 90.0} + stops * Cost{14.0, 0.0, 2.0} + branches * Cost{17.0, 0.0, 2.0});
  cost["discs and guides"] = wheels * (broad_phase + lanes * Cost{540.0, 12.0, 130.0});
  cost["sprockets"] = sides * (broad_phase + lanes * Cost{2.0 * (450.0 + 5.0 * teeth), 30.0, 160.0});
  cost["ground"] = low_blocks * lanes * points * Cost{170.0, 5.0, 40.0};
  cost["suspension"] = static_cast<double>(system.suspension.size()) * Cost{120.0, 5.0, 20.0};
  cost["drive"] = sides * Cost{20.0, 1.0, 10.0};
  cost["sums over joints"] = links * Cost{12.0, 0.0, 24.0};
  cost["chassis accelerations"] = joints * Cost{560.0, 1.0, 260.0};
  cost["link accelerations"] = links * Cost{120.0, 1.0, 75.0};
  cost["error estimate"] = links * Cost{55.0, 0.0, 18.0};
  cost["update"] = links * Cost{130.0, 0.0, 38.0};
  return cost;
}

void print_stages(const Machine& machine) {
  fmt::print("Machine, one core: {:.1f} G operations/s, {:.2f} G divisions and roots/s, {:.0f} GB/s.\n\n",
             1e-9 * machine.operations, 1e-9 * machine.roots, 1e-9 * machine.bytes);
  fmt::print("| stage | operations | divisions, roots | bytes | limit [us] | measured [us] | multiple |\n");
  fmt::print("| --- | ---: | ---: | ---: | ---: | ---: | ---: |\n");
  const auto row = [&](const std::string& name, const Cost& cost, double limit, double measured) {
    fmt::print("| {} | {:.0f} | {:.0f} | {:.0f} | {:.2f} | {:.2f} | {:.1f} |\n", name, cost.operations, cost.roots,
               8.0 * cost.numbers, 1e6 * limit, 1e6 * measured, measured / limit);
  };
  const std::map<std::string, Cost> costs = count_costs(cruise_scene());
  Cost all;
  double all_limit = 0.0, all_measured = 0.0;
  for (const Stage& stage : stages()) {
    if (!costs.contains(stage.name)) continue;  // the evaluation as a whole
    const Cost& cost = costs.at(stage.name);
    const double arithmetic = cost.operations / machine.operations + cost.roots / machine.roots;
    const double limit = std::max(arithmetic, 8.0 * cost.numbers / machine.bytes);
    Scene scene = cruise_scene();
    const double measured = seconds_per_call([&] {
      stage.run(scene);
      benchmark::ClobberMemory();
    });
    row(stage.name, cost, limit, measured);
    all = all + cost;
    all_limit += limit;
    all_measured += measured;
  }
  row("sum of stages", all, all_limit, all_measured);
  Stepper stepper(cruise_scene().system, cruise_scene().state, cruise_scene().knobs);
  const double step = seconds_per_call([&] {
    if (stepper.step(std::numeric_limits<double>::infinity()) != StepStatus::ok) std::abort();
  });
  row("accepted step in cruise", all, all_limit, step);
}

/// Steps of each of several vehicles.
void step_all(std::vector<Stepper>& vehicles, std::size_t from, std::size_t to) {
  constexpr int k_steps = 200;
  for (int i = 0; i < k_steps; ++i) {
    for (std::size_t v = from; v < to; ++v) {
      if (vehicles[v].step(std::numeric_limits<double>::infinity()) != StepStatus::ok) std::abort();
    }
  }
}

/// Shortest wall time of several rounds over vehicles shared out to threads.
double wall_time(std::vector<Stepper>& vehicles, std::size_t num_threads) {
  constexpr int k_rounds = 5;
  double shortest = std::numeric_limits<double>::infinity();
  for (int round = 0; round < k_rounds; ++round) {
    const auto start = std::chrono::steady_clock::now();
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < num_threads; ++t) {
      const std::size_t n = vehicles.size();
      threads.emplace_back([&, t] { step_all(vehicles, t * n / num_threads, (t + 1) * n / num_threads); });
    }
    for (std::thread& thread : threads) thread.join();
    shortest = std::min(shortest, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return shortest;
}

void print_scaling() {
  fmt::print("\n| vehicles stepped in turn | links | time a link over that of one vehicle |\n| ---: | ---: | ---: |\n");
  const Scene& scene = cruise_scene();
  double of_one = 0.0;
  for (const std::size_t count : {1, 2, 4, 8, 16}) {
    std::vector<Stepper> vehicles;
    for (std::size_t v = 0; v < count; ++v) vehicles.emplace_back(scene.system, scene.state, scene.knobs);
    double shortest = std::numeric_limits<double>::infinity();
    for (int round = 0; round < 5; ++round) {
      const double start = processor_time();
      step_all(vehicles, 0, count);
      shortest = std::min(shortest, processor_time() - start);
    }
    if (count == 1) of_one = shortest;
    fmt::print("| {} | {} | {:.2f} |\n", count, 152 * count, shortest / (of_one * static_cast<double>(count)));
  }
  const auto vehicles = [&](std::size_t count) {
    std::vector<Stepper> made;
    for (std::size_t v = 0; v < count; ++v) made.emplace_back(scene.system, scene.state, scene.knobs);
    return made;
  };
  std::vector<Stepper> one = vehicles(1), two = vehicles(2), sixteen = vehicles(16);
  const double alone = wall_time(one, 1);
  fmt::print("\nWall time on {} processors: two vehicles on two threads {:.2f} of one on one; ",
             std::thread::hardware_concurrency(), wall_time(two, 2) / alone);
  const double on_one = wall_time(sixteen, 1);
  fmt::print("sixteen on one thread {:.2f} of the time on two.\n", on_one / wall_time(sixteen, 2));
}

}  // namespace

int main() {
  const Machine machine{operations_per_second(), roots_per_second(), bytes_per_second()};
  print_stages(machine);
  print_scaling();
  return 0;
}
