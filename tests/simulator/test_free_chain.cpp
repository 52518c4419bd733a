#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "simulator/energy_book.h"
#include "tests/support/closed_forms.h"
#include "tests/support/scenes.h"

/// Closed chains in free space: no gravity, no contact.
namespace grouser::test {
namespace {

const Vector3d k_far(0.0, 0.0, 1000.0);  // of the chassis

System chain_system(int num_links, const Bushing& bushing, double step) {
  Scenario scenario = parked(bare_vehicle(num_links), bushing, 0.0);
  scenario.integrator.fixed_step = step;
  return compile(scenario);
}

/// A polygon whose links start with random velocities on top of a common motion.
State thrown_chain(const System& system) {
  State state = strewn_state(system);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto vector = [&](double size) -> Vector3d {
    return size * Vector3d(unit(random), unit(random), unit(random));
  };
  const int n = system.tracks[0].num_links;
  const double radius = 0.5 * system.tracks[0].pitch / std::tan(k_pi / n);
  for (const CompiledTrack& track : system.tracks) {
    place_polygon(track, k_far + Vector3d(0.0, 50.0 * index_of(track.side), 0.0), radius, 3.0, state);
    for (int i = track.offset; i < track.offset + n; ++i) {
      LinkMotion link = get_link(state, i);
      link.velocity += Vector3d(2.0, -1.0, 0.5) + vector(0.3);
      link.angular_velocity += vector(3.0);
      set_link(state, i, link);
    }
  }
  relax_rubber(system, state);
  return state;
}

struct Drift {
  double linear, angular, energy;
  double linear_scale, angular_scale, loss;
};
Drift drift_of(const Bushing& bushing, double step) {
  const System system = chain_system(24, bushing, step);
  const State start = thrown_chain(system);
  const Momentum before = momentum(system.tracks[0], start);
  Stepper stepper(system, start, {});
  EnergyBook book = open_book(stepper.work().energy);
  constexpr double k_duration = 0.2;  // s
  for (int i = 0; i < static_cast<int>(std::lround(k_duration / step)); ++i) {
    EXPECT_EQ(stepper.step(1e9), StepStatus::ok);
    book_step(book, stepper.work().energy, stepper.last_step());
  }
  const Momentum after = momentum(system.tracks[0], stepper.state());
  // Angular momentum about the chain's own middle, so that 1 km of lever does not magnify round-off.
  const auto about = [](const Momentum& m, const Vector3d& point) {
    return Vector3d(m.angular - point.cross(m.linear));
  };
  const double mass = 24 * system.tracks[0].mass;
  const Vector3d moved = k_far + k_duration * before.linear / mass;
  const Vector3d l0 = about(before, k_far), l1 = about(after, moved);
  return {(after.linear - before.linear).norm(),
          (l1 - l0).norm(),
          std::abs(book.residual()),
          before.linear.norm(),
          l0.norm(),
          book.dissipated()};
}

TEST(FreeChain, KeepsItsLinearMomentumToRoundOff) {
  const Drift drift = drift_of(rubber_bushing(), 5e-5);
  // 4000 steps of 24 velocities, each rounded once a step.
  EXPECT_LT(drift.linear, 1e-12 * drift.linear_scale);
}

TEST(FreeChain, KeepsItsAngularMomentumToSecondOrder) {
  // The forces conserve it exactly; the integrator's update of positions and velocities does to O(h^2) (P 1). Springs
  // and dampers, whose error is smooth in h.
  const Drift coarse = drift_of(viscous_bushing(), 5e-5), fine = drift_of(viscous_bushing(), 2.5e-5);
  EXPECT_LT(fine.angular, 1e-5 * fine.angular_scale);
  EXPECT_NEAR(coarse.angular / fine.angular, 4.0, 0.5);
}

TEST(FreeChain, EnergyIsKeptOrLostInTheRubber) {
  const Drift coarse = drift_of(viscous_bushing(), 5e-5), fine = drift_of(viscous_bushing(), 2.5e-5);
  EXPECT_GT(fine.loss, 10.0);                          // J
  EXPECT_LT(fine.energy, 5e-3 * fine.loss);            // joints ring at kHz; measured 2.3e-3
  EXPECT_NEAR(coarse.energy / fine.energy, 4.0, 0.6);  // h^2
}

TEST(FreeChain, EnergyBookClosesWithFrictionAndRelaxation) {
  const Drift drift = drift_of(rubber_bushing(), 2.5e-5);
  EXPECT_GT(drift.loss, 10.0);
  EXPECT_LT(drift.energy, 2e-3 * drift.loss);  // the corners of the stops are met within h
}

TEST(FreeChain, SpinningPolygonPullsWithTheClosedFormsForce) {
  constexpr int n = 76;
  constexpr double spin = 5.0, k = 1e8;
  const System system = chain_system(n, elastic_bushing(), 5e-5);
  const CompiledTrack& track = system.tracks[0];
  const double force = spinning_polygon_force(n, track.pitch, track.mass, spin, k);
  EXPECT_NEAR(force, 19862.94 * (1.0 + 19862.94 / (k * track.pitch)), 0.1);  // D 7.2 with the stretched pitch
  const double gap = force / k, half = k_pi / n;
  const double radius = 0.5 * track.pitch / std::tan(half) + 0.5 * gap / std::sin(half);
  State state = strewn_state(system);
  for (const CompiledTrack& t : system.tracks) {
    place_polygon(t, k_far + Vector3d(0.0, 50.0 * index_of(t.side), 0.0), radius, spin, state);
  }
  relax_rubber(system, state);
  Stepper stepper(system, state, {});
  // Relative rest: every link feels its centripetal acceleration and nothing else. 1 km up a gap is known to 1e-13 m.
  for (int i = 0; i < n; ++i) {
    const LinkMotion link = get_link(state, i);
    const Vector3d wanted = -spin * spin * (link.position - k_far);
    EXPECT_LT((get_vector(stepper.acceleration().linear, i) - wanted).norm(), 1e-5);
    EXPECT_LT(get_vector(stepper.acceleration().angular, i).norm(), 1e-4);
  }
  // And it keeps turning so: the force over a quarter of a turn.
  double mean = 0.0;
  int samples = 0;
  while (stepper.state().time < 0.5 * k_pi / spin) {
    ASSERT_EQ(stepper.step(1e9), StepStatus::ok);
    mean += get_vector(stepper.work().joint_force_W, samples % n).norm();
    ++samples;
  }
  EXPECT_NEAR(mean / samples / force, 1.0, 1e-5);  // the step's own error, h^2
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
      place_polygon(track, k_far + Vector3d(0.0, 50.0 * index_of(track.side), 0.0),
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
