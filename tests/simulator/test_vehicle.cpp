#include <gtest/gtest.h>

#include <cmath>

#include "model/errors.h"
#include "simulator/failures.h"
#include "simulator/track_path.h"
#include "simulator/track_watch.h"
#include "tests/support/allocation_count.h"
#include "tests/support/suspension_scene.h"
#include "tests/support/vehicle_scene.h"

namespace grouser::test {
namespace {

TEST(ReferenceVehicle, CountsWhatThePaperCounts) {
  const System& system = reference_scene().system;
  EXPECT_EQ(system.num_bodies(), 189);
  EXPECT_EQ(system.num_revolute_joints(), 36);
  EXPECT_EQ(system.num_bushings(), 152);
  EXPECT_EQ(system.num_degrees_of_freedom(), 954);
  EXPECT_EQ(system.num_prescribed(), 2);
  EXPECT_NEAR(system.weight, 501291.0, 1.0);  // 51 100 kg
  EXPECT_NEAR(45.0 * system.tracks[0].speed_per_sprocket_rate, 13.894, 1e-3);
}

TEST(TrackPath, ClosesWithinTheIdlersReach) {
  const Vehicle vehicle = reference_vehicle();
  const RunningGear& gear = vehicle.side(Side::left);
  const double track = gear.track.num_links * gear.track.pitch;
  // At design the pin line is the track stretched by 50 kN; the idler's arm changes it by 0.527 m a radian (P 2).
  EXPECT_NEAR(path_length(path_wheels(gear, 0.0)), 14.7822, 1e-3);
  const double slope = (path_length(path_wheels(gear, 0.01)) - path_length(path_wheels(gear, -0.01))) / 0.02;
  EXPECT_NEAR(slope, -0.527, 2e-3);
  EXPECT_LT(path_length(path_wheels(gear, 0.2)), track - 0.02);
  EXPECT_GT(path_length(path_wheels(gear, -0.2)), track + 0.02);
}

TEST(TrackPath, PutsPinsAtEqualDistancesRoundTheGear) {
  const Vehicle vehicle = reference_vehicle();
  const std::vector<PathWheel> wheels = path_wheels(vehicle.side(Side::left), 0.0);
  const std::vector<PathPoint> pins = path_pins(wheels, 76);
  const double pitch = path_length(wheels) / 76.0;
  for (std::size_t i = 0; i < pins.size(); ++i) {
    const PathPoint &a = pins[i], &b = pins[(i + 1) % pins.size()];
    const double chord = std::hypot(b.x - a.x, b.z - a.z);
    EXPECT_LT(chord, pitch * (1.0 + 1e-12) + 0.005);  // wraps count more line than their tangent radius turns
    EXPECT_GT(chord, 0.95 * pitch);                   // a chord of the sprocket's 36 degrees
  }
}

TEST(Assembly, StandsOnTheGroundWithItsWeight) {
  const auto& [system, rest] = reference_scene();
  Stepper stepper(system, rest.state, rest.knobs);
  const Field& ground = stepper.work().contact_force_W[static_cast<std::size_t>(Partner::ground)];
  double vertical = 0.0;
  for (const CompiledTrack& track : system.tracks) {
    for (int i = track.offset; i < track.offset + track.num_links; ++i) vertical += ground[2][i];
  }
  EXPECT_NEAR(vertical / system.weight, 1.0, 0.005);
}

TEST(Assembly, ReachesTheAskedPreTensionInTheUpperRun) {
  const auto& [system, rest] = reference_scene();
  const Stepper stepper(system, rest.state, rest.knobs);
  for (const Side side : {Side::left, Side::right}) {
    const SpanTension span = upper_run_tension(system, stepper.state(), stepper.work(), side);
    EXPECT_NEAR(span.mean / system.tracks[static_cast<std::size_t>(index_of(side))].pre_tension, 1.0, 0.05);
    EXPECT_GE(span.joints, 25);                         // about 28 links between sprocket and idler
    EXPECT_LT(span.high - span.low, 0.02 * span.mean);  // uniform in a free span
  }
}

TEST(Assembly, EndsAtRestOnAnEvenKeel) {
  const auto& [system, rest] = reference_scene();
  EXPECT_LT(rest.largest_link_speed, 0.01);  // m/s; the free settling leaves mm/s
  EXPECT_LT(rest.state.chassis.velocity.norm(), 0.005);
  EXPECT_LT(std::abs(rest.ride_height_change), 0.03);
  EXPECT_LT(std::abs(rest.pitch), 0.01);
  EXPECT_EQ(rest.state.time, 0.0);
  EXPECT_NEAR(rest.sides[0].tension, rest.sides[1].tension, 1e-3);  // left and right alike
}

TEST(Assembly, RefusesATrackThatCannotClose) {
  Vehicle vehicle = reference_vehicle();
  for (RunningGear& gear : vehicle.sides) gear.track.num_links = 60;
  try {
    static_cast<void>(assemble(compile(parked(vehicle, rubber_bushing(), 9.81))));
    FAIL() << "60 links do not reach round the running gear";
  } catch (const NumericalError& error) {
    EXPECT_NE(std::string(error.what()).find("60 links"), std::string::npos) << error.what();
  }
}

TEST(Assembly, RefusesAVehicleThatStillMovesWhenItShouldStand) {
  // Friction of 0.9 ahead and 0.3 behind holds 60 % on the average of the wheels' places, but uphill the rear carries
  // more: it slides.
  Scenario scenario = parked(reference_vehicle(), rubber_bushing(), 9.81);
  scenario.terrain.slope = 0.58;
  scenario.terrain.friction = 0.9;
  scenario.terrain.zones = {{{}, -50.0, 0.0, 0.3}};
  scenario.assembly.settle_time = 3.0;
  try {
    static_cast<void>(assemble(compile(scenario)));
    FAIL() << "it slides downhill";
  } catch (const NumericalError& error) {
    EXPECT_NE(std::string(error.what()).find("does not come to rest, a link still moves at"), std::string::npos)
        << error.what();
  }
}

TEST(Vehicle, AGasUnitPressedToNothingEndsTheStepWithItsArm) {
  System system = reference_scene().system;
  system.scenario.integrator.fixed_step = 1e-4;
  State state = reference_scene().rest.state;
  CompiledSuspension& first = system.suspension.front();
  first.unit.gas_volume = 5e-4;  // its crank can press out 7.8e-4
  ASSERT_EQ(first.kind, JointSpring::hydropneumatic);
  const auto volume_left = [&](double bump) {
    return 1.0 - first.unit.piston_area * piston_stroke(first.unit, bump).stroke / first.unit.gas_volume;
  };
  double bump = 0.3;  // rad; the wheel is then above its track
  while (volume_left(bump) > 0.0205) bump += 1e-5;
  state.chassis.angle[first.body] = bump;
  state.chassis.rate[first.body] = 50.0;  // rad/s: 0.5 % of the volume in the step
  Stepper stepper(system, state, reference_scene().rest.knobs);
  EXPECT_EQ(stepper.step(1e9), StepStatus::bottomed);
  EXPECT_EQ(stepper.worst().body, first.body);
  EXPECT_EQ(step_failure(system, stepper, StepStatus::bottomed).rfind("left/arm_1: its gas unit bottomed", 0), 0u);
  EXPECT_EQ(stepper.state().chassis.angle[first.body], bump);  // the last good state is kept
  EXPECT_TRUE(std::isfinite(stepper.acceleration().chassis.joint.norm()));
}

TEST(Vehicle, StaysParked) {
  const auto& [system, rest] = reference_scene();
  const ShortRun run = run_for(system, rest.state, 0.5);
  EXPECT_LT((run.state.chassis.position - rest.state.chassis.position).norm(), 1e-3);
  for (const CompiledTrack& track : system.tracks) {
    for (int i = track.offset; i < track.offset + track.num_links; ++i) {
      EXPECT_LT((get_vector(run.state.position, i) - get_vector(rest.state.position, i)).norm(), 1e-3);
    }
  }
}

TEST(Vehicle, StartsOffWithAClosedEnergyBook) {
  const ShortRun run = run_for(driven(4.5, 4.5), reference_scene().rest.state, 0.4);
  EXPECT_GT(run.book.absolute_input, 5e3);         // J
  EXPECT_LT(run.book.residual_fraction(), 1e-3);   // more would be hidden chatter (P 5)
  EXPECT_GT(run.state.chassis.velocity.x(), 0.3);  // 1.8 rad/s x 0.309 m = 0.56 m/s, less the tracks' stretch
  EXPECT_LT(run.state.chassis.velocity.x(), 0.8);
}

TEST(Vehicle, HalvingTheStepQuartersTheEnergyResidual) {
  const auto residual = [](double step) {
    System system = driven(9.0, 9.0);
    system.scenario.integrator.fixed_step = step;
    return std::abs(run_for(system, reference_scene().rest.state, 0.3).book.residual());
  };
  const double coarse = residual(6e-5), fine = residual(3e-5);
  EXPECT_GT(coarse / fine, 3.0);  // h^2, but for the corners of stops and of touching
  EXPECT_LT(coarse / fine, 5.5);
}

TEST(Vehicle, AStepTakesNothingFromTheHeap) {
  if (!allocations_are_counted()) GTEST_SKIP() << "a sanitizer owns the heap";
  System system = driven(4.5, 4.5);
  system.tracks[0].bushing[0].yield_growth = 1e5;  // stops of constant and of growing yield
  Stepper stepper(system, reference_scene().rest.state, reference_scene().rest.knobs);
  for (int i = 0; i < 10; ++i) ASSERT_EQ(stepper.step(1e9), StepStatus::ok);
  const long before = allocation_count();
  bool ok = true;
  for (int i = 0; i < 100; ++i) ok = ok && stepper.step(1e9) == StepStatus::ok;
  EXPECT_EQ(allocation_count() - before, 0);
  EXPECT_TRUE(ok);
  const std::vector<double> proof(1000);  // the counter counts
  EXPECT_GT(allocation_count(), before);
}

TEST(Vehicle, AStepTooLargeEndsAsDivergenceWithTheLastGoodStateKept) {
  System system = driven(4.5, 4.5);
  system.scenario.integrator.fixed_step = 6e-4;
  Stepper stepper(system, reference_scene().rest.state, reference_scene().rest.knobs);
  StepStatus status = StepStatus::ok;
  for (int i = 0; i < 5000 && status == StepStatus::ok; ++i) status = stepper.step(1e9);
  EXPECT_TRUE(status == StepStatus::not_finite || status == StepStatus::turned_too_far);
  EXPECT_TRUE(std::isfinite(stepper.state().chassis.position.norm()));
}

TEST(Vehicle, AStepThatCannotMeetItsToleranceEndsAsUnderflow) {
  System system = driven(45.0, 45.0);
  system.scenario.integrator.velocity_tolerance = 1e-9;
  system.scenario.integrator.min_step = 1e-5;
  Stepper stepper(system, reference_scene().rest.state, reference_scene().rest.knobs);
  StepStatus status = StepStatus::ok;
  for (int i = 0; i < 5000 && status == StepStatus::ok; ++i) status = stepper.step(1e9);
  EXPECT_EQ(status, StepStatus::underflow);
  EXPECT_GE(stepper.worst().link, 0);
}

}  // namespace
}  // namespace grouser::test
