#include "tests/validation/convergence_trajectory.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tests/support/vehicle_rk4.h"

namespace grouser::validation {
namespace {

State state_at(const System& system, const Assembled& rest, double time) {
  Stepper stepper(system, rest.state, rest.knobs);
  std::vector<double> corners = system.scenario.drive[0].time;
  corners.push_back(time);
  std::sort(corners.begin(), corners.end());
  for (const double corner : corners) {
    while (stepper.state().time < std::min(corner, time)) {
      if (stepper.step(std::min(corner, time)) != StepStatus::ok) throw std::runtime_error("the run failed");
    }
  }
  return stepper.state();
}

double largest_difference(const System& system, const Field& a, const Field& b) {
  double largest = 0.0;
  for (const CompiledTrack& track : system.tracks) {
    for (int i = track.offset; i < track.offset + track.num_links; ++i) {
      const Vector3d off(a[0][i] - b[0][i], a[1][i] - b[1][i], a[2][i] - b[2][i]);
      largest = std::max(largest, off.norm());
    }
  }
  return largest;
}

/// Link positions at the end of every window.
std::vector<Field> by_fixed_steps(const System& base, const State& start, const AssemblyKnobs& knobs,
                                  const std::vector<double>& windows, double step) {
  System system = base;
  system.scenario.integrator.fixed_step = step;
  Stepper stepper(system, start, knobs);
  std::vector<Field> positions;
  for (const double window : windows) {
    while (stepper.state().time < start.time + window) {
      if (stepper.step(start.time + window) != StepStatus::ok) throw std::runtime_error("the run failed");
    }
    positions.push_back(stepper.state().position);
  }
  return positions;
}

std::vector<Field> by_runge_kutta(const System& system, const State& start, const AssemblyKnobs& knobs,
                                  const std::vector<double>& windows, double step) {
  test::VehicleRk4 run(system, start, knobs);
  std::vector<Field> positions;
  for (const double window : windows) {
    const long until = std::lround(window / step);
    while (std::lround((run.state().time - start.time) / step) < until) run.step(step);
    positions.push_back(run.state().position);
  }
  return positions;
}

}  // namespace

TrajectoryErrors trajectory_errors(const System& system, const Assembled& rest, double from,
                                   std::vector<double> windows, std::vector<double> steps, double reference_step) {
  const State start = state_at(system, rest, from);
  const std::vector<Field> exact = by_runge_kutta(system, start, rest.knobs, windows, reference_step);
  const std::vector<Field> coarser = by_runge_kutta(system, start, rest.knobs, windows, 2.0 * reference_step);
  TrajectoryErrors found{from, windows, steps, {}, {}, reference_step};
  found.error.resize(windows.size());
  for (std::size_t w = 0; w < windows.size(); ++w)
    found.reference_error.push_back(largest_difference(system, exact[w], coarser[w]));
  for (const double step : steps) {
    const std::vector<Field> reached = by_fixed_steps(system, start, rest.knobs, windows, step);
    for (std::size_t w = 0; w < windows.size(); ++w)
      found.error[w].push_back(largest_difference(system, exact[w], reached[w]));
  }
  return found;
}

}  // namespace grouser::validation
