#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "model/folder_lock.h"
#include "tests/cli/command_runner.h"
#include "tests/support/temporary_folder.h"

namespace grouser::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

json read_json(const fs::path& file) { return json::parse(std::ifstream(file)); }

/// A spring of 100 kN/mm beside a stop of 20 kN/mm that slips at 0.1 mm, turned through sines of some amplitudes.
struct Rubber {
  static constexpr double k_spring = 1e8, k_stop = 2e7, k_yield = 1e-4;
  double deflection = 0.0, displacement = 0.0;

  double force(double x) {
    deflection = std::clamp(deflection + x - displacement, -k_yield, k_yield);
    displacement = x;
    return k_spring * x + k_stop * deflection;
  }
};

using Row = std::function<std::string(double time, double displacement, double force)>;

/// Ten loops at 1 Hz, 200 samples each.
std::string loops(double amplitude, const std::string& header, const Row& row) {
  std::ostringstream table;
  table << header << "\n";
  Rubber rubber;
  for (int i = 0; i <= 2000; ++i) {
    const double time = i / 200.0, x = amplitude * std::sin(2.0 * std::numbers::pi * time);
    table << row(time, x, rubber.force(x)) << "\n";
  }
  return table.str();
}

std::string plain_row(double time, double x, double force) {
  std::ostringstream row;
  row << std::setprecision(12) << time << "," << 1e3 * x << "," << 1e-3 * force;
  return row.str();
}

/// Campaign of three amplitudes on axis x; `more` stands before the tests.
fs::path campaign(const TemporaryFolder& folder, const std::string& more, const std::string& header, const Row& row) {
  std::string tests;
  for (const char* const amplitude : {"0.2", "0.5", "1.0"}) {
    const std::string name = std::string("loop_") + amplitude;
    folder.write(name + ".csv", loops(1e-3 * std::stod(amplitude), header, row));
    tests += (tests.empty() ? "" : ",") + std::string(R"({"name": ")") + name +
             R"(", "axis": "x", "kind": "cyclic", "file": ")" + name + R"(.csv", "frequency_Hz": 1})";
  }
  return folder.write("rig.json", R"({"format": "grouser.rig/1", "specimen": {"name": "specimen"}, )" + more +
                                      R"("tests": [)" + tests + "]}");
}

fs::path plain_campaign(const TemporaryFolder& folder, const std::string& more = "") {
  return campaign(folder, more, "time_s,displacement_mm,force_kN", plain_row);
}

/// Force range over displacement range of the true law: the stop has slipped through at every amplitude used.
double true_stiffness(double amplitude) { return Rubber::k_spring + Rubber::k_stop * Rubber::k_yield / amplitude; }

TEST(Identify, CalibratesVoltsAllTheWayToTheStiffness) {
  // LVDT of 2 V/mm with its zero at 0.3 V and a curvature; a second one on a specimen that tilts by 2 %; load cell of
  // 0.05 V/kN with its zero at -0.1 V. Readings are the calibrations turned round.
  const double curvature = 4e-6;        // m/V^2
  const auto reading = [=](double x) {  // of x = s v + c v^2
    const double s = 5e-4;
    return (std::sqrt(s * s + 4.0 * curvature * x) - s) / (2.0 * curvature);
  };
  const Row volts = [=](double time, double x, double force) {
    std::ostringstream row;
    row << std::setprecision(12) << time << ";" << reading(1.02 * x) + 0.3 << ";" << 1e3 * 2e3 * 0.98 * x << ";"
        << 5e-5 * force - 0.1;
    std::string text = row.str();
    std::replace(text.begin(), text.end(), '.', ',');
    return text;
  };
  const TemporaryFolder folder;
  const std::string sensors = R"("sensors": {
      "displacement": [{"column": "lvdt_left_V", "sensitivity_mm_per_V": 0.5, "offset_V": 0.3, "linearity": [4e-6],
                        "record": {"reading_V": [0.3, 2.3], "displacement_mm": [0, 1.02]}},
                       {"column": "lvdt_right_mV", "sensitivity_mm_per_V": 0.5}],
      "force": {"column": "load_V", "sensitivity_kN_per_V": 20, "offset_mV": -100}}, )";
  const fs::path rig = campaign(folder, sensors, "Bench 4\nTime;lvdt_left;lvdt_right;load\n[s];[V];[mV];[V]", volts);
  const CommandOutput output = grouser({"identify", rig.string(), "-o", (folder / "fit").string()});
  ASSERT_EQ(output.exit_code, 0) << output.err;
  const json fit = read_json(folder / "fit" / "fit.json");
  for (const auto& [i, amplitude] : {std::pair(0, 0.2e-3), std::pair(1, 0.5e-3), std::pair(2, 1e-3)}) {
    // The mean of the two LVDTs is exact; the numbers in the file have twelve digits.
    EXPECT_NEAR(fit["tests"][i]["effective_stiffness_N_per_m"].get<double>(), true_stiffness(amplitude),
                1e-6 * true_stiffness(amplitude));
  }
  // 2 V read 2 * 0.5 mm + 4 * 4 um = 1.016 mm where the record says 1.02 mm.
  EXPECT_NEAR(fit["calibration_residual"].get<double>(), 0.004 / 1.02, 1e-9);
}

TEST(Identify, WritesDrawsThatAreOrdinaryBushings) {
  const TemporaryFolder folder;
  const fs::path rig = plain_campaign(folder), out = folder / "fit";
  fs::create_directories(out / "draws");
  folder.write("fit/draws/bushing_999.json", "of an earlier fit");
  ASSERT_EQ(grouser({"identify", rig.string(), "-o", out.string()}).exit_code, 0);
  const int count = read_json(out / "fit.json")["axes"]["x"]["draws"].get<int>();
  EXPECT_GT(count, 1);
  EXPECT_EQ(std::distance(fs::directory_iterator(out / "draws"), fs::directory_iterator()), count);
  EXPECT_FALSE(fs::exists(out / "draws" / "bushing_999.json"));
  const std::string third = (out / "draws" / "bushing_03.json").string();
  EXPECT_EQ(read_json(third)["name"], "specimen, draw 3 of " + std::to_string(count));
  EXPECT_EQ(grouser({"check", third}).exit_code, 0);
  for (const auto& entry : fs::directory_iterator(out)) {
    EXPECT_THAT(entry.path().filename().string(), Not(HasSubstr(".part")));
  }
}

TEST(Identify, IntoAFolderOfAnotherProcessIsRefused) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "fit/draws.part");  // the other's
  const FolderLock other(folder.path() / "fit", "identification");
  const CommandOutput output = grouser({"identify", plain_campaign(folder).string(), "-o", (folder / "fit").string()});
  EXPECT_EQ(output.exit_code, 5);
  EXPECT_THAT(output.err, HasSubstr("another process is still writing this identification"));
  EXPECT_TRUE(fs::exists(folder.path() / "fit/draws.part"));
}

TEST(Identify, LearnsBeforeItsWorkThatTheReportHasNoPlace) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "fit");
  folder.write("fit/report.json", "notes of a user");
  const CommandOutput output = grouser({"identify", plain_campaign(folder).string(), "-o", (folder / "fit").string()});
  EXPECT_EQ(output.exit_code, 5);
  EXPECT_THAT(output.err, HasSubstr("report.json: expected the numbers of an earlier report there"));
  EXPECT_FALSE(fs::exists(folder / "fit" / "bushing.json"));
}

TEST(Identify, ListsCorrectionsAndChecksOfEveryAxis) {
  const TemporaryFolder folder;
  const Row reversed = [](double time, double x, double force) { return plain_row(time, x, -force); };
  const fs::path rig =
      campaign(folder, R"("corrections": ["reverse_force"], )", "time_s,displacement_mm,force_kN", reversed);
  const CommandOutput output = grouser({"identify", rig.string(), "-o", (folder / "fit").string()});
  ASSERT_EQ(output.exit_code, 0) << output.err;
  EXPECT_THAT(output.out, HasSubstr("corrected reverse_force"));
  EXPECT_THAT(output.out, HasSubstr("Largest residual of a test"));
  EXPECT_THAT(output.out, HasSubstr("Widest 95 % interval of energy"));
  EXPECT_THAT(output.out, HasSubstr("Verdict"));
  const CommandOutput machine = grouser({"identify", rig.string(), "-o", (folder / "fit").string(), "--json"});
  const json result = json::parse(machine.out);
  EXPECT_EQ(result["corrections"][0]["code"], "reverse_force");
  EXPECT_EQ(result["checks"]["axes"][0]["name"], "x");
  EXPECT_FALSE(result["checks"]["rows"].empty());
}

TEST(Identify, GivesNoResultWhereTheFitMissesItsOptimum) {
  // Forces of 1e154 N: their squares leave the range of a double, so no fit can reach its optimum.
  const TemporaryFolder folder;
  const Row huge = [](double time, double x, double force) { return plain_row(time, x, 1e149 * force); };
  const fs::path rig = campaign(folder, "", "time_s,displacement_mm,force_kN", huge);
  const CommandOutput output = grouser({"identify", rig.string(), "-o", (folder / "fit").string()});
  EXPECT_EQ(output.exit_code, 4) << output.err;
  EXPECT_THAT(output.err, HasSubstr("axis x"));
  EXPECT_FALSE(fs::exists(folder / "fit"));
}

}  // namespace
}  // namespace grouser::test
