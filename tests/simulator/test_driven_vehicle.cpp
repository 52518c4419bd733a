#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "tests/support/vehicle_scene.h"

/// The whole vehicle with its sprockets free.
namespace grouser::test {
namespace {

System with_drive(const DriveTable& table) {
  Scenario scenario = reference_scene().system.scenario;
  scenario.drive.fill(table);
  return compile(scenario);
}

double speed(const System& system, const State& state) {
  return state.chassis.rate[system.sprocket_body[0]] * system.tracks[0].speed_per_sprocket_rate;
}

TEST(DrivenVehicle, LosesInCoastingWhatTheBookSays) {
  DriveTable table;
  table.kind = DriveKind::torque;
  table.time = {0.0, 0.2, 1.0, 1.1};
  table.torque = {0.0, 15e3, 15e3, 0.0};
  const System system = with_drive(table);
  EXPECT_EQ(system.num_prescribed(), 0);
  const ShortRun run = run_for(system, reference_scene().rest.state, 2.0);
  EXPECT_GT(speed(system, run.state), 0.8);  // 2 x 15 kN m over 0.309 m and 51.1 t: 1.9 m/s^2 less resistance
  EXPECT_GT(run.book.dissipated(), 1e3);     // J
  EXPECT_LT(std::abs(run.book.residual()), 1e-3 * run.book.input);  // the limit of every run
}

TEST(DrivenVehicle, ReachesTheDriversSpeedAndHoldsIt) {
  DriveTable table;
  table.kind = DriveKind::cruise;
  table.time = {0.0, 1.0};
  table.target_speed = {0.0, 1.5};
  table.power = 400e3;
  table.largest_torque = table.brake_torque = 40e3;
  const System system = with_drive(table);
  const ShortRun early = run_for(system, reference_scene().rest.state, 3.0);
  const ShortRun late = run_for(system, early.state, 4.0);
  // Two of the driver's time constants of 1 s after the ramp's end; link passing makes the sprocket nod.
  EXPECT_NEAR(speed(system, early.state), 1.5, 0.1);
  EXPECT_NEAR(speed(system, late.state), 1.5, 0.1);
  const double way = (late.state.chassis.position - early.state.chassis.position).x();
  EXPECT_NEAR(way / 1.5, 1.0, 0.03);  // in a second; tracks run up to 1 % ahead of their sprockets
}

TEST(DrivenVehicle, RunsTheSameBesideOthersInAnyNumberOfThreads) {
  constexpr std::size_t k_vehicles = 4;
  const State& rest = reference_scene().rest.state;
  const auto run_all = [&](std::size_t num_threads) {
    std::vector<ShortRun> runs(k_vehicles);
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < num_threads; ++t) {
      threads.emplace_back([&, t] {
        for (std::size_t v = t; v < k_vehicles; v += num_threads) {
          runs[v] = run_for(driven(9.0, 3.0 * static_cast<double>(v)), rest, 0.05);
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
    return runs;
  };
  const std::vector<ShortRun> alone = run_all(1);
  for (const std::size_t num_threads : {2, 4}) {
    const std::vector<ShortRun> beside = run_all(num_threads);
    for (std::size_t v = 0; v < k_vehicles; ++v) {
      EXPECT_EQ(alone[v].steps, beside[v].steps);
      EXPECT_EQ(alone[v].state.position.data(), beside[v].state.position.data());
      EXPECT_EQ(alone[v].acceleration.angular.data(), beside[v].acceleration.angular.data());
      EXPECT_EQ(alone[v].book.residual(), beside[v].book.residual());
    }
  }
}

}  // namespace
}  // namespace grouser::test
