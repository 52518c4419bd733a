#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "simulator/bushings.h"
#include "tests/support/chains.h"
#include "tests/support/closed_forms.h"

/// Worn bushings with radial play, and hinges that a stop keeps from bending back.
namespace grouser::test {
namespace {

constexpr double k_clearance = 1.2e-3, k_stop_angle = 0.2, k_stop_stiffness = 2e5;  // m, rad, N m/rad

Vehicle with_limits(Vehicle vehicle) {
  for (RunningGear& gear : vehicle.sides) {
    gear.track.clearance = k_clearance;
    gear.track.stop_angle = k_stop_angle;
    gear.track.stop_stiffness = k_stop_stiffness;
  }
  return vehicle;
}

/// Two links and the joint between them.
struct LimitedJoint {
  System system = compile(parked(with_limits(bare_vehicle(2)), elastic_bushing(), 0.0));
  State state = strewn_state(system);
  Workspace work = make_workspace(system);
  LimitedJoint() {
    system.tracks[0].num_links = 1;
    system.tracks[1].num_links = 0;
  }
  void place(const LinkMotion& a, const LinkMotion& b) {
    set_link(state, 0, a);
    set_link(state, 1, b);
    work.energy = {};
    place_links(system, state, work);
    const History before = state.history;
    bushing_forces(system, {}, before, 0.0, state, work);
  }
  /// The pin (x, 0, z) off the groove, the hinge bent by `angle`.
  void bend(double x, double z, double angle) {
    const double half = system.tracks[0].groove;
    const Quaterniond q(Eigen::AngleAxisd(angle, Vector3d::UnitY()));
    place({}, {Vector3d(half + x, 0.0, z) + q * Vector3d(half, 0.0, 0.0), q});
  }
  [[nodiscard]] double power() const {
    const LinkMotion a = get_link(state, 0), b = get_link(state, 1);
    return get_vector(work.joint_force_W, 0).dot(b.velocity - a.velocity) +
           get_vector(work.joint_torque_next_W, 0).dot(b.orientation * b.angular_velocity) -
           get_vector(work.joint_torque_own_W, 0).dot(a.orientation * a.angular_velocity);
  }
};

TEST(JointLimits, ForcesAreTheGradientOfTheStoredEnergy) {
  LimitedJoint joint;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto vector = [&](double size) -> Vector3d {
    return size * Vector3d(unit(random), unit(random), unit(random));
  };
  int in_play = 0, at_stop = 0;
  for (int n = 0; n < 1000; ++n) {
    const LinkMotion a{vector(2.0), quaternion_exp(vector(2.0)), vector(3.0), vector(20.0)};
    const Quaterniond turn(Eigen::AngleAxisd(0.5 * unit(random), Vector3d::UnitY()));
    LinkMotion b{Vector3d::Zero(), a.orientation * turn, vector(3.0), vector(20.0)};
    const double half = joint.system.tracks[0].groove;
    b.position = a.position + a.orientation * (Vector3d(half, 0.0, 0.0) + vector(3e-3)) +
                 b.orientation * Vector3d(half, 0.0, 0.0);
    const auto stored = [&](double dt) {
      const auto moved = [dt](LinkMotion link) {
        link.position += dt * link.velocity;
        link.orientation = link.orientation * quaternion_exp(dt * link.angular_velocity);
        return link;
      };
      joint.place(moved(a), moved(b));
      return joint.work.energy.bushing;
    };
    constexpr double k_dt = 1e-7;
    const double energy_rate = (stored(k_dt) - stored(-k_dt)) / (2.0 * k_dt);
    const double energy = stored(0.0), power = joint.power();
    // Cancellation in the difference quotient; at the corner of play or stop it errs by half a stiffness times dt.
    ASSERT_NEAR(power, -energy_rate, 1e-7 * (std::abs(power) + energy / 1e-3) + 150.0) << n;
    in_play += joint.work.joint_stiffness[0][0] == 0.0;
    at_stop += joint.state.history.deflection[4][0] > k_stop_angle;
  }
  EXPECT_GT(in_play, 30);
  EXPECT_GT(at_stop, 100);
}

TEST(JointLimits, PinIsFreeWithinItsPlayAndFeelsTheRubberBeyond) {
  LimitedJoint joint;
  for (const double direction : {0.0, 0.7, 2.0, -2.5}) {
    const double c = std::cos(direction), s = std::sin(direction);
    joint.bend(0.99 * k_clearance * c, 0.99 * k_clearance * s, 0.0);
    EXPECT_EQ(joint.work.bushing_force[0][0], 0.0);
    EXPECT_EQ(joint.work.bushing_force[2][0], 0.0);
    const double over = 4e-4;
    joint.bend((k_clearance + over) * c, (k_clearance + over) * s, 0.0);
    EXPECT_NEAR(joint.work.bushing_force[0][0], 1e8 * over * c, 1e-6);  // equal stiffness all round: radial
    EXPECT_NEAR(joint.work.bushing_force[2][0], 1e8 * over * s, 1e-6);
    EXPECT_NEAR(joint.work.energy.bushing, 0.5 * 1e8 * over * over, 1e-9);
  }
}

TEST(JointLimits, HingeBentBackLeansOnItsStopAndWrapsInwardFreely) {
  LimitedJoint joint;
  for (const double angle : {-1.0, -0.3, 0.1, 0.19, 0.25, 0.6}) {  // inward is negative
    joint.bend(2e-3, 0.0, angle);
    const double over = std::max(0.0, angle - k_stop_angle);
    EXPECT_NEAR(joint.work.bushing_torque[1][0], 1500.0 * angle + k_stop_stiffness * over, 1e-8) << angle;
  }
}

TEST(JointLimits, SpinningPolygonOfWornJointsIsLongerByTheirPlay) {
  constexpr int n = 76;
  constexpr double spin = 5.0, k = 1e8;
  Vehicle vehicle = bare_vehicle(n);
  for (RunningGear& gear : vehicle.sides) gear.track.clearance = k_clearance;
  const System system = compile(parked(vehicle, elastic_bushing(), 0.0));
  const CompiledTrack& track = system.tracks[0];
  // T = m w^2 R / (2 sin(pi / n)), R = p / (2 tan(pi / n)) + (T / k + c) / (2 sin(pi / n)).
  const double half = k_pi / n, s = std::sin(half), mw2 = track.mass * spin * spin;
  const double force = spinning_polygon_force(n, track.pitch + k_clearance / std::cos(half), track.mass, spin, k);
  const double radius = 0.5 * track.pitch / std::tan(half) + 0.5 * (force / k + k_clearance) / s;
  EXPECT_NEAR(force, mw2 * radius / (2.0 * s), 1e-6 * force);
  State state = strewn_state(system);
  for (const CompiledTrack& t : system.tracks) {
    place_polygon(t, far_from_chassis() + Vector3d(0.0, 50.0 * index_of(t.side), 0.0), radius, spin, state);
  }
  relax_rubber(system, state);
  const Stepper stepper(system, state, {});
  for (int i = 0; i < n; ++i) {
    const Vector3d wanted = -spin * spin * (get_link(state, i).position - far_from_chassis());
    EXPECT_LT((get_vector(stepper.acceleration().linear, i) - wanted).norm(), 1e-5);  // 1e-13 m of 1 km
  }
}

TEST(JointLimits, HangingChainOfWornJointsIsLongerByTheirPlayAndCarriesItsWeight) {
  // Link i hangs below link i - 1, which is held: the pull grows downwards to up by a weight a joint.
  constexpr int n = 12;
  constexpr double k = 1e8, g = 9.81;
  Vehicle vehicle = bare_vehicle(n);
  for (RunningGear& gear : vehicle.sides) gear.track.clearance = k_clearance;
  System system = compile(parked(vehicle, elastic_bushing(), g));
  system.tracks[0].num_links = n - 1;  // joints 0 .. n - 2; there is none between the last link and the first
  system.tracks[1].num_links = 0;
  const CompiledTrack& track = system.tracks[0];
  State state = strewn_state(system);
  const Quaterniond down(Eigen::AngleAxisd(0.5 * k_pi, Vector3d::UnitY()));  // x of a link along -z
  double z = 0.0;
  for (int i = 0; i < n; ++i) {
    const double pull = (n - 1 - i) * track.mass * g;  // of the joint below link i
    set_link(state, i, {Vector3d(0.0, 0.0, z), down});
    z -= track.pitch + k_clearance + pull / k;
  }
  Workspace work = make_workspace(system);
  place_links(system, state, work);
  const History before = state.history;
  bushing_forces(system, {}, before, 0.0, state, work);
  for (int i = 0; i + 1 < n; ++i) {
    EXPECT_NEAR(work.bushing_force[0][i], (n - 1 - i) * track.mass * g, 1e-5);
    EXPECT_NEAR(work.joint_force_W[2][i], (n - 1 - i) * track.mass * g, 1e-5);
  }
}

}  // namespace
}  // namespace grouser::test
