#include <gtest/gtest.h>

#include <cmath>

#include "model/errors.h"
#include "simulator/bushings.h"
#include "simulator/contacts.h"
#include "simulator/energy_book.h"
#include "simulator/start_pose.h"
#include "tests/support/scenes.h"

/// One free link on ground that is not level.
namespace grouser::test {
namespace {

constexpr int k_link = 2;
constexpr double k_place = 20.0;  // m ahead of the chassis, which falls freely meanwhile

System system_on(const Terrain& terrain, double step, double restitution = 0.835) {
  Vehicle vehicle = bare_vehicle(8);
  for (RunningGear& gear : vehicle.sides) gear.track.ground_contact.restitution = restitution;
  Scenario scenario = parked(vehicle, no_bushing(), 9.81);
  scenario.terrain = terrain;
  scenario.integrator.fixed_step = step;
  return compile(scenario);
}

/// A link that stands on the plane of slope `angle`, sunk in as its weight asks.
State link_on_slope(const System& system, double angle) {
  const CompiledTrack& track = system.tracks[0];
  const Vector3d normal(-std::sin(angle), 0.0, std::cos(angle));
  const double depth = track.mass * 9.81 * std::cos(angle) / (6.0 * track.ground.stiffness);
  LinkMotion link;
  link.position = Vector3d(k_place, 0.0, k_place * std::tan(angle)) + (track.ground_depth - depth) * normal;
  link.orientation = Quaterniond(Eigen::AngleAxisd(-angle, Vector3d::UnitY()));
  State state = strewn_state(system);
  set_link(state, k_link, link);
  return state;
}

TEST(Slope, HoldsALinkBelowTheFrictionAngleWithoutCreep) {
  Terrain terrain;
  terrain.slope = 0.6;  // friction holds up to 0.7
  const System system = system_on(terrain, 5e-5);
  Stepper stepper(system, link_on_slope(system, std::atan(0.6)), {});
  const auto mean_place = [&](double until) {
    double sum = 0.0;
    int count = 0;
    while (stepper.state().time < until) {
      EXPECT_EQ(stepper.step(1e9), StepStatus::ok);
      if (stepper.state().time > until - 0.2) sum += get_link(stepper.state(), k_link).position.x(), ++count;
    }
    return sum / count;
  };
  const double early = mean_place(1.0), late = mean_place(2.0);
  EXPECT_LT(std::abs(late - early), 1e-7);  // a regularised law creeps by 10 mm/s and more here
}

TEST(Slope, LetsALinkSlideWithCoulombsAcceleration) {
  const double angle = k_pi / 4.0;
  Terrain terrain;
  terrain.slope = 1.0;
  const System system = system_on(terrain, 5e-5);
  Stepper stepper(system, link_on_slope(system, angle), {});
  const Vector3d down(-std::cos(angle), 0.0, -std::sin(angle));
  const auto speed_at = [&](double time) {
    while (stepper.state().time < time) EXPECT_EQ(stepper.step(1e9), StepStatus::ok);
    return down.dot(get_link(stepper.state(), k_link).velocity);
  };
  const double early = speed_at(0.3), from = stepper.state().time;
  const double gained = speed_at(1.3) - early, time = stepper.state().time - from;
  // The link nods on its six points, so the normal force is steady in the mean only: 2 %, as on tilted gravity.
  EXPECT_NEAR(gained / (9.81 * (std::sin(angle) - 0.7 * std::cos(angle)) * time), 1.0, 0.02);
}

TEST(HalfRound, PushesAPointAlongItsRadius) {
  Terrain terrain;
  terrain.obstacles = {{ObstacleKind::half_round, {}, k_place, 0.2}};
  const System system = system_on(terrain, 1e-4);
  const CompiledTrack& track = system.tracks[0];
  const double depth = 1e-3;
  for (const double angle : {0.3, 0.9, 1.4, 2.2}) {  // from the ground ahead, round to behind
    // The points at the link's front touch the cylinder at `angle`; the others stand above or beside it.
    const Vector3d touch(k_place + (0.2 - depth) * std::cos(angle), 0.0, (0.2 - depth) * std::sin(angle));
    LinkMotion link;
    const double tilt = angle < k_pi / 2.0 ? -0.5 : 0.5;  // the other points lifted clear
    link.orientation = Quaterniond(Eigen::AngleAxisd(tilt, Vector3d::UnitY()));
    const Vector3d point_L = angle < k_pi / 2.0 ? track.ground_points.front() : track.ground_points.back();
    link.position = touch - link.orientation * Vector3d(point_L.x(), 0.0, point_L.z());
    State state = strewn_state(system);
    set_link(state, k_link, link);
    Workspace work = make_workspace(system);
    place_links(system, state, work);
    const History before = state.history;
    ground_contacts(system, before, 0.0, state, work);
    const Vector3d force = get_vector(work.contact_force_W[static_cast<std::size_t>(Partner::ground)], k_link);
    const Vector3d radial(std::cos(angle), 0.0, std::sin(angle));
    const double points = std::round(force.norm() / (track.ground.stiffness * depth));  // of one row: 1 to 3
    ASSERT_GE(points, 1.0) << angle;
    EXPECT_LT((force - points * track.ground.stiffness * depth * radial).norm(), 1e-6 * force.norm()) << angle;
  }
}

TEST(RoughGround, WithoutFrictionAndLossKeepsTheEnergyOfALinkThatBouncesOverIt) {
  // The force is the gradient of the contact energy on curved ground too, so only the step's own error remains: h^2.
  Terrain terrain;
  terrain.friction = 0.0;
  terrain.road = RandomRoad{'F', 3, 0.0, 60.0};
  terrain.obstacles = {{ObstacleKind::trapezoid, {}, k_place + 1.0, 0.1, 0.8, 0.2}};
  const auto gained = [&](double step) {
    const System system = system_on(terrain, step, 1.0);
    State state = strewn_state(system);
    LinkMotion link;
    link.position = {k_place, 0.0, system.ground.at(k_place, 0.0).z + 0.2};
    link.velocity = {2.0, 0.3, 0.0};
    set_link(state, k_link, link);
    Stepper stepper(system, state, {});
    const EnergyTerms start = stepper.work().energy;
    while (stepper.state().time < 0.6) EXPECT_EQ(stepper.step(1e9), StepStatus::ok);
    return stepper.work().energy.stored() - start.stored();
  };
  const double scale = 0.5 * 28.0 * 4.0 + 28.0 * 9.81 * 0.2;  // J, of the link
  // Measured 5e-6; taking depth at the point's own place, not at the foot of its normal, loses 5e-4 at any step.
  EXPECT_LT(std::abs(gained(2e-5)), 2e-5 * scale);
}

TEST(FrictionZones, ChangeTheDecelerationWhereTheyBegin) {
  Terrain terrain;
  terrain.friction = 0.7;
  terrain.zones = {{{}, k_place + 2.0, k_place + 50.0, 0.2}};
  const System system = system_on(terrain, 5e-5);
  const CompiledTrack& track = system.tracks[0];
  State state = strewn_state(system);
  LinkMotion link;
  link.position = {k_place, 0.0, track.ground_depth - track.mass * 9.81 / (6.0 * track.ground.stiffness)};
  link.velocity = {8.0, 0.0, 0.0};
  set_link(state, k_link, link);
  Stepper stepper(system, state, {});
  const auto loss = [&](double begin, double end) {  // of v^2 / 2 over a metre: mu g
    const auto square_at = [&](double x) {
      while (get_link(stepper.state(), k_link).position.x() < x) EXPECT_EQ(stepper.step(1e9), StepStatus::ok);
      const LinkMotion now = get_link(stepper.state(), k_link);
      return 0.5 * now.velocity.x() * now.velocity.x();
    };
    const double before = square_at(begin);
    return (before - square_at(end)) / (end - begin);
  };
  // The link nods while it slides: the mean normal force over the way is its weight to some 3 %.
  EXPECT_NEAR(loss(k_place + 0.5, k_place + 1.9) / (0.7 * 9.81), 1.0, 0.03);
  EXPECT_NEAR(loss(k_place + 2.2, k_place + 3.6) / (0.2 * 9.81), 1.0, 0.03);
}

TEST(FrictionZones, ChangeUnderTheMiddleOfALink) {
  // A zone's edge runs along under the link: four of its points slide on 0.7, the two on the right on 0.2. It feels the
  // sum, and the moment about z that the difference makes.
  constexpr double k_aside = 0.05;  // m
  Terrain terrain;
  terrain.friction = 0.2;
  terrain.zones = {{Side::left, -50.0, 50.0, 0.7}};
  const System system = system_on(terrain, 1e-5);
  const CompiledTrack& track = system.tracks[0];
  State state = strewn_state(system);
  LinkMotion link;
  const double depth = track.mass * 9.81 / (6.0 * track.ground.stiffness);
  link.position = {k_place, k_aside, track.ground_depth - depth};
  link.velocity = {8.0, 0.0, 0.0};
  set_link(state, k_link, link);
  Stepper sliding(system, state, {});
  while (sliding.state().time < 2e-4) ASSERT_EQ(sliding.step(1e9), StepStatus::ok);  // 1.6 mm: all bristles slide
  const double per_point = track.mass * 9.81 / 6.0;
  double drag = 0.0, moment = 0.0;
  for (const Vector3d& p : track.ground_points) {
    const double friction = p.y() + k_aside > 0.0 ? 0.7 : 0.2;
    drag += friction * per_point;
    moment += friction * per_point * p.y();
  }
  EXPECT_NEAR(-track.mass * sliding.acceleration().linear[0][k_link], drag, 0.02 * drag);
  EXPECT_NEAR(track.inertia.z() * sliding.acceleration().angular[2][k_link], moment, 0.02 * moment);
}

TEST(StartPose, StandsOnTheSlopeItStartsOn) {
  Scenario scenario = parked(reference_vehicle(), elastic_bushing(), 9.81);
  scenario.terrain.slope = 0.3;
  scenario.terrain.cross_slope = -0.1;
  const StartPose pose = start_pose(compile(scenario));
  EXPECT_LT((pose.rotation.col(2) - Vector3d(-0.3, 0.1, 1.0).normalized()).norm(), 1e-12);
  EXPECT_LT((pose.rotation.col(0) - Vector3d(1.0, 0.0, 0.3).normalized()).norm(), 1e-12);
  EXPECT_LT(pose.position.norm(), 1e-12);
  EXPECT_LT((pose.rotation.transpose() * pose.rotation - Matrix3d::Identity()).norm(), 1e-14);
}

TEST(StartPose, RefusesASlopeThatFrictionCannotHold) {
  Scenario scenario = parked(reference_vehicle(), elastic_bushing(), 9.81);
  scenario.terrain.slope = 0.8;
  EXPECT_THROW(static_cast<void>(start_pose(compile(scenario))), NumericalError);
}

}  // namespace
}  // namespace grouser::test
