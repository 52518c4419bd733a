#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/cli/command_runner.h"
#include "tests/support/temporary_folder.h"

namespace grouser::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

const std::string k_data = GROUSER_SOURCE_DIR "/test_data/";

std::string file_with(const TemporaryFolder& folder, const std::string& name, const std::string& text) {
  std::ofstream(folder / name) << text;
  return (folder / name).string();
}

/// A bushing with two things wrong: an unknown axis, and a table whose displacements fall.
std::string bad_bushing(const TemporaryFolder& folder) {
  return file_with(folder, "bushing.json", R"({"format": "grouser.bushing/1", "name": "bad", "axes": {
    "x": {"stiffness": {"displacement_mm": [0, 2, 1], "force_kN": [0, 20, 40]}},
    "why": {"stiffness": {"displacement_mm": [0, 1], "force_kN": [0, 20]}}}})");
}

TEST(BadInput, EveryFindingOfAFileIsToldWithItsPlace) {
  const TemporaryFolder folder;
  const std::string file = bad_bushing(folder);
  const CommandOutput output = grouser({"check", file});
  EXPECT_EQ(output.exit_code, 3);
  EXPECT_THAT(output.err, HasSubstr("grouser: error: " + file + "#/axes/x/stiffness/displacement_mm"));
  EXPECT_THAT(output.err, HasSubstr("grouser: error: " + file + "#/axes"));
  EXPECT_THAT(output.err, HasSubstr("why"));
  EXPECT_THAT(output.err, HasSubstr("expected"));
  EXPECT_THAT(output.err, HasSubstr("found"));
  EXPECT_THAT(output.out, Not(HasSubstr("ok")));
}

TEST(BadInput, FindingsAreJsonWhenAskedFor) {
  const TemporaryFolder folder;
  const std::string file = bad_bushing(folder);
  const CommandOutput output = grouser({"check", "--json", file});
  EXPECT_EQ(output.exit_code, 3);
  const auto json = nlohmann::json::parse(output.out);
  EXPECT_EQ(json["exit_code"], 3);
  EXPECT_EQ(json["files"][0]["ok"], false);
  EXPECT_GE(json["files"][0]["errors"].size(), 2U);
  for (const auto& finding : json["files"][0]["errors"]) {
    EXPECT_EQ(finding["file"], file);
    EXPECT_FALSE(finding["place"].get<std::string>().empty());
    EXPECT_FALSE(finding["expected"].get<std::string>().empty());
  }
}

TEST(BadInput, AFileOfAnUnknownKindGetsTheKindItMeant) {
  const TemporaryFolder folder;
  const CommandOutput output =
      grouser({"check", file_with(folder, "vehicle.json", R"({"format": "grouser.vehicel/1"})")});
  EXPECT_EQ(output.exit_code, 3);
  EXPECT_THAT(output.err, HasSubstr("#/format"));
  EXPECT_THAT(output.err, HasSubstr("did you mean grouser.vehicle/1?"));
}

TEST(BadInput, WhatIsNotJsonIsToldWithTheLine) {
  const TemporaryFolder folder;
  const CommandOutput output = grouser({"check", file_with(folder, "rig.json", "{\n  \"format\": oops\n}\n")});
  EXPECT_EQ(output.exit_code, 3);
  EXPECT_THAT(output.err, HasSubstr("line 2"));
}

TEST(BadInput, LeavesNoOutputBehind) {
  const TemporaryFolder folder;
  const std::string rig = file_with(folder, "rig.json", R"({"format": "grouser.rig/1", "tests": []})");
  EXPECT_EQ(grouser({"identify", rig, "-o", (folder / "out").string()}).exit_code, 3);
  EXPECT_FALSE(fs::exists(folder / "out"));
  const std::string scenario = file_with(folder, "scenario.json", R"({"format": "grouser.scenario/1"})");
  EXPECT_EQ(grouser({"simulate", scenario, "-o", (folder / "run").string()}).exit_code, 3);
  EXPECT_FALSE(fs::exists(folder / "run"));
}

TEST(BadInput, AReplacementOfAnUnknownKeyIsRefused) {
  const TemporaryFolder folder;
  const CommandOutput output =
      grouser({"simulate", k_data + "scenarios/run_a.json", "-o", (folder / "run").string(), "--set", "durashun_s=1"});
  EXPECT_EQ(output.exit_code, 3);
  EXPECT_THAT(output.err, HasSubstr("durashun_s"));
  EXPECT_FALSE(fs::exists(folder / "run"));
}

TEST(Files, OneThatCannotBeReadIsAFileError) {
  for (const char* subcommand : {"identify", "simulate", "check", "render", "export", "report"}) {
    const CommandOutput output = grouser({subcommand, "no_such_thing"});
    EXPECT_EQ(output.exit_code, 5) << subcommand << ": " << output.err;
    EXPECT_THAT(output.err, HasSubstr("no_such_thing")) << subcommand;
  }
}

TEST(Files, AnOutputFolderThatCannotBeMadeIsAFileErrorBeforeLongWork) {
  const TemporaryFolder folder;
  const std::string below_a_file = file_with(folder, "plain", "text") + "/run";
  const CommandOutput output =
      grouser({"simulate", k_data + "scenarios/run_a.json", "-o", below_a_file, "--set", "duration_s=0.05"});
  EXPECT_EQ(output.exit_code, 5) << output.err;
}

TEST(Files, AFullStdoutIsAFileError) {
  CommandControl control;
  control.stdout_file = "/dev/full";
  EXPECT_EQ(grouser({"check", k_data + "vehicles/reference.json"}, control).exit_code, 5);
}

TEST(Check, ReadsEveryFileWhateverTheOnesBeforeHold) {
  const TemporaryFolder folder;
  const std::string good = k_data + "vehicles/reference.json";
  const CommandOutput output = grouser({"check", bad_bushing(folder), "absent.json", good});
  EXPECT_EQ(output.exit_code, 5);  // the worst of 3, 5 and 0
  EXPECT_THAT(output.out, StartsWith(good + ": ok: vehicle "));
  EXPECT_EQ(std::count(output.out.begin(), output.out.end(), '\n'), 1);
  EXPECT_THAT(output.err, HasSubstr("absent.json"));
  EXPECT_THAT(output.err, HasSubstr("bushing.json#"));
}

TEST(Check, AcceptsTheReferenceData) {
  const CommandOutput output = grouser({"check", k_data + "rig/reference/rig.json", k_data + "vehicles/reference.json",
                                        k_data + "scenarios/run_a.json", k_data + "scenarios/run_b.json"});
  EXPECT_EQ(output.exit_code, 0) << output.err;
  EXPECT_THAT(output.err, IsEmpty());
}

}  // namespace
}  // namespace grouser::test
