#include "simulator/rubber_watch.h"

#include <algorithm>
#include <cmath>

namespace grouser {
namespace {

/// Sums of one step over the bushings.
struct StepSums {
  double torsion = 0.0, torsion_moment = 0.0, radial_force = 0.0, axial_force = 0.0;  // squares
  long bushings = 0;
};

template <typename Squares>
void see(const Squares& squares, LoadMeasure& measure, double& square_sum) {
  measure.largest = std::max(measure.largest, std::sqrt(squares.maxCoeff()));
  square_sum += squares.sum();
}

/// The bushings of one track whose rows begin at `first`.
void watch_row(const CompiledTrack& track, const State& state, const Workspace& work, int first, RubberLoads& loads,
               StepSums& sums) {
  using Row = Eigen::Map<const Eigen::ArrayXd>;
  const auto row = [&](const Field& field, int c) { return Row(field[c] + first, track.num_links); };
  const Row x = row(work.bushing_force, 0), y = row(work.bushing_force, 1), z = row(work.bushing_force, 2);
  see((row(state.history.deflection, index_of(Axis::ry)) - track.free_twist).square(), loads.torsion, sums.torsion);
  see(row(work.bushing_torque, 1).square(), loads.torsion_moment, sums.torsion_moment);
  see(x.square() + z.square(), loads.radial_force, sums.radial_force);
  see(y.square(), loads.axial_force, sums.axial_force);
  loads.largest_tension = std::max(loads.largest_tension, x.maxCoeff());
  loads.least_tension = std::min(loads.least_tension, x.minCoeff());
  for (int a = 0; a < k_num_axes; ++a) {
    const double free = a == index_of(Axis::ry) ? track.free_twist : 0.0;
    double& largest = loads.largest_deflection[static_cast<std::size_t>(a)];
    largest = std::max(largest, (row(state.history.deflection, a) - free).abs().maxCoeff());
  }
  sums.bushings += track.num_links;
}

}  // namespace

void watch_rubber(const System& system, const State& state, const Workspace& work, double h, RubberLoads& loads) {
  StepSums sums;
  for (const CompiledTrack& track : system.tracks) {
    watch_row(track, state, work, track.offset, loads, sums);
    if (track.joint != JointForm::single_pin) watch_row(track, state, work, track.connector_offset, loads, sums);
  }
  const double weight = h / static_cast<double>(sums.bushings);
  loads.time += h;
  loads.torsion.square_time += weight * sums.torsion;
  loads.torsion_moment.square_time += weight * sums.torsion_moment;
  loads.radial_force.square_time += weight * sums.radial_force;
  loads.axial_force.square_time += weight * sums.axial_force;
}

std::vector<RunResult> rubber_results(const RubberLoads& loads) {
  std::vector<RunResult> results{{"largest_tension_N", loads.largest_tension, "N", "in any bushing at any step"},
                                 {"least_tension_N", loads.least_tension, "N", "in any bushing at any step"}};
  const auto add = [&](const std::string& name, const char* unit, const char* suffix, const LoadMeasure& measure,
                       const std::string& meaning) {
    const double rms = loads.time > 0.0 ? std::sqrt(measure.square_time / loads.time) : 0.0;
    results.push_back({name + "_largest_" + suffix, measure.largest, unit, meaning + ", largest at any step"});
    results.push_back({name + "_rms_" + suffix, rms, unit, meaning + ", root mean square over bushings and time"});
  };
  add("bushing_torsion", "rad", "rad", loads.torsion, "twist of the rubber of one bushing, from where it is free");
  add("bushing_torsion_moment", "N m", "N_m", loads.torsion_moment, "hinge moment of the rubber of one bushing");
  add("bushing_radial_force", "N", "N", loads.radial_force, "force across the pin in the rubber of one bushing");
  add("bushing_axial_force", "N", "N", loads.axial_force, "force along the pin in the rubber of one bushing");
  return results;
}

}  // namespace grouser
