#include "tests/benchmarks/cost_model.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <vector>

#include "tests/benchmarks/timing.h"

namespace grouser::benchmarks {
namespace {

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

}  // namespace

Machine measure_machine() { return {operations_per_second(), roots_per_second(), bytes_per_second()}; }

double limit(const Machine& machine, const Cost& cost) {
  const double arithmetic = cost.operations / machine.operations + cost.roots / machine.roots;
  return std::max(arithmetic, 8.0 * cost.numbers / machine.bytes);
}

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

}  // namespace grouser::benchmarks
