#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/chains.h"

/// Closed chains in free space: no gravity, no contact.
namespace grouser::test {
namespace {

TEST(FreeChain, KeepsItsLinearMomentumToRoundOff) {
  const ChainDrift drift = drift_of(rubber_bushing(), 5e-5);
  // 4000 steps of 24 velocities, each rounded once a step.
  EXPECT_LT(drift.linear, 1e-12 * drift.linear_scale);
}

TEST(FreeChain, KeepsItsAngularMomentumToSecondOrder) {
  // The forces conserve it exactly; the integrator's update of positions and velocities does to O(h^2) (P 1). Springs
  // and dampers, whose error is smooth in h.
  const ChainDrift coarse = drift_of(viscous_bushing(), 5e-5), fine = drift_of(viscous_bushing(), 2.5e-5);
  EXPECT_LT(fine.angular, 1e-5 * fine.angular_scale);
  EXPECT_NEAR(coarse.angular / fine.angular, 4.0, 0.5);
}

TEST(FreeChain, EnergyIsKeptOrLostInTheRubber) {
  const ChainDrift coarse = drift_of(viscous_bushing(), 5e-5), fine = drift_of(viscous_bushing(), 2.5e-5);
  EXPECT_GT(fine.loss, 10.0);                          // J
  EXPECT_LT(fine.energy, 5e-3 * fine.loss);            // joints ring at kHz; measured 2.3e-3
  EXPECT_NEAR(coarse.energy / fine.energy, 4.0, 0.6);  // h^2
}

TEST(FreeChain, EnergyBookClosesWithFrictionAndRelaxation) {
  const ChainDrift drift = drift_of(rubber_bushing(), 2.5e-5);
  EXPECT_GT(drift.loss, 10.0);
  EXPECT_LT(drift.energy, 2e-3 * drift.loss);  // the corners of the stops are met within h
}

TEST(FreeChain, SpinningPolygonPullsWithTheClosedFormsForce) {
  constexpr int n = 76;
  constexpr double spin = 5.0, k = 1e8;
  const SpinningPolygon polygon(n, spin, 5e-5);
  const double pitch = polygon.system.tracks[0].pitch;
  EXPECT_NEAR(polygon.force, 19862.94 * (1.0 + 19862.94 / (k * pitch)), 0.1);  // with the stretched pitch
  Stepper stepper(polygon.system, polygon.start, {});
  // 1 km up a gap is known to 1e-13 m.
  EXPECT_LT(polygon.centripetal_error(stepper.acceleration()), 1e-5);
  for (int i = 0; i < n; ++i) EXPECT_LT(get_vector(stepper.acceleration().angular, i).norm(), 1e-4);
  // And it keeps turning so: the force over a quarter of a turn.
  double mean = 0.0;
  int samples = 0;
  while (stepper.state().time < 0.5 * k_pi / spin) {
    ASSERT_EQ(stepper.step(1e9), StepStatus::ok);
    mean += get_vector(stepper.work().joint_force_W, samples % n).norm();
    ++samples;
  }
  EXPECT_NEAR(mean / samples / polygon.force, 1.0, 1e-5);  // the step's own error, h^2
}

TEST(FreeChain, PreTorsionMovesNothingInAClosedChainOfLinearHinges) {
  // Equal couples at both ends of every link cancel (P 2).
  const auto end = [](double pre_torsion) {
    Vehicle vehicle = bare_vehicle(24);
    for (RunningGear& gear : vehicle.sides) gear.track.pre_torsion = pre_torsion;
    Scenario scenario = parked(vehicle, elastic_bushing(), 0.0);
    scenario.integrator.fixed_step = 5e-5;
    const System system = compile(scenario);
    State state = strewn_state(system);
    for (const CompiledTrack& track : system.tracks) {
      place_polygon(track, far_from_chassis() + Vector3d(0.0, 50.0 * index_of(track.side), 0.0),
                    0.5 * track.pitch / std::tan(k_pi / 24), 3.0, state);
      LinkMotion kicked = get_link(state, track.offset);  // in the plane: parallel pins stay parallel
      kicked.velocity.x() += 0.5;
      set_link(state, track.offset, kicked);
    }
    relax_rubber(system, state);
    Stepper stepper(system, state, {});
    while (stepper.state().time < 0.05) EXPECT_EQ(stepper.step(1e9), StepStatus::ok);
    return get_link(stepper.state(), 12).position;
  };
  EXPECT_LT((end(14.0 * k_pi / 180.0) - end(0.0)).norm(), 1e-8);  // chaos amplifies round-off of 1e-13 m
}

}  // namespace
}  // namespace grouser::test
