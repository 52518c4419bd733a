#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "model/provenance.h"
#include "reports/input_differences.h"
#include "reports/pages.h"
#include "reports/report.h"
#include "reports/run_measures.h"
#include "tests/support/mock_run.h"
#include "tests/support/temporary_folder.h"

namespace grouser {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

/// Several runs, and the twin of a report over them.
class Studies : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& folder, const mock::RunOptions& options = {}) {
    mock::write_run(folder_ / folder, options);
    return folder_ / folder;
  }
  json report(const std::vector<std::string>& names) {
    std::vector<std::filesystem::path> folders;
    for (const std::string& name : names) folders.push_back(folder_ / name);
    write_report(folders, folder_ / "report.html");
    return json::parse(read_whole(folder_ / "report.json"));
  }
  std::vector<RunFolder> open(const std::vector<std::string>& names) {
    std::vector<RunFolder> runs;
    for (const std::string& name : names) runs.push_back(open_run(folder_ / name));
    return runs;
  }
  std::vector<InputDifference> differences(const std::vector<std::string>& names) {
    return input_differences(open(names));
  }
  /// Rewrites one input of a run.
  void edit(const std::string& folder, const std::string& document, const std::function<void(json&)>& change) {
    const std::filesystem::path file = folder_ / folder / "inputs" / document;
    json content = json::parse(read_whole(file));
    change(content);
    write_whole(file, content.dump());
  }
  static json find_row(const json& groups, const std::string& label) {
    for (const json& group : groups)
      for (const json& row : group["rows"])
        if (row["label"] == label) return row;
    return {};
  }
  test::TemporaryFolder folder_;
};

TEST_F(Studies, RunsThatDifferInOneNumberAreFollowedOverIt) {
  for (const auto& [folder, scale] : {std::pair{"hard", 4.0}, {"soft", 0.25}, {"middle", 1.0}})
    write(folder, {.bushing_scale = scale});
  const json twin = report({"hard", "soft", "middle"});
  const json& study = twin["study"];
  EXPECT_EQ(study["parameter"]["label"], "bushing scale");
  EXPECT_EQ(study["parameter"]["values"], (json{0.25, 1.0, 4.0}));
  EXPECT_TRUE(twin["runs"].empty());
  ASSERT_EQ(study["conclusion"].size(), 2u);
  // 178.8 kN times 0.25^0.25 and 4^0.25: a factor of 2 over all.
  EXPECT_THAT(study["conclusion"][0].get<std::string>(),
              HasSubstr("the largest tension in a bushing rises by 100 % (126 kN to 253 kN)"));
  EXPECT_THAT(study["conclusion"][1].get<std::string>(), HasSubstr("to the power −0.50 over all"));
  EXPECT_THAT(study["care"].get<std::string>(),
              HasSubstr("At bushing scale 0.25 a bushing is deflected 6 times as far as it was identified"));
  EXPECT_THAT(study["paper"].get<std::string>(), HasSubstr("Section 7"));
  const json step = find_row(study["groups"], "mean");
  EXPECT_NEAR(step["power"]["value"].get<double>(), -0.5, 1e-12);
  EXPECT_NEAR(step["change"]["value"].get<double>(), -0.75, 1e-12);
  EXPECT_EQ(twin["comparison"]["runs"][0]["name"], "bushing scale 0.25");
}

TEST_F(Studies, RunsThatDifferInMoreAreComparedOnly) {
  write("a");
  write("b", {.bushing_scale = 2.0});
  write("c", {.duration = 1.5, .bushing_scale = 4.0});
  EXPECT_FALSE(study_parameter(open({"a", "b", "c"})));
  EXPECT_EQ(differences({"a", "b", "c"}).size(), 5u);  // scale, duration, three corners of the drive
}

TEST_F(Studies, AQuantityInAnotherUnitIsNoDifference) {
  write("a");
  write("b");
  edit("a", "scenario.json", [](json& j) { j["integrator"]["max_step_ms"] = 0.2; });
  edit("b", "scenario.json", [](json& j) { j["integrator"]["max_step_us"] = 200; });
  EXPECT_TRUE(differences({"a", "b"}).empty());
  edit("b", "scenario.json", [](json& j) { j["integrator"]["max_step_us"] = 100; });
  const std::vector<InputDifference> found = differences({"a", "b"});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].label, "integrator max step");
  EXPECT_EQ(found[0].unit, "ms");
  EXPECT_EQ(found[0].texts, (std::vector<std::string>{"0.2 ms", "0.1 ms"}));
}

TEST_F(Studies, WhatBothSidesChangeAlikeIsOneDifference) {
  write("a");
  write("b");
  for (const char* folder : {"a", "b"}) edit(folder, "vehicle.json", [](json& j) { j["right"] = j["left"]; });
  edit("b", "vehicle.json", [](json& j) {
    for (const char* side : {"left", "right"}) j[side]["track"]["pre_tension_kN"] = 60;
  });
  std::vector<InputDifference> found = differences({"a", "b"});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].label, "vehicle track pre-tension");
  edit("b", "vehicle.json", [](json& j) { j["right"]["track"]["pre_tension_kN"] = 50; });
  found = differences({"a", "b"});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].label, "vehicle track pre-tension (left)");
}

TEST_F(Studies, AScaleOfOneAxisIsToldFromOneOfAll) {
  write("a");
  write("b");
  edit("b", "scenario.json", [](json& j) { j["bushing_scale"] = {{"ry", 2}}; });
  const std::vector<InputDifference> found = differences({"a", "b"});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].label, "bushing scale (ry)");
}

TEST_F(Studies, TwoRunsShowDifferenceAndChangeOfEveryResult) {
  write("a");
  write("b", {.failing_check = true, .bushing_scale = 16.0});
  const json comparison = comparison_facts(open({"a", "b"}), {}, "comparison", 2);
  const json tension = find_row(comparison["groups"], "Largest tension in a bushing");
  EXPECT_NEAR(tension["difference"]["value"].get<double>(), 178.8e3, 1e-6);
  EXPECT_EQ(tension["difference"]["text"], "+179 kN");
  EXPECT_EQ(tension["change"]["text"], "+100.0 %");
  int mean_steps = 0;
  for (const json& group : comparison["groups"])
    for (const json& row : group["rows"]) mean_steps += row["label"] == "Mean step";
  EXPECT_EQ(mean_steps, 1);
  EXPECT_EQ(comparison["inputs"][0]["label"], "bushing scale");
  const json& residual = comparison["checks"][1];
  EXPECT_EQ(residual["cells"][0]["pass"], true);
  EXPECT_EQ(residual["cells"][1]["pass"], false);
}

TEST_F(Studies, SingleAndDoublePinAreToldApartByTheLoadOfOneBushing) {
  write("double", {.double_pin = true});
  write("single");
  const json connection = connection_facts(open({"double", "single"}));
  ASSERT_EQ(connection["findings"].size(), 2u);
  EXPECT_THAT(connection["findings"][0].get<std::string>(),
              HasSubstr("the rms twist of the rubber falls by 50 % (5.73 deg to 2.86 deg)"));
  EXPECT_THAT(connection["paper"].get<std::string>(), HasSubstr("Section 6"));
}

TEST_F(Studies, AFolderOfAStudyHasItsPlaceOnTheFrontPage) {
  for (const auto& [name, scale] : {std::pair{"x0.5", 0.5}, {"x1", 1.0}, {"x2", 2.0}})
    write(std::string("stiffness/") + name, {.bushing_scale = scale});
  write_report({folder_ / "stiffness/x0.5", folder_ / "stiffness/x1", folder_ / "stiffness/x2"},
               folder_ / "stiffness/report.html");
  write_index(folder_.path());
  const std::string html = read_whole(folder_ / "index.html");
  EXPECT_THAT(html, HasSubstr("href=\"stiffness/report.html\""));
  EXPECT_THAT(html, HasSubstr("Study of bushing scale"));
  EXPECT_THAT(html, HasSubstr("all 3 runs complete and pass their checks"));
}

// The mock's links carry 50 kN + 10 kN sin(5 t + i) + 200 N s w: over the laps of a steady drive the sine is next to
// nothing in any span (1 % of 59 kN allows for the few links in a short one).
TEST_F(Studies, SpansCarryTheirMeanTension) {
  write("a");
  int spans = 0;
  for (const Measure& measure : run_measures(open_run(folder_ / "a"))) {
    if (measure.group != "spans") continue;
    ++spans;
    EXPECT_NEAR(measure.value, 5e4 + 200.0 * 45.0, 0.05 * 59e3) << measure.name;
  }
  EXPECT_EQ(spans, 4);
}

// Mock: the sprockets put in kinetic energy and 12 kN m a radian of one sprocket, on 1.94 m a turn.
TEST_F(Studies, RollingResistanceIsTheWorkOverTheWay) {
  write("a");
  for (const Measure& measure : run_measures(open_run(folder_ / "a")))
    if (measure.group == "resistance") {
      EXPECT_NEAR(measure.value, 12e3 * 2.0 * 3.14159265358979 / 1.94, 1e-6 * 4e4);
    }
}

}  // namespace
}  // namespace grouser
