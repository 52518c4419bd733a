#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/vehicle_rk4.h"
#include "tests/support/vehicle_scene.h"

/// The whole vehicle against another integrator.
namespace grouser::test {
namespace {

double largest_link_error(const System& system, const State& a, const State& b) {
  double largest = 0.0;
  for (const CompiledTrack& track : system.tracks) {
    for (int i = track.offset; i < track.offset + track.num_links; ++i)
      largest = std::max(largest, (get_vector(a.position, i) - get_vector(b.position, i)).norm());
  }
  return largest;
}

TEST(VehicleTrajectory, ErrsByTheSquareOfTheStepAgainstRungeKutta) {
  System system = driven(30.0, 24.0);  // a curve, so that the pads slide and the guides are met
  const State start = run_for(system, reference_scene().rest.state, 0.5).state;
  const double end = start.time + 0.01;
  VehicleRk4 exact(system, start, reference_scene().rest.knobs);
  constexpr double k_reference_step = 5e-6;
  while (exact.state().time < end - 0.5 * k_reference_step) exact.step(k_reference_step);
  const auto error = [&](double step) {
    system.scenario.integrator.fixed_step = step;
    return largest_link_error(system, run_for(system, start, end).state, exact.state());
  };
  const double coarse = error(8e-5), fine = error(2e-5);
  EXPECT_NEAR(std::log2(coarse / fine) / 2.0, 2.0, 0.25);  // kinks of friction and contact disturb the order
  EXPECT_LT(coarse, 1e-5);                                 // m; a bushing's force changes by 1 kN over this way
}

}  // namespace
}  // namespace grouser::test
