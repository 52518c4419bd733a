#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "simulator/assembly.h"
#include "simulator/energy_book.h"

/// Vehicles of other makers' models as data: nothing in the simulator knows the reference vehicle.
namespace grouser::test {
namespace {

Scenario peer(const std::string& name) {
  return read_scenario(GROUSER_SOURCE_DIR "/test_data/scenarios/" + name + ".json");
}

/// Vertical ground force on one track at rest [N].
double ground_force(const System& system, const Workspace& work, Side side) {
  const CompiledTrack& track = system.tracks[static_cast<std::size_t>(index_of(side))];
  const double* vertical = work.contact_force_W[static_cast<std::size_t>(Partner::ground)][2] + track.offset;
  double sum = 0.0;
  for (int i = 0; i < track.num_links; ++i) sum += vertical[i];
  return sum;
}

void expect_at_rest(const System& system) {
  const Assembled rest = assemble(system);
  for (const Side side : {Side::left, Side::right}) {
    const auto s = static_cast<std::size_t>(index_of(side));
    // What the settling leaves: measured 7e-5 of the tension, 1e-6 of the weight.
    EXPECT_NEAR(rest.sides[s].tension / system.tracks[s].pre_tension, 1.0, 1e-3);
  }
  const Stepper stepper(system, rest.state, rest.knobs);
  const double left = ground_force(system, stepper.work(), Side::left),
               right = ground_force(system, stepper.work(), Side::right);
  EXPECT_NEAR((left + right) / system.weight, 1.0, 1e-4);
  // The hull stands in the middle; the longer track is one link (0.16 % of the weight at most) heavier.
  EXPECT_NEAR(left / right, 1.0, 0.02);
}

TEST(PeerVehicle, M113HasTheMassAndTheBodiesOfItsSourceAndStands) {
  const System system = compile(peer("m113"));
  EXPECT_EQ(system.num_bodies(), 154);
  EXPECT_NEAR(system.weight / 9.81, 11342.86, 0.01);  // kg, as the source adds up
  EXPECT_EQ(system.tracks[0].num_links, 63);
  EXPECT_EQ(system.tracks[1].num_links, 64);
  expect_at_rest(system);
}

TEST(PeerVehicle, MarderHasTheMassAndTheBodiesOfItsSourceAndStands) {
  const System system = compile(peer("marder"));
  EXPECT_EQ(system.num_bodies(), 192);
  EXPECT_NEAR(system.weight / 9.81, 29313.18, 0.01);
  EXPECT_EQ(system.tracks[0].num_links, 77);
  EXPECT_EQ(system.tracks[1].num_links, 78);
  expect_at_rest(system);
}

/// The vehicle in a mirror: left and right exchanged.
Vehicle mirrored(const Vehicle& vehicle) {
  Vehicle out = vehicle;
  std::swap(out.sides[0], out.sides[1]);
  const auto flip = [](auto&... vectors) { ((vectors.y() = -vectors.y()), ...); };
  flip(out.chassis.center_of_mass);
  for (RunningGear& gear : out.sides) {
    gear.track_center_y = -gear.track_center_y;
    flip(gear.sprocket.center, gear.sprocket.body.center_of_mass, gear.idler.pivot, gear.idler.arm.center_of_mass,
         gear.idler.wheel.center, gear.idler.wheel.body.center_of_mass, gear.track.link.center_of_mass);
    for (DiscPair& roller : gear.support_rollers) flip(roller.center, roller.body.center_of_mass);
    for (Station& station : gear.stations)
      flip(station.pivot, station.arm.center_of_mass, station.wheel.center, station.wheel.body.center_of_mass);
    for (Vector3d& point : gear.track.ground_points) flip(point);
  }
  return out;
}

struct Driven {
  Assembled rest;
  State end;
};
Driven drive(const Scenario& scenario, double duration) {
  const System system = compile(scenario);
  Driven driven{assemble(system), {}};
  Stepper stepper(system, driven.rest.state, driven.rest.knobs);
  while (stepper.state().time < duration) {
    if (stepper.step(duration) != StepStatus::ok) throw std::runtime_error("the run failed");
  }
  driven.end = stepper.state();
  return driven;
}

void expect_mirrored(const System& system, const State& a, const State& b, double tolerance) {
  const TreeState &p = a.chassis, &q = b.chassis;
  EXPECT_NEAR(p.position.x(), q.position.x(), tolerance);
  EXPECT_NEAR(p.position.y(), -q.position.y(), tolerance);
  EXPECT_NEAR(p.position.z(), q.position.z(), tolerance);
  EXPECT_NEAR(p.orientation.z(), -q.orientation.z(), tolerance);
  EXPECT_NEAR(p.velocity.x(), q.velocity.x(), 10.0 * tolerance);
  EXPECT_NEAR(p.angular_velocity.z(), -q.angular_velocity.z(), 10.0 * tolerance);
  const System other = compile([&] {
    Scenario scenario = system.scenario;
    scenario.vehicle = mirrored(scenario.vehicle);
    return scenario;
  }());
  for (std::size_t s = 0; s < k_num_sides; ++s) {
    const CompiledTrack &here = system.tracks[s], &there = other.tracks[1 - s];
    ASSERT_EQ(here.num_links, there.num_links);
    for (int k = 0; k < here.num_links; ++k) {
      for (int c = 0; c < 3; ++c) {
        const double sign = c == 1 ? -1.0 : 1.0;
        ASSERT_NEAR(a.position[c][here.offset + k], sign * b.position[c][there.offset + k], tolerance) << k;
      }
    }
  }
}

TEST(PeerVehicle, ExchangedSidesGiveTheMirroredMotion) {
  // 63 links on the left, 64 on the right: it drifts to one side, its mirror image to the other.
  Scenario scenario = peer("m113");
  scenario.assembly.settle_time = 3.0;
  for (DriveTable& table : scenario.drive) table.time = {0.0, 1.0};  // 30 rad/s^2 asked
  const double duration = 0.3;
  const Driven one = drive(scenario, duration);
  const System system = compile(scenario);
  scenario.vehicle = mirrored(scenario.vehicle);
  const Driven other = drive(scenario, duration);
  // Round-off, which contacts magnify; the drift itself is much larger.
  expect_mirrored(system, one.rest.state, other.rest.state, 1e-9);
  expect_mirrored(system, one.end, other.end, 1e-8);
  EXPECT_GT(std::abs(one.end.chassis.orientation.z()), 1e-6);
}

TEST(PeerVehicle, FrictionDoesNotShakeALightIdler) {
  // Ten contacts of 2e4 N s/m on an idler of 1.12 kg m^2: steps that follow the links alone are 7e-5 s long, at the
  // onset of its shaking, and lose 1.3 J of friction in 0.2 s at rest. Measured here: 5e-5 J.
  const System system = compile(peer("m113"));
  const Assembled rest = assemble(system);
  EXPECT_LT(rest.largest_link_speed, 2e-4);  // m/s; 1.6e-3 when shaken
  Stepper stepper(system, rest.state, rest.knobs);
  ASSERT_GE(stepper.work().bounding.body, 0);
  const auto bounding = static_cast<std::size_t>(stepper.work().bounding.body);
  EXPECT_THAT(system.tree.bodies[bounding].name, testing::HasSubstr("idler"));
  EnergyBook book = open_book(stepper.work().energy);
  while (stepper.state().time < 0.2) {
    ASSERT_EQ(stepper.step(0.2), StepStatus::ok);
    book_step(book, stepper.work().energy, stepper.last_step());
  }
  EXPECT_LT(std::abs(book.residual()), 1e-3);  // J
}

}  // namespace
}  // namespace grouser::test
