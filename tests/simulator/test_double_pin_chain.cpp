#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "simulator/bushings.h"
#include "simulator/energy_book.h"
#include "tests/support/scenes.h"

/// Closed chains of double pins in free space, their connectors massless or bodies.
namespace grouser::test {
namespace {

constexpr double k_length = 0.063;       // m, of a connector
const Vector3d k_far(0.0, 0.0, 1000.0);  // of the chassis

/// connector_mass: kg; 0 for the condensed form.
System chain(int num_links, const Bushing& bushing, double step, double connector_mass = 0.0) {
  Vehicle vehicle = bare_vehicle(num_links);
  for (RunningGear& gear : vehicle.sides) {
    gear.track.connection = Connection::double_pin;
    gear.track.connector = {k_length, connector_mass == 0.0, connector_mass,
                            connector_mass * Vector3d(0.09, 0.0015, 0.091)};
  }
  Scenario scenario = parked(vehicle, bushing, 0.0);
  scenario.integrator.fixed_step = step;
  return compile(scenario);
}

/// Polygons of both tracks whose bores stand `reach` from the middle of their joints.
State polygon(const System& system, double reach, double spin) {
  State state = strewn_state(system);
  for (const CompiledTrack& track : system.tracks) {
    const double half = k_pi / track.num_links;
    const double radius = (reach + track.groove * std::cos(half)) / std::sin(half);
    place_polygon(track, k_far + Vector3d(0.0, 50.0 * index_of(track.side), 0.0), radius, spin, state);
  }
  return state;
}

void settle_rubber(const System& system, State& state) {
  close_chains(system, state);
  place_connectors(system, state);
  relax_rubber(system, state);
}

State thrown(const System& system, double size) {
  State state = polygon(system, 0.5 * k_length, 3.0);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto vector = [&](double length) -> Vector3d {
    return length * Vector3d(unit(random), unit(random), unit(random));
  };
  for (const CompiledTrack& track : system.tracks) {
    for (int i = track.offset; i < track.offset + track.num_links; ++i) {
      LinkMotion link = get_link(state, i);
      link.velocity += Vector3d(2.0, -1.0, 0.5) + vector(0.3 * size);
      link.angular_velocity += vector(3.0 * size);
      set_link(state, i, link);
    }
  }
  settle_rubber(system, state);
  return state;
}

Momentum momentum_of_all(const CompiledTrack& track, const State& state) {
  Momentum sum;
  for (const LinkBodies& bodies : track.bodies) {
    for (int i = bodies.offset; i < bodies.offset + bodies.count; ++i) {
      const LinkMotion link = get_link(state, i);
      const Vector3d p = bodies.mass * link.velocity;
      sum.linear += p;
      sum.angular +=
          (link.position - k_far).cross(p) + link.orientation * bodies.inertia.cwiseProduct(link.angular_velocity);
    }
  }
  return sum;
}

struct Drift {
  double linear, angular, energy, loss, linear_scale, angular_scale;
};
Drift drift_of(const System& system, double duration) {
  const State start = thrown(system, 1.0);
  const Momentum before = momentum_of_all(system.tracks[0], start);
  Stepper stepper(system, start, {});
  EnergyBook book = open_book(stepper.work().energy);
  while (stepper.state().time < duration) {
    EXPECT_EQ(stepper.step(duration), StepStatus::ok);
    book_step(book, stepper.work().energy, stepper.last_step());
  }
  const Momentum after = momentum_of_all(system.tracks[0], stepper.state());
  return {(after.linear - before.linear).norm(),
          (after.angular - before.angular).norm(),
          std::abs(book.residual()),
          book.dissipated(),
          before.linear.norm(),
          before.angular.norm()};
}

TEST(DoublePinChain, KeepsItsLinearMomentumToRoundOff) {
  for (const double connector_mass : {0.0, 4.0}) {
    const Drift drift = drift_of(chain(24, rubber_bushing(), 4e-5, connector_mass), 0.1);
    EXPECT_LT(drift.linear, 1e-12 * drift.linear_scale) << connector_mass;  // 2500 steps of rounded velocities
  }
}

TEST(DoublePinChain, KeepsItsAngularMomentumToSecondOrder) {
  for (const double connector_mass : {0.0, 4.0}) {
    const Drift coarse = drift_of(chain(24, viscous_bushing(), 4e-5, connector_mass), 0.1);
    const Drift fine = drift_of(chain(24, viscous_bushing(), 2e-5, connector_mass), 0.1);
    EXPECT_LT(fine.angular, 1e-5 * fine.angular_scale) << connector_mass;
    EXPECT_NEAR(coarse.angular / fine.angular, 4.0, 0.6) << connector_mass;
  }
}

TEST(DoublePinChain, EnergyIsKeptAsTheStepFalls) {
  // Undamped joints ring at kHz, and so does the error of what is read at the end: 33 measured for 64 of second order.
  const Drift coarse = drift_of(chain(24, elastic_bushing(), 4e-5), 0.1);
  const Drift fine = drift_of(chain(24, elastic_bushing(), 5e-6), 0.1);
  EXPECT_LT(fine.energy, coarse.energy / 16.0);
}

TEST(DoublePinChain, EnergyBookClosesWithAllThatRubberHas) {
  // Plain dampers act at the rate at which the springs alone would carry the connector: 3e-4 of the loss at any step.
  const Drift viscous = drift_of(chain(24, viscous_bushing(), 2e-5), 0.1);
  EXPECT_GT(viscous.loss, 10.0);  // J
  EXPECT_LT(viscous.energy, 1e-3 * viscous.loss);
  const Drift rubber = drift_of(chain(24, rubber_bushing(), 2e-5), 0.1);
  EXPECT_GT(rubber.loss, 10.0);
  EXPECT_LT(rubber.energy, 2e-3 * rubber.loss);  // the corners of the stops are met within h
}

TEST(DoublePinChain, SpinningPolygonPullsWithTheClosedFormsForce) {
  // 2 T sin(pi / n) = m w^2 R, R sin(pi / n) = l / 2 + T / k + a cos(pi / n): each bushing gives T / k.
  constexpr int n = 40;
  constexpr double spin = 5.0, k = 1e8;
  const System system = chain(n, elastic_bushing(), 5e-5);
  const CompiledTrack& track = system.tracks[0];
  const double s = std::sin(k_pi / n), mw2 = track.mass * spin * spin;
  const double force =
      mw2 * (0.5 * k_length + track.groove * std::cos(k_pi / n)) / (2.0 * s * s) / (1.0 - mw2 / (2.0 * k * s * s));
  State state = polygon(system, 0.5 * k_length + force / k, spin);
  settle_rubber(system, state);
  const Stepper stepper(system, state, {});
  for (int i = 0; i < n; ++i) {
    const Vector3d wanted = -spin * spin * (get_link(state, i).position - k_far);
    // Connectors are placed within 1e-8 m of their balance, 1 N of a bushing; the shoes share what is left.
    EXPECT_LT((get_vector(stepper.acceleration().linear, i) - wanted).norm(), 1e-4) << i;
    EXPECT_LT(get_vector(stepper.acceleration().angular, i).norm(), 1e-2) << i;
    EXPECT_NEAR(get_vector(stepper.work().joint_force_W, i).norm() / force, 1.0, 1e-6) << i;
  }
}

TEST(DoublePinChain, AnEvaluationIsAFunctionOfStateAndMemoryAlone) {
  // What --resume rests on: no start value of the balance is carried from step to step.
  const System system = chain(21, rubber_bushing(), 5e-5);
  Stepper stepper(system, thrown(system, 1.0), {});
  for (int i = 0; i < 50; ++i) ASSERT_EQ(stepper.step(1e9), StepStatus::ok);
  const Acceleration now = stepper.acceleration();
  const Acceleration& again = stepper.reevaluate();
  EXPECT_EQ(now.linear.data(), again.linear.data());
  EXPECT_EQ(now.angular.data(), again.angular.data());
}

/// Mean square difference of link positions [m^2], and of tensions [N^2], between two chains over 20 ms.
struct Difference {
  double tension = 0.0, hinge_moment = 0.0;  // of the mean square fluctuation of the condensed chain
};
Difference difference_to_bodies(double connector_mass) {
  constexpr double k_step = 5e-6, k_duration = 0.02;
  constexpr int n = 24;
  const System condensed = chain(n, viscous_bushing(), k_step),
               bodies = chain(n, viscous_bushing(), k_step, connector_mass);
  Stepper a(condensed, thrown(condensed, 0.1), {}), b(bodies, thrown(bodies, 0.1), {});
  double tension = 0.0, tension_scale = 0.0, moment = 0.0, moment_scale = 0.0;
  while (a.state().time < k_duration) {
    EXPECT_EQ(a.step(k_duration), StepStatus::ok);
    EXPECT_EQ(b.step(k_duration), StepStatus::ok);
    if (a.state().time < 0.25 * k_duration) continue;  // connectors that are bodies start off their balance
    for (int i = 0; i < n; ++i) {
      const double ta = a.work().bushing_force[0][i], tb = b.work().bushing_force[0][i];
      const double ma = a.work().bushing_torque[1][i], mb = b.work().bushing_torque[1][i];
      tension += (ta - tb) * (ta - tb), tension_scale += ta * ta;
      moment += (ma - mb) * (ma - mb), moment_scale += ma * ma;
    }
  }
  return {std::sqrt(tension / tension_scale), std::sqrt(moment / moment_scale)};
}

TEST(DoublePinChain, BodiesOfVanishingMassMoveAsTheCondensedConnector) {
  const Difference heavy = difference_to_bodies(2.0), light = difference_to_bodies(0.5);
  EXPECT_LT(light.tension, 0.05);
  EXPECT_LT(light.hinge_moment, 0.02);
  EXPECT_NEAR(heavy.tension / light.tension, 4.0, 1.5);  // in proportion to the mass
  EXPECT_NEAR(heavy.hinge_moment / light.hinge_moment, 4.0, 1.5);
}

}  // namespace
}  // namespace grouser::test
