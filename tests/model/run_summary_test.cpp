#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "model/provenance.h"
#include "model/run.h"
#include "tests/support/test_data.h"

namespace grouser {
namespace {

RunSummary summary() {
  RunSummary s;
  s.name = "Run A";
  s.status = RunStatus::stopped;
  s.message = "interrupted";
  s.simulated_time = 2.0;
  s.wall_time = 0.5;
  s.counts.degrees_of_freedom = 954;
  s.steps.accepted = 150000;
  s.steps.min = 1e-5;
  s.energy.residual_fraction = 9e-5;
  s.results.push_back({"cruise_speed_m_per_s", 13.98, "m/s", "mean over the hold"});
  s.results.push_back({"yaw_rate_rad_per_s", std::numeric_limits<double>::quiet_NaN(), "rad/s", "not reached"});
  s.checks.push_back({"Energy book", 9e-5, "", "below 1e-3", true});
  return s;
}

TEST(RunSummary, SurvivesWritingAndReading) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "run.json";
  write_run_summary(summary(), file);
  const RunSummary again = read_run_summary(file);
  EXPECT_EQ(again.status, RunStatus::stopped);
  EXPECT_EQ(again.counts.degrees_of_freedom, 954);
  EXPECT_EQ(again.steps.accepted, 150000);
  EXPECT_EQ(again.steps.min, 1e-5);
  EXPECT_EQ(again.energy.residual_fraction, 9e-5);
  ASSERT_EQ(again.results.size(), 2u);
  EXPECT_EQ(again.results[0].value, 13.98);
  EXPECT_EQ(again.results[0].meaning, "mean over the hold");
  EXPECT_TRUE(std::isnan(again.results[1].value));
  EXPECT_TRUE(again.checks.at(0).pass);
}

TEST(RunSummary, NamesWhatOthersRelyOn) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "run.json";
  write_run_summary(summary(), file);
  const auto json = nlohmann::json::parse(read_whole(file));
  EXPECT_EQ(json["format"], "grouser.run/1");
  EXPECT_EQ(json["status"], "stopped");
  EXPECT_EQ(json["real_time_factor"], 0.25);  // wall seconds a simulated second
  EXPECT_EQ(json["counts"]["degrees_of_freedom"], 954);
  EXPECT_EQ(json["steps"]["min_s"], 1e-5);
  EXPECT_EQ(json["energy"]["residual_fraction"], 9e-5);
  EXPECT_EQ(json["results"]["cruise_speed_m_per_s"], 13.98);
}

}  // namespace
}  // namespace grouser
