#include <gmock/gmock.h>

#include <csignal>
#include <nlohmann/json.hpp>

#include "model/run.h"
#include "tests/cli/command_runner.h"
#include "tests/support/temporary_folder.h"

namespace grouser::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<std::string> simulate(const fs::path& folder, const std::string& duration) {
  return {"simulate", GROUSER_SOURCE_DIR "/test_data/scenarios/run_a.json",
          "-o",       folder.string(),
          "--set",    "duration_s=" + duration};
}

class Interrupted : public ::testing::TestWithParam<int> {};

TEST_P(Interrupted, RunKeepsWhatItComputed) {
  const TemporaryFolder folder;
  CommandControl control;
  control.signal = GetParam();
  control.signal_after = " of 17 s";  // assembly is over
  const CommandOutput output = grouser(simulate(folder / "run", "17"), control);
  EXPECT_EQ(output.exit_code, 130) << output.err;

  const RunFolder run = open_run(folder / "run");
  EXPECT_EQ(run.summary.status, RunStatus::stopped);
  EXPECT_GT(run.summary.simulated_time, 0.0);
  EXPECT_LT(run.summary.simulated_time, 17.0);
  const Array time = run.channels.read("/time");
  ASSERT_GT(time.rows(), 1U);
  // Sampled up to where it stopped: within two intervals of the 200 Hz channels.
  EXPECT_NEAR(time.values.back(), run.summary.simulated_time, 0.011);
}

TEST_P(Interrupted, AssemblyLeavesNoRunBehind) {
  const TemporaryFolder folder;
  CommandControl control;
  control.signal = GetParam();
  control.signal_after = "assembly";
  const CommandOutput output = grouser(simulate(folder / "run", "17"), control);
  EXPECT_EQ(output.exit_code, 130) << output.err;
  EXPECT_THAT(output.err, HasSubstr("interrupted"));
  EXPECT_FALSE(fs::exists(folder / "run" / "run.json"));
}

INSTANTIATE_TEST_SUITE_P(BySignal, Interrupted, ::testing::Values(SIGINT, SIGTERM, SIGHUP), [](const auto& which) {
  return which.param == SIGINT ? "Sigint" : which.param == SIGTERM ? "Sigterm" : "Sighup";
});

TEST(Interruption, ACodeStandsThoughStdoutIsFull) {
  const TemporaryFolder folder;
  CommandControl control;
  control.signal = SIGINT;
  control.signal_after = "assembly";
  control.stdout_file = "/dev/full";
  std::vector<std::string> arguments = simulate(folder / "run", "17");
  arguments.push_back("--json");
  const CommandOutput output = grouser(arguments, control);
  EXPECT_EQ(output.exit_code, 130) << output.err;
  EXPECT_THAT(output.err, HasSubstr("stdout: expected to write the result"));
}

TEST(Progress, IsALineEveryTenthWhereThereIsNoTerminal) {
  const TemporaryFolder folder;
  const CommandOutput output = grouser(simulate(folder / "run", "0.1"));
  ASSERT_EQ(output.exit_code, 0) << output.err;
  EXPECT_THAT(output.err, HasSubstr("grouser: simulate:  10 %"));
  EXPECT_EQ(output.err.find('\r'), std::string::npos);
  EXPECT_LE(std::count(output.err.begin(), output.err.end(), '\n'), 11);
}

TEST(Progress, QuietLeavesTheResultAlone) {
  const TemporaryFolder folder;
  std::vector<std::string> arguments = simulate(folder / "run", "0.1");
  arguments.insert(arguments.end(), {"--quiet", "--json"});
  const CommandOutput output = grouser(arguments);
  ASSERT_EQ(output.exit_code, 0) << output.err;
  EXPECT_THAT(output.err, IsEmpty());
  const auto json = nlohmann::json::parse(output.out);
  EXPECT_EQ(json["status"], "done");
  EXPECT_EQ(json["run"]["status"], "completed");
  EXPECT_EQ(json["run"]["counts"]["degrees_of_freedom"], 954);
  EXPECT_EQ(json["outputs"][0], (folder / "run" / "run.h5").string());
}

}  // namespace
}  // namespace grouser::test
