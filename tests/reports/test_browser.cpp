#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>

#include "model/provenance.h"
#include "render/render.h"
#include "reports/assets.h"
#include "reports/report.h"
#include "tests/support/mock_run.h"
#include "tests/support/temporary_folder.h"

namespace grouser {
namespace {

struct Answer {
  int status = 0;
  std::string text;
};
Answer ask(const std::string& command) {
  Answer answer;
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  std::array<char, 4096> chunk{};
  for (std::size_t n = 0; (n = fread(chunk.data(), 1, chunk.size(), pipe)) > 0;) answer.text.append(chunk.data(), n);
  answer.status = pclose(pipe);
  return answer;
}

/// Reports opened in headless Chromium through playwright-core, as `npm ci` in the source folder installs it.
class Browser : public testing::Test {
 protected:
  void SetUp() override {
    const std::filesystem::path source = GROUSER_SOURCE_DIR;
    if (!std::filesystem::exists("/usr/bin/chromium")) GTEST_SKIP() << "chromium is not installed";
    if (!std::filesystem::exists(source / "node_modules/playwright-core"))
      GTEST_SKIP() << "node_modules is absent: run npm ci in the source folder";
    if (ask("node --version").status != 0) GTEST_SKIP() << "node is not installed";
    if (ask("pdftotext -v").status != 0) GTEST_SKIP() << "pdftotext is not installed: poppler-utils";
  }
  void expect_good(const std::vector<std::string>& names, bool player, const ReportOptions& options = {}) {
    std::vector<std::filesystem::path> folders;
    for (const std::string& name : names) folders.push_back(folder_ / name);
    write_report(folders, folder_ / "report.html", options);
    const bool charts =
        has_interactive_charts() && !folders.empty() && std::filesystem::exists(folders.front() / "run.json");
    const std::string modules = "NODE_PATH=" GROUSER_SOURCE_DIR "/node_modules ";
    const Answer answer =
        ask(modules + "node " GROUSER_SOURCE_DIR "/tests/reports/browser.cjs " + (folder_ / "report.html").string() +
            (charts ? " charts=1" : " charts=0") + (player ? " player=1" : " player=0") +
            (std::filesystem::exists(folders.front() / "film.mp4") ? " film=1" : " film=0"));
    EXPECT_EQ(answer.status, 0) << answer.text;
  }
  test::TemporaryFolder folder_;
};

TEST_F(Browser, RunReportWorks) {
  mock::write_run(folder_ / "run");
  expect_good({"run"}, true);
}

TEST_F(Browser, TheFilmStandsInWhereThereIsNoWebGl) {
  mock::write_run(folder_ / "run");
  write_whole(folder_ / "run/film.mp4", "what it shows is not looked at, " + film_mark(open_run(folder_ / "run")));
  expect_good({"run"}, true);
}

TEST_F(Browser, AVehicleNamedAsAScriptStaysText) {
  mock::write_run(folder_ / "run",
                  {.name = "</script><script>alert(1)</script>", .vehicle_name = "<script>alert(1)</script>"});
  expect_good({"run"}, true);
}

TEST_F(Browser, ARunOverRoughGroundPlaysOnThatGround) {
  mock::write_run(folder_ / "run", {.rough = true});
  expect_good({"run"}, true);
}

TEST_F(Browser, AStudyWorks) {
  for (const auto& [name, scale] : {std::pair{"a", 0.5}, {"b", 1.0}, {"c", 2.0}})
    mock::write_run(folder_ / name, {.bushing_scale = scale});
  expect_good({"a", "b", "c"}, false);
}

TEST_F(Browser, ARunAgainstAMeasurementWorksAndItsColumnsStayText) {
  mock::write_run(folder_ / "run");
  std::string table = "time_s,speed_m_per_s,pitch_deg,yaw_rate_rad_per_s,<script>alert(1)</script>_kN\n";
  for (int i = 0; i < 500; ++i)
    table += fmt::format("{},{},{},{},{}\n", 0.004 * i, i % 70, i % 11 - 5, i % 5, 40 + i % 30);
  write_whole(folder_ / "<img src=x onerror=alert(1)>.csv", table);
  ReportOptions options;
  options.against = folder_ / "<img src=x onerror=alert(1)>.csv";
  options.channels = {{"speed", "speed"},
                      {"pitch", "pitch"},
                      {"yaw_rate", "yaw_rate"},
                      {"<script>alert(1)</script>", "-upper_run_tension_left"}};
  expect_good({"run"}, false, options);
}

TEST_F(Browser, IdentificationReportWorks) {
  mock::write_fit_folder(folder_ / "fit");
  expect_good({"fit"}, false);
}

}  // namespace
}  // namespace grouser
