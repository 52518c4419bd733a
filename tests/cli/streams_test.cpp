#include <gmock/gmock.h>

#include <fstream>

#include "model/run.h"
#include "tests/cli/command_runner.h"
#include "tests/support/temporary_folder.h"

namespace grouser::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Simulates without some of its standard streams: the exit code, with the run whole.
int code_of_run_without(const std::vector<int>& streams) {
  const TemporaryFolder folder;
  CommandControl control;
  control.closed = streams;
  const CommandOutput output = grouser({"simulate", GROUSER_SOURCE_DIR "/test_data/scenarios/run_a.json", "-o",
                                        (folder / "run").string(), "--set", "duration_s=0.05"},
                                       control);
  EXPECT_GT(open_run(folder / "run").channels.read("/time").rows(), 1U);
  return output.exit_code;
}

TEST(ClosedStreams, ProgressDoesNotGoIntoTheRun) { EXPECT_EQ(code_of_run_without({0, 2}), 0); }

TEST(ClosedStreams, AResultForNobodyFailsAndTheRunStands) { EXPECT_EQ(code_of_run_without({1, 2}), 5); }

TEST(Terminal, IsNotObeyedByNamesOutOfFiles) {
  const TemporaryFolder folder;
  std::ofstream(folder / "camera.json") << R"({"format": "grouser.camera/1", "name": "a\u001b[2Jb",
    "mount": "chassis", "eye_m": [0, 5, 1], "target_m": [0, 0, 1], "field_of_view_deg": 40})";
  const CommandOutput output = grouser({"check", (folder / "camera.json").string()});
  EXPECT_THAT(output.out + output.err, Not(HasSubstr("\x1b")));
  EXPECT_THAT(output.out, HasSubstr(R"(a\x1b[2Jb)")) << output.err;
}

}  // namespace
}  // namespace grouser::test
