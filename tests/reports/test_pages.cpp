#include <gmock/gmock.h>
#include <sys/stat.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>

#include "model/errors.h"
#include "model/fit.h"
#include "model/provenance.h"
#include "model/utf8.h"
#include "render/render.h"
#include "reports/assets.h"
#include "reports/remedies.h"
#include "reports/report.h"
#include "reports/twin.h"
#include "tests/support/mock_run.h"
#include "tests/support/temporary_folder.h"

namespace grouser {
namespace {

using testing::HasSubstr;
using testing::Not;

/// Where an element that may hold others of its name ends.
std::size_t end_of_element(const std::string& html, std::size_t begin, const std::string& tag) {
  int depth = 0;
  for (std::size_t at = begin; at != std::string::npos; at = html.find('<', at + 1)) {
    if (html.compare(at + 1, tag.size(), tag) == 0) ++depth;
    if (html.compare(at + 1, tag.size() + 1, "/" + tag) == 0 && --depth == 0) return at;
  }
  return html.size();
}

/// What a reader sees: the page without scripts, styles, pictures and tags, entities undone.
std::string visible_text(const std::string& html) {
  std::string text;
  for (std::size_t i = html.find("<body"); i < html.size(); ++i) {
    for (const std::string tag : {"script", "style", "svg"})
      if (html.compare(i, tag.size() + 1, "<" + tag) == 0) i = end_of_element(html, i, tag);
    if (html[i] == '<') {
      i = html.find('>', i);
      text += ' ';
    } else {
      text += html[i];
    }
  }
  for (const auto& [entity, plain] :
       {std::pair("&lt;", "<"), {"&gt;", ">"}, {"&quot;", "\""}, {"&#39;", "'"}, {"&apos;", "'"}, {"&amp;", "&"}})
    for (std::size_t at = 0; (at = text.find(entity, at)) != std::string::npos;)
      text.replace(at, std::string(entity).size(), plain);
  return text;
}

void gather_strings(const nlohmann::json& value, std::string& all) {
  if (value.is_string()) all += value.get<std::string>() + "\n";
  if (value.is_structured())
    for (const nlohmann::json& item : value) gather_strings(item, all);
}

/// Reports of one fit folder, "identification".
class FitPages : public testing::Test {
 protected:
  void SetUp() override { mock::write_fit_folder(folder_ / "identification"); }
  std::string report(const std::vector<std::string>& names) {
    std::vector<std::filesystem::path> folders;
    for (const std::string& name : names) folders.push_back(folder_ / name);
    write_report(folders, folder_ / "report.html");
    return read_whole(folder_ / "report.html");
  }
  nlohmann::json twin() { return nlohmann::json::parse(read_whole(folder_ / "report.json")); }
  test::TemporaryFolder folder_;
};

class Pages : public FitPages {
 protected:
  void SetUp() override {
    FitPages::SetUp();
    mock::write_run(folder_ / "run_a", {.name = "Run A"});
    mock::write_run(folder_ / "run_b", {.name = "Run B", .turn = true, .failing_check = true});
  }
};

TEST_F(Pages, EveryNumberOfAReportStandsInItsTwin) {
  for (const std::vector<std::string>& folders :
       {std::vector<std::string>{"run_a"}, {"identification"}, {"run_a", "run_b", "identification"}}) {
    const std::string text = visible_text(report(folders));
    std::string known;
    gather_strings(twin(), known);
    const std::regex number(R"([0-9]+([.,][0-9]+)?)");
    int count = 0;
    for (std::sregex_iterator it(text.begin(), text.end(), number), end; it != end; ++it, ++count)
      EXPECT_THAT(known, HasSubstr(it->str()))
          << text.substr(static_cast<std::size_t>(std::max<long>(0, it->position() - 40)), 90);
    EXPECT_GT(count, 50);
  }
}

TEST_F(Pages, TwinHoldsTheValuesInSi) {
  report({"run_a"});
  const nlohmann::json run = twin()["runs"][0];
  EXPECT_EQ(run["checks"][0]["value"], 13.98);
  EXPECT_EQ(run["checks"][0]["pass"], true);
  EXPECT_EQ(run["synthetic"][0], "Mock data, made up for a test, seed 1.");
}

TEST_F(Pages, VerdictAndChecksComeFirstAndTellTheFailure) {
  const std::string text = visible_text(report({"run_b"}));
  EXPECT_THAT(text, HasSubstr("1 of 2 checks fail"));
  EXPECT_LT(text.find("1 of 2 checks fail"), text.find("Bushing between links"));
}

TEST_F(Pages, ARunIsToldInTheOrderInWhichItIsJudged) {
  mock::write_run(folder_ / "run", {.contact_forces = true});
  const std::string text = visible_text(report({"run"}));
  std::size_t last = 0;
  for (const char* part : {"Run completed",
                           "checks pass",
                           "Checks",
                           "mean step",
                           "Speed",
                           "Path",
                           "Step size of the integrator",
                           "Track tension",
                           "Contact forces on link 20",
                           "Tension of every link",
                           "Distribution of the tension",
                           "Loops of one bushing",
                           "Spectrum of the sprocket torque",
                           "Spectrum of the tension",
                           "Wheel loads",
                           "Wheel travel",
                           "What bounded the steps",
                           "Distribution of the step size",
                           "Energy balance",
                           "Energy residual",
                           "Motion",
                           "Numbers",
                           "Contacts, mean number",
                           "Model, counted from the compiled system",
                           "How to repeat it",
                           "grouser simulate scenarios/mock.json -o mock",
                           "Inputs"}) {
    const std::size_t at = text.find(part, last);
    ASSERT_NE(at, std::string::npos) << part << " is missing, or stands too early";
    last = at;
  }
}

TEST_F(Pages, CommandsRepeatTheRunInTheFolderThatItWasAskedFor) {
  std::ofstream(folder_ / "run_a" / "film.mp4") << film_mark(open_run(folder_ / "run_a"));
  report({"run_a"});
  EXPECT_EQ(twin()["runs"][0]["provenance"]["commands"],
            nlohmann::json({"grouser simulate scenarios/mock.json -o mock", "grouser render mock --film mock/film.mp4",
                            "grouser report mock -o mock/report.html"}));
}

TEST_F(Pages, TwinHoldsTheCurvesOfEveryFigure) {
  report({"run_a"});
  int figures = 0;
  const nlohmann::json facts = twin();  // outlives the loop's references
  for (const nlohmann::json& section : facts["runs"][0]["sections"])
    for (const nlohmann::json& figure : section["figures"]) {
      ++figures;
      const nlohmann::json& panels = figure["tiled"].get<bool>() ? figure["tiles"] : figure["data"];
      ASSERT_FALSE(panels.empty()) << figure["name"];
      for (const nlohmann::json& panel : panels) {
        const nlohmann::json& data = panel.contains("data") ? panel["data"] : panel;
        EXPECT_TRUE(data.contains("map") || !data[data.contains("tables") ? "tables" : "series"].empty())
            << figure["name"];
      }
      EXPECT_FALSE(figure.contains("payload_values"));
    }
  EXPECT_GT(figures, 12);
}

TEST(Twin, StandsOneMemberALineAndListsOfNumbersOnOne) {
  const nlohmann::json facts{{"numbers", {1.5, nullptr, -2}},
                             {"parts", {{{"name", "a"}, {"payload_picture", "base64"}}, {{"name", "b"}}}},
                             {"empty", nlohmann::json::array()}};
  EXPECT_EQ(twin_text(facts),
            "{\n \"empty\": [],\n \"numbers\": [1.5,null,-2],\n \"parts\": [\n  {\n   \"name\": \"a\"\n  },\n  {\n   "
            "\"name\": \"b\"\n  }\n ]\n}\n");
}

TEST_F(Pages, TheVerdictOfAFailedRunSaysWhenAndWhy) {
  mock::write_run(folder_ / "thrown", {.failure = "left track thrown at 0.5600 s: a link stands 120 mm beside"});
  const std::string text = visible_text(report({"thrown"}));
  EXPECT_THAT(text, HasSubstr("Run failed after 2 s; all 2 checks pass: left track thrown at 0.5600 s"));
}

TEST_F(Pages, EveryContactCaseIsCounted) {
  const std::string text = visible_text(report({"run_a"}));
  EXPECT_THAT(text, HasSubstr("driving flank"));
  EXPECT_THAT(text, HasSubstr("wheel on its top"));
  const nlohmann::json contacts = twin()["runs"][0]["contacts"];
  EXPECT_EQ(contacts[0]["met"], true);
  EXPECT_EQ(contacts[1]["met"], false);
}

TEST_F(FitPages, ATestThatWasLeftOutIsNoPerfectFit) {
  const std::filesystem::path file = folder_ / "identification" / "fit.json";
  FitRecord fit = read_fit(file);
  fit.tests.front().cycles_used = 0;
  fit.tests.front().nrmse = 0.0;
  fit.tests.front().per_cycle.resize(1);
  fit.tests.front().per_cycle.front().note = "force and displacement are swapped";
  write_fit(fit, file);
  const std::string text = visible_text(report({"identification"}));
  EXPECT_THAT(text, HasSubstr("left out: force and displacement are swapped"));
  EXPECT_THAT(text, HasSubstr("7 of 8 tests used"));
  const nlohmann::json facts = twin()["fits"][0];
  EXPECT_EQ(facts["verdict"]["pass"], false);
  EXPECT_EQ(facts["verdict"]["partial"], true);
  EXPECT_EQ(facts["axes"][0]["tests"][0]["nrmse"]["text"], "–");
  EXPECT_TRUE(facts["axes"][0]["tests"][0]["nrmse"]["value"].is_null());
}

TEST_F(FitPages, ACalibrationIsJudgedOnlyWhereItIsRecorded) {
  EXPECT_THAT(visible_text(report({"identification"})), HasSubstr("sensor calibration"));
  const std::filesystem::path file = folder_ / "identification" / "fit.json";
  FitRecord fit = read_fit(file);
  fit.calibration_residual = 0.0;
  write_fit(fit, file);
  EXPECT_THAT(visible_text(report({"identification"})), Not(HasSubstr("sensor calibration")));
}

TEST_F(Pages, SyntheticDataIsSaidAtTheTop) {
  for (const char* folder : {"run_a", "identification"}) {
    const std::string text = visible_text(report({folder}));
    ASSERT_NE(text.find("Synthetic data"), std::string::npos) << folder;
    EXPECT_LT(text.find("Synthetic data"), text.find("Measured")) << folder;
  }
}

TEST_F(Pages, NamesStayText) {
  const std::string evil = "<script>alert(1)</script>\"'&{{title}}";
  mock::write_run(folder_ / "evil", {.name = evil, .vehicle_name = evil});
  const std::string html = report({"evil"});
  EXPECT_THAT(html, Not(HasSubstr("<script>alert(1)")));
  EXPECT_THAT(visible_text(html), HasSubstr(evil));
  EXPECT_EQ(twin()["runs"][0]["title"], evil);
}

TEST_F(Pages, IsUtf8WhateverTheFoldersAreCalled) {
  const std::string strange = "run_\xFF", name = "Run A";
  mock::write_run(folder_ / strange, {.name = name});
  const std::string html = report({"run_a", strange});
  EXPECT_TRUE(is_utf8(html));
  EXPECT_THAT(html, HasSubstr("run_\xEF\xBF\xBD"));
}

TEST_F(Pages, NoFileThatIsNoReportIsReplaced) {
  std::ofstream(folder_ / "vehicle.json") << R"({"format": "grouser.vehicle/1"})";
  EXPECT_THROW((void)write_report({folder_ / "run_a"}, folder_ / "vehicle.html"), FileError);
  EXPECT_EQ(read_whole(folder_ / "vehicle.json"), R"({"format": "grouser.vehicle/1"})");
  const std::string before = read_whole(folder_ / "run_a" / "run.json");
  EXPECT_THROW((void)write_report({folder_ / "run_a"}, folder_ / "run_a" / "run.html"), FileError);
  EXPECT_EQ(read_whole(folder_ / "run_a" / "run.json"), before);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "vehicle.html"));
  std::filesystem::create_symlink("vehicle.json", folder_ / "link.json");
  EXPECT_NO_THROW((void)write_report({folder_ / "run_a"}, folder_ / "link.html"));  // the link's place is taken
  EXPECT_FALSE(std::filesystem::is_symlink(folder_ / "link.json"));
  EXPECT_EQ(read_whole(folder_ / "vehicle.json"), R"({"format": "grouser.vehicle/1"})");
  report({"run_a"});
  EXPECT_NO_THROW(report({"run_a"}));  // its own numbers of the last time
}

TEST_F(Pages, NeitherAPipeNorAFolderIsReplaced) {
  ASSERT_EQ(mkfifo((folder_ / "pipe.json").c_str(), 0600), 0);
  EXPECT_THROW(require_place_of_report(folder_ / "pipe.html"), FileError);
  std::filesystem::create_directory(folder_ / "folder.html");
  EXPECT_THROW(require_place_of_report(folder_ / "folder.html"), FileError);
  std::ofstream(folder_ / "deep.json") << std::string(1'000'000, '[');
  EXPECT_THROW(require_place_of_report(folder_ / "deep.html"), FileError);
}

TEST_F(FitPages, NamesOfAFitStayText) {
  const std::string evil = "</svg><script>alert(1)</script>\"'&{{title}}";
  const std::filesystem::path file = folder_ / "identification" / "fit.json";
  FitRecord fit = read_fit(file);
  fit.specimen = evil;
  fit.tests[0].name = evil;
  fit.tests[0].per_cycle[0].note = evil;
  fit.warnings.push_back({"drift", evil, evil});
  fit.corrections.push_back({"remove_creep", evil, evil});
  fit.axes[0].not_identified.push_back(evil);
  fit.axes[0].parameters[0].name = evil;
  write_fit(fit, file);
  const std::string html = report({"identification"});
  EXPECT_THAT(html, Not(HasSubstr("<script>alert(1)")));
  EXPECT_THAT(visible_text(html), HasSubstr(evil));
}

TEST_F(FitPages, AFitShowsItsVerdictItsWarningsAndItsCorrectionsBeforeItsLoops) {
  const std::string text = visible_text(report({"identification"}));
  std::size_t last = 0;
  for (const char* part : {"Every limit is met on all 2 axes",
                           "Quantity, worst of the axis",
                           "Warnings about the data",
                           "remove_backlash",
                           "Corrections applied",
                           "taken out of 7 tests",
                           "Axis x",
                           "Every test",
                           "loop_x_100_1",
                           "Residuals of every test",
                           "Loop measures of every test",
                           "Every cycle",
                           "Gain residual of each test",
                           "Stiffness and loss factor",
                           "Energy over amplitude",
                           "Backbone and tangent stiffness",
                           "Response with 95 % intervals",
                           "Law and valid range",
                           "What the data cannot identify",
                           "Size of the law",
                           "2 parameters with 95 % intervals",
                           "Axis ry",
                           "draws/bushing_07.json",
                           "How to repeat it",
                           "grouser identify rig.json -o mock"}) {
    const std::size_t at = text.find(part, last);
    ASSERT_NE(at, std::string::npos) << part << " is missing, or stands too early";
    last = at;
  }
}

TEST_F(FitPages, LimitsOfAFitAreJudgedAxisByAxis) {
  const std::filesystem::path file = folder_ / "identification" / "fit.json";
  FitRecord fit = read_fit(file);
  report({"identification"});
  EXPECT_EQ(twin()["fits"][0]["verdict"]["pass"], true);
  for (TestFit& test : fit.tests)
    if (test.axis == Axis::ry) test.fitted.dissipated_energy = 1.06 * test.measured.dissipated_energy;  // limit: 5 %
  write_fit(fit, file);
  report({"identification"});
  const nlohmann::json facts = twin()["fits"][0];
  EXPECT_EQ(facts["verdict"]["pass"], false);
  EXPECT_THAT(facts["verdict"]["text"].get<std::string>(), HasSubstr("1 of 2 axes meet every limit"));
  EXPECT_THAT(facts["verdict"]["text"].get<std::string>(), HasSubstr("ry: Largest error of a loop’s energy 6.0 %"));
  EXPECT_EQ(facts["checks"]["axes"][0]["pass"], true);
  EXPECT_EQ(facts["checks"]["axes"][1]["pass"], false);
}

TEST_F(FitPages, ASolverThatDidNotConvergeMeetsNoLimit) {
  const std::filesystem::path file = folder_ / "identification" / "fit.json";
  FitRecord fit = read_fit(file);
  fit.axes[0].solver.termination = "NO_CONVERGENCE";
  write_fit(fit, file);
  report({"identification"});
  EXPECT_EQ(twin()["fits"][0]["checks"]["axes"][0]["pass"], false);
}

TEST_F(FitPages, WarningsOfOneKindStandTogetherWithWhatToDo) {
  report({"identification"});
  const nlohmann::json warnings = twin()["fits"][0]["warnings"];
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_EQ(warnings[0]["code"], "drift");
  EXPECT_EQ(warnings[0]["evidence"].size(), 2u);
  EXPECT_EQ(warnings[1]["correction"], "remove_backlash");
}

// Half widths of 1.2 % make one of 1.7 % of a difference: 1 % is within it, 3 % is not.
TEST_F(FitPages, SeveralFitsAreComparedAgainstTheIntervalsOfBoth) {
  FitRecord other = mock::fit_record("Second specimen");
  for (ResponsePoint& cell : other.axes[0].responses)
    for (double* value : {&cell.energy.value, &cell.energy.low, &cell.energy.high})
      *value *= cell.amplitude < 2e-4 ? 1.01 : 1.03;
  std::filesystem::create_directories(folder_ / "second");
  std::filesystem::copy_file(folder_ / "identification" / "bushing.json", folder_ / "second" / "bushing.json");
  write_fit(other, folder_ / "second" / "fit.json");
  const std::string text = visible_text(report({"identification", "second"}));
  EXPECT_THAT(text, HasSubstr("Fits side by side"));
  const nlohmann::json axes = twin()["fit_comparison"]["axes"];
  ASSERT_EQ(axes.size(), 2u);
  int energies = 0;
  for (const nlohmann::json& row : axes[0]["rows"]) {
    const std::string label = row["label"];
    const bool energy = label.starts_with("Energy"), large = label.find("0.5 mm") != std::string::npos;
    EXPECT_EQ(row["differ"].get<bool>(), energy && large) << label;
    energies += energy;
    if (energy) {
      EXPECT_NEAR(row["width"]["value"].get<double>(), 0.012 * std::hypot(1.0, large ? 1.03 : 1.01), 1e-12);
    }
  }
  EXPECT_EQ(energies, 6);
  for (const nlohmann::json& row : axes[1]["rows"]) EXPECT_FALSE(row["differ"].get<bool>()) << row["label"];
}

TEST_F(FitPages, FitsOfOneNameAreToldApartByTheirFolders) {
  mock::write_fit_folder(folder_ / "second");
  EXPECT_THAT(visible_text(report({"identification", "second"})), HasSubstr("Mock specimen · second"));
}

TEST_F(FitPages, AStaticTestAloneMakesAPage) {
  FitRecord fit = mock::fit_record("Ramp");
  fit.tests.resize(1);
  fit.axes.resize(1);
  TestFit& ramp = fit.tests[0];
  ramp.kind = TestKind::static_ramp;
  ramp.frequency = 0.0;
  ramp.measured = {.effective_stiffness = 1e8};
  ramp.fitted = {.effective_stiffness = 1e8};
  ramp.gain = 0.0;
  AxisFit& axis = fit.axes[0];
  axis.responses.clear();
  axis.selection.clear();
  axis.parameters.clear();
  axis.tangent.clear();
  axis.clearance.reset();
  axis.draws = 0;
  fit.warnings.clear();
  fit.corrections.clear();
  write_fit(fit, folder_ / "identification" / "fit.json");
  const std::string text = visible_text(report({"identification"}));
  EXPECT_THAT(text, HasSubstr("the data were taken as the rig file gives them"));
  for (const char* absent :
       {"Energy over amplitude", "Gain residual", "Bushings as likely", "Widest 95 % interval of energy"})
    EXPECT_THAT(text, Not(HasSubstr(absent)));
}

TEST_F(FitPages, AFitWithoutAnyAxisSaysSo) {
  FitRecord fit = mock::fit_record("Nothing");
  fit.axes.clear();
  write_fit(fit, folder_ / "identification" / "fit.json");
  EXPECT_THAT(visible_text(report({"identification"})), HasSubstr("No axis could be identified"));
}

TEST_F(FitPages, EveryCodeOfAWarningHasARemedy) {
  // The list in model/fit.h, where the codes are declared.
  const std::string header = read_whole(std::filesystem::path(GROUSER_SOURCE_DIR) / "model" / "fit.h");
  const std::size_t from = header.find("struct FitWarning"), to = header.find("std::string test;", from);
  const std::string codes = header.substr(from, to - from);
  const std::regex quoted("\"([a-z_]+)\"");
  int count = 0;
  for (std::sregex_iterator it(codes.begin(), codes.end(), quoted), end; it != end; ++it, ++count)
    EXPECT_FALSE(remedy_of((*it)[1]).action.empty()) << (*it)[1];
  EXPECT_GE(count, 22);
}

TEST_F(FitPages, RemediesNameCorrectionsThatARigFileMayAskFor) {
  for (const char* code : {"drift", "swapped_columns", "reversed_polarity", "time_gap", "phase_break", "backlash",
                           "conditioning_cycles", "unsettled_cycles", "thermal_softening"})
    EXPECT_NE(std::ranges::find(k_correction_names, remedy_of(code).correction), k_correction_names.end()) << code;
}

TEST_F(Pages, AsksNothingOfAnyNetwork) {
  const std::string html = report({"run_a", "run_b", "identification"});
  const std::regex fetch(
      R"((src|href|action|poster|data|srcset)\s*=\s*["']?(https?:)?//|url\(\s*["']?(https?:)?//|@import|fetch\(|XMLHttpRequest|importScripts|new WebSocket|navigator\.sendBeacon)");
  std::smatch match;
  // Base64 payloads hold no quotes or parentheses, so only markup and scripts can match.
  EXPECT_FALSE(std::regex_search(html, match, fetch)) << match.str();
}

TEST_F(Pages, SameFoldersGiveTheSameBytes) {
  const std::string first = report({"run_a"});
  EXPECT_TRUE(first == report({"run_a"}));
}

TEST_F(Pages, HeadingsDescendInOrder) {
  for (const std::vector<std::string>& folders :
       {std::vector<std::string>{"run_a"}, {"identification", "run_a", "run_b"}}) {
    const std::string html = report(folders);
    const std::regex heading("<h([1-6])>");
    int last = 0, first_level = 0;
    for (std::sregex_iterator it(html.begin(), html.end(), heading), end; it != end; ++it) {
      const int level = std::stoi((*it)[1]);
      first_level += level == 1 ? 1 : 0;
      EXPECT_LE(level, last + 1);
      last = level;
    }
    EXPECT_EQ(first_level, 1);
  }
}

TEST_F(Pages, EveryPictureHasATextAlternative) {
  const std::string html = report({"run_a", "identification"});
  const std::regex picture(R"(<img [^>]{0,4000}?src=)");
  int count = 0;
  for (std::sregex_iterator it(html.begin(), html.end(), picture), end; it != end; ++it, ++count)
    EXPECT_TRUE(std::regex_search(it->str(), std::regex(R"(alt="[^"]{10,})"))) << it->str();
  EXPECT_GE(count, 1);
  const std::regex graphic(R"(<svg class="figure"[^>]*>)");
  count = 0;
  for (std::sregex_iterator it(html.begin(), html.end(), graphic), end; it != end; ++it, ++count)
    EXPECT_TRUE(std::regex_search(it->str(), std::regex(R"(aria-label="[^"]{10,})"))) << it->str();
  EXPECT_GT(count, 20);
}

TEST_F(Pages, FiguresWithoutDataAreLeftOutWithASentence) {
  mock::write_run(folder_ / "bare", {.probes = false});
  const std::string text = visible_text(report({"bare"}));
  EXPECT_THAT(text, HasSubstr("is left out"));
  EXPECT_THAT(text, HasSubstr("Step size of the integrator"));
}

TEST_F(Pages, SeveralRunsAreCompared) {
  const std::string text = visible_text(report({"run_a", "run_b"}));
  EXPECT_THAT(text, HasSubstr("Comparison"));
  EXPECT_THAT(text, HasSubstr("Upper run tension right"));
  EXPECT_THAT(text, HasSubstr("How like the channels of Run B are to those of Run A"));
}

TEST_F(Pages, RunsOfOneNameAreToldApartByTheirFolders) {
  mock::write_run(folder_ / "run_c", {.name = "Run A"});
  const std::string text = visible_text(report({"run_a", "run_c"}));
  EXPECT_THAT(text, HasSubstr("Run A · run_a"));
  EXPECT_THAT(text, HasSubstr("Run A · run_c"));
}

TEST_F(Pages, AFilmOfTheRunIsShownWhereverItWasCopied) {
  std::ofstream(folder_ / "run_a" / "film.mp4") << "film " << film_mark(open_run(folder_ / "run_a")) << " film";
  EXPECT_THAT(report({"run_a"}), HasSubstr("video/mp4"));
  std::filesystem::copy(folder_ / "run_a", folder_ / "copy", std::filesystem::copy_options::recursive);
  const std::filesystem::path film = folder_ / "copy" / "film.mp4", channels = folder_ / "copy" / "run.h5";
  std::filesystem::last_write_time(film, std::filesystem::last_write_time(channels) - std::chrono::hours(5));
  EXPECT_THAT(report({"copy"}), HasSubstr("video/mp4"));
}

TEST_F(Pages, AFilmOfAnotherRunIsNotShown) {
  std::ofstream(folder_ / "run_a" / "film.mp4") << "film " << film_mark(open_run(folder_ / "run_b"));
  EXPECT_THAT(report({"run_a"}), Not(HasSubstr("video/mp4")));
}

TEST_F(Pages, AHugeFilmIsLeftOut) {
  std::ofstream(folder_ / "run_a" / "film.mp4") << "film";
  std::filesystem::resize_file(folder_ / "run_a" / "film.mp4", std::uintmax_t{2} << 30);  // a hole
  const std::string html = report({"run_a"});
  EXPECT_THAT(html, Not(HasSubstr("video/mp4")));
  EXPECT_THAT(visible_text(html), HasSubstr("film.mp4 is left out: it is larger than 1 GB"));
}

TEST_F(Pages, ElementIdsStandOnce) {
  const std::string html = report({"run_a", "run_b", "identification"});
  std::set<std::string> seen;
  const std::regex id(R"( id="([^"]{1,80})\")");
  for (std::sregex_iterator it(html.begin(), html.end(), id), end; it != end; ++it)
    EXPECT_TRUE(seen.insert((*it)[1]).second) << (*it)[1];
  const std::regex link(R"(href="#([^"]{1,80})\")");
  for (std::sregex_iterator it(html.begin(), html.end(), link), end; it != end; ++it)
    EXPECT_TRUE(seen.contains((*it)[1])) << (*it)[1];
}

TEST_F(Pages, ChartsAreThereOrDrawnPlotsInTheirPlace) {
  const std::string html = report({"run_a"});
  if (has_interactive_charts()) {
    EXPECT_THAT(html, HasSubstr("data-values=\"run1-figure-tension\""));
    EXPECT_THAT(html, HasSubstr("class=\"print\""));
  } else {
    EXPECT_THAT(html, Not(HasSubstr("data-values=")));
    EXPECT_THAT(html, HasSubstr("id=\"run1-figure-tension\""));
    EXPECT_THAT(html, HasSubstr("class=\"on-dark\""));
  }
}

TEST_F(Pages, AFolderThatIsNeitherIsNamed) {
  std::filesystem::create_directory(folder_ / "empty");
  try {
    report({"run_a", "empty"});
    FAIL() << "an empty folder was reported";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("empty"));
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "report.html"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "report.json"));
}

TEST_F(Pages, AnUnwritableTargetIsAFileError) {
  EXPECT_THROW(write_report({folder_ / "run_a"}, folder_ / "no such folder" / "report.html"), FileError);
}

TEST_F(Pages, IndexLinksEveryFolderRelatively) {
  write_report({folder_ / "run_a"}, folder_ / "run_a" / "report.html");
  write_index(folder_.path());
  const std::string html = read_whole(folder_ / "index.html");
  for (const char* link : {"href=\"run_a/report.html\"", "href=\"run_b/report.html\"",
                           "href=\"identification/report.html\"", "href=\"run_a/report.json\""})
    EXPECT_THAT(html, HasSubstr(link));
  EXPECT_THAT(html, Not(HasSubstr(folder_.path().string())));
  EXPECT_THAT(visible_text(html), HasSubstr("Synthetic data"));
}

TEST_F(Pages, IndexTakesNoOtherFileForTheReportOfAStudy) {
  const std::filesystem::path stranger = folder_ / "stranger";
  std::filesystem::create_directory(stranger);
  for (const char* text :
       {"[1, 2]", "no JSON", R"({"format": "lint/1", "compares": true})", R"({"compares": "yes"})"}) {
    std::ofstream(stranger / "report.json") << text;
    write_index(folder_.path());
    EXPECT_THAT(read_whole(folder_ / "index.html"), Not(HasSubstr("stranger"))) << text;
  }
  std::ofstream(stranger / "report.json") << R"({"format": "grouser.report/1", "compares": true})";
  EXPECT_THROW(write_index(folder_.path()), FileError);
}

TEST_F(Pages, IndexOfAFolderWithoutResultsIsRefused) {
  test::TemporaryFolder nothing;
  EXPECT_THROW(write_index(nothing.path()), InputError);
}

}  // namespace
}  // namespace grouser
