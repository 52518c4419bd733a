#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cfenv>
#include <limits>

#include "simulator/failures.h"
#include "tests/support/vehicle_scene.h"

/// What a run that fails says about itself: the part, the quantity, its value, and what to do. Each failure is brought
/// about by writing a number that no file could hold into the state or the masses of a sound vehicle.
namespace grouser::test {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::StartsWith;

constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();

/// Traps would end the program where a number first is none.
class Failure : public testing::Test {
 protected:
  void SetUp() override {
    if (fegetexcept() != 0) GTEST_SKIP() << "floating-point traps are on";
  }
};

struct FailingVehicle {
  System system = reference_scene().system;
  State state = reference_scene().rest.state;
  /// Steps until one fails, and returns what it says.
  std::string failure(StepStatus expected) const {
    Stepper stepper(system, state, reference_scene().rest.knobs);
    StepStatus status = StepStatus::ok;
    for (int i = 0; i < 5000 && status == StepStatus::ok; ++i) status = stepper.step(1e9);
    EXPECT_EQ(status, expected);
    return step_failure(system, stepper, status);
  }
  std::string failure() const { return failure(StepStatus::not_finite); }
};

TEST_F(Failure, NamesTheLinkWhoseVelocityIsNoNumber) {
  FailingVehicle vehicle;
  vehicle.state.velocity[1][vehicle.system.tracks[1].offset + 17] = k_nan;
  EXPECT_THAT(vehicle.failure(),
              StartsWith("link 17 of the right track: its velocity along y is nan m/s: the run diverged; look there"));
}

TEST_F(Failure, NamesTheLinkWhoseTurningIsNoNumber) {
  FailingVehicle vehicle;
  vehicle.state.angular_velocity[1][5] = k_nan;
  EXPECT_THAT(vehicle.failure(),
              StartsWith("link 5 of the left track: its angular velocity about y is nan rad/s: the run diverged;"));
}

TEST_F(Failure, NamesTheJointWhoseRateIsInfinite) {
  FailingVehicle vehicle;
  const int arm = vehicle.system.suspension.front().body;
  vehicle.state.chassis.rate[arm] = std::numeric_limits<double>::infinity();
  EXPECT_THAT(vehicle.failure(),
              StartsWith("left/arm_1: its angular velocity about its joint is inf rad/s: the run diverged;"));
}

TEST_F(Failure, NamesTheChassis) {
  FailingVehicle vehicle;
  vehicle.state.chassis.angular_velocity.z() = k_nan;
  EXPECT_THAT(vehicle.failure(),
              StartsWith("the chassis: its angular velocity about z is nan rad/s: the run diverged;"));
}

TEST_F(Failure, NamesTheForceThatIsTheFirstToBeNoNumber) {
  FailingVehicle vehicle;  // a ground whose stiffness times its depth passes the largest number
  vehicle.system.tracks[0].ground.stiffness = 1e308;
  vehicle.state.position[2][40] -= 1e3;
  EXPECT_THAT(vehicle.failure(), ContainsRegex("contact force of the ground along z is inf N"));
}

TEST_F(Failure, NamesTheJointWithoutInertia) {
  FailingVehicle vehicle;
  for (TreeBody& body : vehicle.system.tree.bodies) {
    if (body.name != "right/roller_2") continue;
    body.mass = 1e-320;
    body.inertia = 1e-320 * Matrix3d::Identity();
  }
  EXPECT_THAT(vehicle.failure(),
              AllOf(StartsWith("right/roller_2: its inertia about its joint is 1e-320 kg m2: the mass "
                               "matrix is singular; give it"),
                    HasSubstr("the mass and inertia of a real body")));
}

TEST_F(Failure, NamesWhatTurnsTooFarAndTheStepThatIsTooLong) {
  FailingVehicle vehicle;
  vehicle.system = driven(4.5, 4.5);
  vehicle.system.scenario.integrator.fixed_step = 6e-4;
  EXPECT_THAT(vehicle.failure(StepStatus::turned_too_far),
              AllOf(ContainsRegex("^link [0-9]+ of the (left|right) track: its angular velocity about [xyz] is "
                                  "-?[0-9.e+]+ rad/s, more than half a radian in a step of 0.6 ms"),
                    ContainsRegex("reduce integrator.fixed_step \\(0.6 ms\\) or leave it out: the step is bounded by "
                                  "link [0-9]+ of the (left|right) track, which is stable below 0.1[0-9]* ms only")));
}

TEST_F(Failure, NamesTheJumpThatNoStepFollows) {
  FailingVehicle vehicle;
  vehicle.system = driven(45.0, 45.0);
  vehicle.system.scenario.integrator.velocity_tolerance = 1e-9;
  vehicle.system.scenario.integrator.min_step = 1e-5;
  EXPECT_THAT(vehicle.failure(StepStatus::underflow),
              AllOf(ContainsRegex("^link [0-9]+ of the (left|right) track: its (angular )?acceleration (along|about) "
                                  "[xyz] jumps by -?[0-9.e+]+ (m|rad)/s2 within the least step"),
                    HasSubstr("(integrator.min_step, 0.01 ms)"), HasSubstr("step underflow; look there")));
}

TEST_F(Failure, NamesThePartThatIsTooStiffForTheLeastStep) {
  FailingVehicle vehicle;
  vehicle.system.scenario.integrator.min_step = 2e-4;
  vehicle.system.scenario.integrator.max_step = 3e-4;
  EXPECT_THAT(vehicle.failure(StepStatus::underflow),
              ContainsRegex("integrator.min_step \\(0.2 ms\\) is too long for link [0-9]+ of the (left|right) track, "
                            "which is stable below 0.1[0-9]* ms only; it is too stiff for its mass and inertia"));
}

TEST_F(Failure, IsNoneWhereASmallerStepFindsNumbers) {
  FailingVehicle vehicle;  // in the air; a link falls so fast that a whole step, but no fifth of it, ends in the ground
  vehicle.system.tracks[0].ground.stiffness = 1e308;
  vehicle.system.scenario.integrator.velocity_tolerance = vehicle.system.scenario.integrator.displacement_tolerance =
      1e30;
  const int links = vehicle.system.link_array_length;
  for (int i = 0; i < links; ++i) vehicle.state.position[2][i] += 3.0;
  vehicle.state.chassis.position.z() += 3.0;
  Stepper probe(vehicle.system, vehicle.state, reference_scene().rest.knobs);
  ASSERT_EQ(probe.step(1e9), StepStatus::ok);
  vehicle.state.velocity[2][40] = -10.0 / probe.last_step();
  Stepper stepper(vehicle.system, vehicle.state, reference_scene().rest.knobs);
  EXPECT_EQ(stepper.step(1e9), StepStatus::ok);
  EXPECT_EQ(stepper.rejected(), 1);
  EXPECT_LT(stepper.last_step(), 0.3 * probe.last_step());
}

}  // namespace
}  // namespace grouser::test
