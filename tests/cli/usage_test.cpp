#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/cli/command_runner.h"

namespace grouser::test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(Usage, UnknownSubcommandSaysWhichOneWasMeant) {
  const CommandOutput output = grouser({"simulte", "scenario.json"});
  EXPECT_EQ(output.exit_code, 2);
  EXPECT_THAT(output.err, HasSubstr("grouser: error: unknown subcommand simulte (did you mean simulate?)"));
  EXPECT_THAT(output.out, IsEmpty());
}

TEST(Usage, AnUnknownWordFarFromEverySubcommandGetsNoGuess) {
  const CommandOutput output = grouser({"fly"});
  EXPECT_EQ(output.exit_code, 2);
  EXPECT_THAT(output.err, HasSubstr("unknown subcommand fly\n"));
}

TEST(Usage, NoSubcommandIsAnError) {
  const CommandOutput output = grouser({});
  EXPECT_EQ(output.exit_code, 2);
  EXPECT_THAT(output.err, HasSubstr("expected a subcommand"));
}

TEST(Usage, UnknownOptionSaysWhichOneWasMeant) {
  const CommandOutput output = grouser({"render", "run", "--camra", "chase"});
  EXPECT_EQ(output.exit_code, 2);
  EXPECT_THAT(output.err, HasSubstr("unknown option --camra (did you mean --camera?)"));
}

TEST(Usage, MissingArgumentIsNamed) {
  const CommandOutput output = grouser({"identify"});
  EXPECT_EQ(output.exit_code, 2);
  EXPECT_THAT(output.err, HasSubstr("RIG.json"));
  EXPECT_THAT(output.err, HasSubstr("grouser identify --help"));
}

TEST(Usage, AMissingArgumentIsExplained) {
  EXPECT_THAT(grouser({"report"}).err, HasSubstr("DIR is required: Fit folders and run folders"));
  EXPECT_THAT(grouser({"rig", "rig.json"}).err, HasSubstr("--bushing is required: "));
}

TEST(Usage, AnUnknownNameGetsTheNearestOne) {
  EXPECT_THAT(grouser({"plot", "run", "--figure", "tensoin"}).err, HasSubstr("found tensoin (did you mean tension?)"));
  EXPECT_THAT(grouser({"render", "run", "--camera", "sid"}).err, HasSubstr("found sid (did you mean side?)"));
}

struct BadLine {
  std::vector<std::string> arguments;
  std::string told;  ///< part of what the user is told
};

TEST(Usage, ValuesThatCannotBeAreRefusedBeforeAnyWork) {
  const std::vector<BadLine> lines{
      {{"render", "run", "--size", "1281x720"}, "even numbers"},
      {{"render", "run", "--size", "big"}, "WIDTHxHEIGHT"},
      {{"render", "run", "--fps", "0"}, "--fps"},
      {{"render", "run", "--camera", "moon"}, "--camera"},
      {{"render", "run", "--frames", "--film", "a.mp4"}, "--frames"},
      {{"simulate", "scenario.json", "--set", "duration_s"}, "path=value"},
      {{"plot", "run", "--figure", "nonsense"}, "--figure"},
      {{"demo", "--study", "stifness"}, "--study"},
      {{"plot", "run"}, "--figure"},
      {{"plot", "--figure", "tension"}, "RUN_DIR"},
      {{"export", "run", "--format", "xls"}, "--format"},
      {{"identify", "rig.json", "--threads", "0"}, "--threads"},
      {{"render", "run", "--film", "film.avi"}, ".mp4, found film.avi"},
      {{"plot", "run", "--figure", "tension", "-o", "a.pdf"}, ".svg, found a.pdf"},
      {{"report", "run", "-o", "run/run.h5"}, ".html, found run/run.h5"},
      {{"report", "run", "--from", "nan"}, "--from: expected a finite number, found nan"},
      {{"simulate", "scenario.json", "--vehicle", ""}, "--vehicle: expected a value, found an empty text"},
      {{"report"}, "DIR"},
      {{"check"}, "FILE"},
  };
  for (const BadLine& line : lines) {
    const CommandOutput output = grouser(line.arguments);
    EXPECT_EQ(output.exit_code, 2) << line.arguments[0] << ": " << output.err;
    EXPECT_THAT(output.err, HasSubstr(line.told)) << line.arguments[0];
    EXPECT_THAT(output.out, IsEmpty()) << line.arguments[0];
  }
}

TEST(Usage, ErrorIsOneJsonObjectWhenAskedFor) {
  const CommandOutput output = grouser({"report", "--jsn", "--json"});
  EXPECT_EQ(output.exit_code, 2);
  const auto json = nlohmann::json::parse(output.out);
  EXPECT_EQ(json["exit_code"], 2);
  EXPECT_EQ(json["status"], "error");
  EXPECT_THAT(json["errors"][0]["text"].get<std::string>(), HasSubstr("--jsn"));
}

TEST(Help, StandsOnStdoutAndNamesTheDefaultFolder) {
  for (const auto& [subcommand, told] :
       std::vector<std::pair<std::string, std::string>>{{"identify", "out/identification"},
                                                        {"simulate", "NAME of NAME.json"},
                                                        {"render", "RUN_DIR"},
                                                        {"plot", "RUN_DIR/NAME.png"},
                                                        {"report", "report.html in the first DIR"},
                                                        {"export", "RUN_DIR/csv"},
                                                        {"check", "FILE"},
                                                        {"demo", "out/demo"}}) {
    const CommandOutput output = grouser({subcommand, "--help"});
    EXPECT_EQ(output.exit_code, 0) << subcommand;
    EXPECT_THAT(output.out, HasSubstr(told)) << subcommand;
    EXPECT_THAT(output.out, HasSubstr("--json")) << subcommand;
    EXPECT_THAT(output.err, IsEmpty()) << subcommand;
  }
}

TEST(Help, VersionIsTheSameForTheCommandAndItsSubcommands) {
  const CommandOutput output = grouser({"--version"});
  EXPECT_EQ(output.exit_code, 0);
  EXPECT_THAT(output.out, ::testing::MatchesRegex("grouser [0-9]+\\.[0-9]+\\.[0-9]+\n"));
  EXPECT_EQ(grouser({"simulate", "--version"}).out, output.out);
}

}  // namespace
}  // namespace grouser::test
