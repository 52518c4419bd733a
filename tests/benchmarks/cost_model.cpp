#include "tests/benchmarks/cost_model.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
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

double cases(const Scene& scene, std::initializer_list<ContactCase> which) {
  double sum = 0.0;
  for (const ContactCase c : which) sum += static_cast<double>(scene.work.case_count[static_cast<std::size_t>(c)]);
  return sum;
}

/// A joint: translation 72, swing and twist 145 (a root and three quotients), six springs of 32, rates and dampers 48,
/// wrenches 66, energies 36. A stop 11, a branch 12.
Cost rubber(const System& system) {
  Cost sum;
  for (const CompiledTrack& track : system.tracks) {
    Cost joint{559.0, 4.0, 67.0};
    for (const CompiledAxis& axis : track.bushing) {
      joint = joint + static_cast<double>(axis.stops.size()) * Cost{11.0, 0.0, 2.0} +
              static_cast<double>(axis.branches.size()) * Cost{12.0, 0.0, 2.0};
    }
    sum = sum + track.num_links * joint;
  }
  return sum;
}

/// Of every link near a wheel where it stands and how deep; of those that touch the relative motion and the loads to
/// and fro; of every disc that touches patch 43, force and friction 100.
Cost discs(const Scene& scene) {
  using enum ContactCase;
  const double near = cases(scene, {guide_none, guide_left_wall, guide_right_wall, guide_top});
  const double one = cases(scene, {one_disc_on_plate, one_disc_on_edge});
  const double two = cases(scene, {two_discs_on_plate, two_discs_on_edge});
  return near * Cost{65.0, 0.0, 12.0} + (one + two) * Cost{125.0, 0.0, 46.0} +
         (one + 2.0 * two) * Cost{143.0, 6.0, 0.0};
}

/// Of every pin that touches a ring of teeth: its place 57, gap 30, tooth 60, velocity 42, force and friction 45, loads
/// to and fro 60.
Cost sprockets(const Scene& scene) {
  using enum ContactCase;
  const double touching = cases(scene, {sprocket_top, sprocket_flank_driving, sprocket_flank_braking, sprocket_base});
  return touching * Cost{294.0, 10.0, 70.0};
}

/// Of every low link six heights and the loads; of every point that touches arm and velocity 30, force, bristle and
/// energies 72. Bristles stick.
Cost ground(const Scene& scene) {
  double low_links = 0.0, points = 0.0;
  for (const CompiledTrack& track : scene.system.tracks) {
    points = static_cast<double>(track.ground_points.size());
    const double highest = std::hypot(track.ground_depth, 0.5 * track.pitch);
    for (int i = 0; i < track.num_links; ++i)
      low_links += scene.state.position[2][track.offset + i] < highest ? 1.0 : 0.0;
  }
  const double touching = cases(scene, {ContactCase::ground_point});
  return low_links * (points * Cost{8.0, 0.0, 0.0} + Cost{11.0, 0.0, 40.0}) + touching * Cost{102.0, 0.0, 12.0};
}

}  // namespace

Machine measure_machine() { return {operations_per_second(), roots_per_second(), bytes_per_second()}; }

double limit(const Machine& machine, const Cost& cost) {
  const double arithmetic = cost.operations / machine.operations + cost.roots / machine.roots;
  return std::max(arithmetic, 8.0 * cost.numbers / machine.bytes);
}

std::map<std::string, Cost> count_costs(const Scene& scene) {
  const System& system = scene.system;
  const double links = system.num_bushings(), joints = system.num_revolute_joints();
  std::map<std::string, Cost> cost;
  cost["place chassis"] = joints * Cost{190.0, 0.0, 80.0};
  cost["place links"] = links * Cost{45.0, 0.0, 19.0};
  cost["bushings"] = rubber(system) + links * Cost{12.0, 0.0, 6.0};  // and the links' sums over their joints
  cost["discs and guides"] = discs(scene);
  cost["sprockets"] = sprockets(scene);
  cost["ground"] = ground(scene);
  cost["suspension"] = static_cast<double>(system.suspension.size()) * Cost{120.0, 5.0, 20.0};
  cost["drive"] = k_num_sides * Cost{20.0, 1.0, 10.0};
  cost["chassis accelerations"] = joints * Cost{560.0, 1.0, 260.0};
  // tangents to the bound 31, accelerations 33, energies 26
  cost["link accelerations"] = links * Cost{90.0, 1.0, 50.0};
  // local errors 66, contact losses over the links' ways 75
  cost["errors and losses"] = links * Cost{141.0, 0.0, 45.0};
  cost["update"] = links * Cost{140.0, 0.0, 38.0};
  return cost;
}

}  // namespace grouser::benchmarks
