#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "simulator/drive.h"
#include "simulator/energy_book.h"
#include "tests/support/scenes.h"

/// What turns the sprockets, on a chassis held fast with its tracks far away.
namespace grouser::test {
namespace {

System held_vehicle(const DriveTable& drive) {
  Scenario scenario = parked(bare_vehicle(8), no_bushing(), 9.81);
  scenario.drive.fill(drive);
  scenario.integrator.fixed_step = 1e-3;
  System system = compile(scenario);
  system.tree.base_fixed = true;
  return system;
}

double inertia(const System& system, int body) {
  return system.tree.bodies[static_cast<std::size_t>(body)].inertia(1, 1);
}

DriveTable torque_table(std::vector<double> time, std::vector<double> torque, double drag = 0.0) {
  DriveTable table;
  table.kind = DriveKind::torque;
  table.time = std::move(time);
  table.torque = std::move(torque);
  table.drag = drag;
  return table;
}

DriveTable driver(double speed) {
  DriveTable table;
  table.kind = DriveKind::cruise;
  table.time = {0.0};
  table.target_speed = {speed};
  table.power = 400e3;
  table.largest_torque = 40e3;
  table.brake_torque = 30e3;
  return table;
}

TEST(TorqueDrive, LeavesTheSprocketsFree) {
  EXPECT_EQ(held_vehicle(torque_table({0.0}, {1.0})).num_prescribed(), 0);
  EXPECT_EQ(held_vehicle({{0.0}, {0.0}}).num_prescribed(), 2);
}

TEST(TorqueDrive, AcceleratesASprocketByTorqueOverInertia) {
  const System system = held_vehicle(torque_table({0.0, 1.0}, {0.0, 240.0}));
  const int body = system.sprocket_body[0];
  Stepper stepper(system, strewn_state(system), {});
  EnergyBook book = open_book(stepper.work().energy);
  while (stepper.state().time < 1.0) {
    ASSERT_EQ(stepper.step(1.0), StepStatus::ok);
    book_step(book, stepper.work().energy, stepper.last_step());
  }
  // T = 240 t: I w = 120 at 1 s, and I angle = 40. The velocity formula is exact for a ramp, the start apart: h^2.
  EXPECT_NEAR(stepper.state().chassis.rate[body] * inertia(system, body), 120.0, 1e-3);
  EXPECT_NEAR(stepper.state().chassis.angle[body] * inertia(system, body), 40.0, 1e-2);
  // The work booked is what both sprockets hold; trapezoids of 1 ms over a cubic power err by 1e-6.
  EXPECT_NEAR(book.input / (120.0 * 120.0 / inertia(system, body)), 1.0, 1e-4);
}

TEST(TorqueDrive, CoastsAgainstItsDrag) {
  const System system = held_vehicle(torque_table({0.0}, {0.0}, 6.0));
  const int body = system.sprocket_body[0];
  State state = strewn_state(system);
  state.chassis.rate[body] = 30.0;
  Stepper stepper(system, state, {});
  EnergyBook book = open_book(stepper.work().energy);
  while (stepper.state().time < 2.0) {
    ASSERT_EQ(stepper.step(2.0), StepStatus::ok);
    book_step(book, stepper.work().energy, stepper.last_step());
  }
  const double left = 30.0 * std::exp(-6.0 * 2.0 / inertia(system, body));
  EXPECT_NEAR(stepper.state().chassis.rate[body], left, 1e-5 * 30.0);  // Adams-Bashforth: (h c / I)^2 of some 1e-6
  const double lost = 0.5 * inertia(system, body) * (30.0 * 30.0 - left * left);
  EXPECT_NEAR(-book.input / lost, 1.0, 1e-5);
}

TEST(Limits, AreThoseOfEngineAndBrake) {
  const DriveTable table = driver(10.0);
  EXPECT_EQ(limited_torque(table, 1e6, 0.0), 40e3);     // at rest: the largest torque
  EXPECT_EQ(limited_torque(table, 1e6, 40.0), 10e3);    // P / omega
  EXPECT_EQ(limited_torque(table, -1e6, 40.0), -30e3);  // the brake
  EXPECT_EQ(limited_torque(table, -1e6, -40.0), -10e3);
  EXPECT_EQ(limited_torque(table, 5e3, 40.0), 5e3);
}

/// The driver on a body of `inertia` alone, in steps of 0.1 ms, rate by rate.
std::vector<double> drive_alone(const DriveTable& table, double inertia, double target, double end) {
  std::vector<double> rates{0.0};
  double integral = 0.0;
  constexpr double k_step = 1e-4;
  for (double t = 0.0; t < end; t += k_step) {
    const DriverAction action = driver_action(table, inertia, {0.0, target, 0.0}, rates.back(), integral);
    integral += k_step * action.integral_rate;
    rates.push_back(rates.back() + k_step * action.torque / inertia);
  }
  return rates;
}

TEST(Driver, HasADoublePoleWhereNothingLimitsHim) {
  DriveTable table = driver(1.0);
  table.power = table.largest_torque = table.brake_torque = 1e12;
  const std::vector<double> rates = drive_alone(table, 2400.0, 1.0, 4.0);
  for (const std::size_t i : {std::size_t{2000}, std::size_t{10000}, std::size_t{40000}}) {
    const double t = 1e-4 * static_cast<double>(i), p = 0.5 / table.response_time;
    // e = (1 - p t) exp(-p t); Euler steps of 1e-4 s err by 1e-4.
    EXPECT_NEAR(1.0 - rates[i], (1.0 - p * t) * std::exp(-p * t), 2e-4);
  }
}

TEST(Driver, AcceleratesWithTheEnginesPowerAndDoesNotWindUp) {
  const DriveTable table = driver(10.0);
  const double j = 2400.0, target = 40.0;
  const std::vector<double> rates = drive_alone(table, j, target, 20.0);
  // Torque up to w = P / T = 10 rad/s, reached at 0.6 s, then power: j (w^2 - 100) / 2 = P (t - 0.6).
  EXPECT_NEAR(rates[20000], std::sqrt(100.0 + 2.0 * 400e3 * 1.4 / j), 0.02);
  // Wound up over the 5 s at the limit the integral alone would carry it far beyond.
  EXPECT_LT(*std::max_element(rates.begin(), rates.end()), 1.05 * target);
  EXPECT_NEAR(rates.back(), target, 1e-3 * target);
}

}  // namespace
}  // namespace grouser::test
