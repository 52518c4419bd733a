#include "model/rig.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <sstream>

#include "model/errors.h"
#include "tests/support/test_data.h"

namespace grouser {
namespace {

/// rig.json of one test, with more members of the file and of the test.
std::string rig(const std::string& file, const std::string& of_test, const std::string& of_rig = "",
                const std::string& axis = "x") {
  return R"({"format": "grouser.rig/1", "specimen": {"name": "s", "bushings_in_series": 2},)" + of_rig +
         R"("tests": [{"name": "t", "axis": ")" + axis + R"(", "file": ")" + file + "\", " + of_test + "}]}";
}

using ::testing::HasSubstr;

TEST(RigFile, FindsColumnsByName) {
  const TemporaryFolder folder;
  folder.write("a.csv", "time_ms,displacement_mm,force_tonf\n0,0,0\n100,0.5,5\n");
  const RigRecord record = read_rig(folder.write("rig.json", rig("a.csv", R"("kind": "cyclic")")));
  const RigTest& test = record.tests.at(0);
  EXPECT_TRUE(test.time_measured);
  EXPECT_DOUBLE_EQ(test.time[1], 0.1);
  EXPECT_DOUBLE_EQ(test.displacement[1], 5e-4);
  EXPECT_DOUBLE_EQ(test.force[1], 49033.25);
  EXPECT_EQ(record.bushings_in_series, 2);
  EXPECT_EQ(record.provenance.inputs.size(), 2u);
}

TEST(RigFile, TakesTheOnlyColumnThatFits) {
  const TemporaryFolder folder;
  folder.write("a.csv", "sample,d_cm,f_tonf\n0,0,0\n1,1,1\n2,2,1.5\n");
  const RigRecord record = read_rig(folder.write("rig.json", rig("a.csv", R"("kind": "cyclic")")));
  EXPECT_FALSE(record.tests.at(0).time_measured);
  EXPECT_EQ(record.tests.at(0).time, (std::vector<double>{0.0, 1.0, 2.0}));
  EXPECT_DOUBLE_EQ(record.tests.at(0).displacement[1], 0.01);
}

TEST(RigFile, BuildsTheTimeOfARampFromItsRate) {
  const TemporaryFolder folder;
  folder.write("a.csv", "displacement_mm;force_kN\n0;0\n0,1;10\n0,05;4\n");
  const RigRecord record =
      read_rig(folder.write("rig.json", rig("a.csv", R"("kind": "static", "rate_mm_per_min": 2)")));
  EXPECT_NEAR(record.tests.at(0).time[1], 3.0, 1e-12);  // 0.1 mm at 2 mm/min
  EXPECT_NEAR(record.tests.at(0).time[2], 4.5, 1e-12);
}

TEST(RigFile, ReadsTorsionInDegrees) {
  const TemporaryFolder folder;
  folder.write("a.csv", "time_s,angle_deg,torque_N_m\n0,0,0\n1,14,360\n");
  const RigRecord record = read_rig(
      folder.write("rig.json", rig("a.csv", R"("kind": "cyclic", "preset_deg": 14, "amplitude_deg": 8)", "", "ry")));
  EXPECT_DOUBLE_EQ(record.tests.at(0).displacement[1], 14.0 * 3.14159265358979323846 / 180.0);
  EXPECT_DOUBLE_EQ(*record.tests.at(0).preset, record.tests.at(0).displacement[1]);
}

TEST(RigSensors, WhatLeavesTheRangeOfNumbersIsAFinding) {
  const TemporaryFolder folder;
  folder.write("a.csv", "time_s,lvdt_V,force_kN\n0,0,0\n1,1e120,1\n2,-1e120,2\n");
  const std::string sensors = R"("sensors": {"displacement": [
      {"column": "lvdt_V", "sensitivity_mm_per_V": 0.5, "linearity": [0, 1]}]}, )";
  try {
    (void)read_rig(folder.write("rig.json", rig("a.csv", R"("kind": "cyclic")", sensors)));
    FAIL();
  } catch (const InputError& error) {
    ASSERT_EQ(error.findings().size(), 1U);
    EXPECT_THAT(error.what(), HasSubstr("a.csv: column lvdt_V, sample 2: expected at most 1e300 in SI units, by unit "
                                        "and calibration, found 1e+120"));
  }
}

TEST(RigSensors, CalibrateVoltsAndGiveStretchAndTilt) {
  const TemporaryFolder folder;
  folder.write("a.csv", "time_s,lvdt_a_V,lvdt_b_mV,load_V\n0,0.5,0,0.1\n1,2.5,1000,1.1\n");
  const std::string sensors = R"("sensors": {"displacement": [
      {"column": "lvdt_a_V", "sensitivity_mm_per_V": 0.5, "offset_V": 0.5, "linearity": [1e-5],
       "record": {"reading_V": [0.5, 2.5], "displacement_mm": [0, 1]}},
      {"column": "lvdt_b_mV", "sensitivity_mm_per_V": 0.8}],
      "force": {"column": "load_V", "sensitivity_kN_per_V": 10, "offset_mV": 100}}, "rig_compliance_mm_per_kN": 0.001, )";
  const RigRecord record = read_rig(folder.write("rig.json", rig("a.csv", R"("kind": "cyclic")", sensors)));
  const RigTest& test = record.tests.at(0);
  const double first = 2.0 * 0.5e-3 + 4.0 * 1e-5, second = 0.8e-3;
  EXPECT_NEAR(test.displacement[1], 0.5 * (first + second), 1e-18);
  EXPECT_NEAR(test.tilt[1], 0.5 * (first - second), 1e-18);
  EXPECT_NEAR(test.force[1], 10e3, 1e-9);
  EXPECT_NEAR(calibration_residual(record.displacement_sensors.at(0)), 4e-5 / 1e-3, 1e-12);
  EXPECT_DOUBLE_EQ(record.rig_compliance, 1e-9);
}

TEST(RigSensors, AreLeftOutWhereAFileHasQuantitiesOfItsOwn) {
  const TemporaryFolder folder;
  folder.write("a.csv", "time_s,angle_deg,torque_N_m\n0,0,0\n1,1,1\n");
  const std::string sensors = R"("sensors": {"force": {"column": "load_V", "sensitivity_kN_per_V": 10}}, )";
  const RigRecord record = read_rig(folder.write("rig.json", rig("a.csv", R"("kind": "cyclic")", sensors, "rx")));
  EXPECT_DOUBLE_EQ(record.tests.at(0).force[1], 1.0);
}

TEST(RigSensors, MeasureTorqueAndAngleAsWell) {
  const TemporaryFolder folder;
  folder.write("torsion.csv", "time_s,turn_V,cell_mV_per_V\n0,0,0\n1,2,1.5\n");
  folder.write("pull.csv", "time_s,lvdt_V,load_V\n0,0,0\n1,2,1\n");
  const std::string text = R"({"format": "grouser.rig/1", "specimen": {"name": "s"}, "sensors": {
      "displacement": [{"column": "turn_V", "sensitivity_deg_per_V": 3}, {"column": "lvdt_V", "sensitivity_mm_per_V": 0.5}],
      "force": {"column": "load_V", "sensitivity_kN_per_V": 12},
      "torque": {"column": "cell_mV_per_V", "sensitivity_N_m_V_per_mV": 250, "offset_mV_per_V": 0.5,
                 "record": {"reading_mV_per_V": [0.5, 2.5], "torque_N_m": [0, 505]}}},
      "tests": [{"name": "a", "axis": "ry", "kind": "cyclic", "file": "torsion.csv"},
                {"name": "b", "axis": "x", "kind": "cyclic", "file": "pull.csv"}]})";
  const RigRecord record = read_rig(folder.write("rig.json", text));
  EXPECT_DOUBLE_EQ(record.tests.at(0).displacement[1], 6.0 * 3.14159265358979323846 / 180.0);
  EXPECT_DOUBLE_EQ(record.tests.at(0).force[1], 250.0);
  EXPECT_DOUBLE_EQ(record.tests.at(1).displacement[1], 1e-3);
  EXPECT_DOUBLE_EQ(record.tests.at(1).force[1], 12e3);
  EXPECT_NEAR(calibration_residual(*record.torque_sensor), 5.0 / 505.0, 1e-12);
}

TEST(RigCorrections, AreThoseOfTheFileAndOfTheTest) {
  const TemporaryFolder folder;
  folder.write("a.csv", "time_s,displacement_mm,force_kN\n0,0,0\n1,1,1\n");
  const std::string of_test = R"("kind": "cyclic", "corrections": ["remove_creep", "reverse_force"])";
  const std::string of_rig = R"("corrections": ["reverse_force", "segment_at_jumps"], "moving_mass_g": 500,
      "moving_inertia_kg_mm2": 2e6, "rig_angular_compliance_deg_per_kN_m": 0.18,
      "thermal": {"stiffness_change_per_K": -0.003, "reference_temperature_degF": 73.4}, )";
  folder.write("a.csv", "time_s,displacement_mm,force_kN,temperature_degC\n0,0,0,23\n1,1,1,25\n");
  const RigRecord record = read_rig(folder.write("rig.json", rig("a.csv", of_test, of_rig)));
  EXPECT_EQ(record.tests.at(0).corrections, (std::vector{CorrectionKind::reverse_force, CorrectionKind::remove_creep,
                                                         CorrectionKind::segment_at_jumps}));
  EXPECT_DOUBLE_EQ(record.tests.at(0).force[1], 1e3);  // only swap_columns is the reader's own work
  EXPECT_DOUBLE_EQ(record.moving_mass, 0.5);
  EXPECT_DOUBLE_EQ(record.moving_inertia, 2.0);
  EXPECT_DOUBLE_EQ(record.rig_angular_compliance, 0.18e-3 * 3.14159265358979323846 / 180.0);
  EXPECT_DOUBLE_EQ(record.thermal->stiffness_change, -0.003);
  EXPECT_DOUBLE_EQ(record.thermal->reference_temperature, 296.15);
  EXPECT_EQ(record.tests.at(0).temperature, (std::vector<double>{296.15, 298.15}));
}

TEST(RigCorrections, AreNoneUnlessAskedFor) {
  const TemporaryFolder folder;
  folder.write("a.csv", "time_s,displacement_mm,force_kN\n0,0,0\n1,1,1\n");
  const RigRecord record = read_rig(folder.write("rig.json", rig("a.csv", R"("kind": "cyclic")")));
  EXPECT_TRUE(record.tests.at(0).corrections.empty());
  EXPECT_TRUE(record.tests.at(0).temperature.empty());
  EXPECT_FALSE(record.thermal);
  EXPECT_EQ(record.moving_mass, 0.0);
}

TEST(RigCorrections, SwapRawNumbersBeforeUnitsAndCalibration) {
  const TemporaryFolder folder;
  folder.write("plain.csv", "time_s,displacement_mm,force_kN\n0,0,0\n1,40,0.5\n");
  folder.write("volts.csv", "time_s,lvdt_V,load_V\n0,0,0\n1,3,2\n");
  const std::string swap = R"("kind": "cyclic", "corrections": ["swap_columns"])";
  const RigTest plain = read_rig(folder.write("rig.json", rig("plain.csv", swap))).tests.at(0);
  EXPECT_DOUBLE_EQ(plain.displacement[1], 0.5e-3);
  EXPECT_DOUBLE_EQ(plain.force[1], 40e3);
  const std::string sensors = R"("sensors": {"displacement": [{"column": "lvdt_V", "sensitivity_mm_per_V": 0.25}],
      "force": {"column": "load_V", "sensitivity_kN_per_V": 12}}, )";
  const RigTest volts = read_rig(folder.write("rig.json", rig("volts.csv", swap, sensors))).tests.at(0);
  EXPECT_DOUBLE_EQ(volts.displacement[1], 0.5e-3);
  EXPECT_DOUBLE_EQ(volts.force[1], 36e3);
  EXPECT_EQ(volts.corrections, std::vector{CorrectionKind::swap_columns});  // identification lists it
}

/// A cyclic record at 100 Hz whose clock is changed by `clock(i, t)`.
std::string record_with_clock(const std::function<double(int, double)>& clock) {
  std::ostringstream table;
  table << "time_s,displacement_mm,force_kN\n";
  for (int i = 0; i < 1000; ++i) table << clock(i, 0.01 * i) << "," << i % 7 << "," << i % 5 << "\n";
  return table.str();
}

TEST(RigTime, MayJumpAndRepeatStampsNowAndThen) {
  const TemporaryFolder folder;
  folder.write("restart.csv", record_with_clock([](int i, double t) { return i < 600 ? t : t - 6.0; }));
  folder.write("repeated.csv", record_with_clock([](int i, double t) { return i % 150 == 1 ? t - 0.01 : t; }));
  folder.write("pause.csv", record_with_clock([](int i, double t) { return i < 300 ? t : t + 100.0; }));
  for (const char* const file : {"restart.csv", "repeated.csv", "pause.csv"}) {
    const RigRecord record = read_rig(folder.write("rig.json", rig(file, R"("kind": "cyclic")")));
    EXPECT_EQ(record.tests.at(0).time.size(), 1000u) << file;
  }
}

TEST(RigTime, IsRefusedWhereItIsNoTime) {
  const TemporaryFolder folder;
  folder.write("saw.csv", record_with_clock([](int i, double) { return i % 50; }));  // 19 falls in 999 steps
  folder.write("coarse.csv", record_with_clock([](int i, double) { return i / 2; }));
  for (const char* const file : {"saw.csv", "coarse.csv"}) {
    EXPECT_THROW(static_cast<void>(read_rig(folder.write("rig.json", rig(file, R"("kind": "cyclic")")))), InputError);
  }
}

TEST(RigFile, ReadsALoggersFileWithUnitsInARowOfTheirOwn) {
  const TemporaryFolder folder;
  folder.write("a.csv",
               "Bench 4;run_17\n\nTime;Displacement;Force;Temperature\n[s];[mm];[kN];[\xC2\xB0"
               "C]\n0;0;0;23\n0,1;0,5;40;23,5\n");
  const RigTest test = read_rig(folder.write("rig.json", rig("a.csv", R"("kind": "cyclic")"))).tests.at(0);
  EXPECT_DOUBLE_EQ(test.time[1], 0.1);
  EXPECT_DOUBLE_EQ(test.displacement[1], 5e-4);
  EXPECT_DOUBLE_EQ(test.force[1], 40e3);
  EXPECT_DOUBLE_EQ(test.temperature[1], 296.65);
}

TEST(RigFile, SaysSoWhenDataAreSynthetic) {
  const TemporaryFolder folder;
  folder.write("a.csv", "time_s,displacement_mm,force_kN\n0,0,0\n1,1,1\n");
  const std::string synthetic = R"("synthetic": {"note": "generated", "seed": 7, "truth": {"anything": 1}}, )";
  const RigRecord record = read_rig(folder.write("rig.json", rig("a.csv", R"("kind": "cyclic")", synthetic)));
  EXPECT_TRUE(record.synthetic);
  EXPECT_EQ(record.synthetic_note, "generated, seed 7");
  EXPECT_EQ(record.provenance.synthetic, std::vector<std::string>{"generated, seed 7"});
}

TEST(MeasuredBearing, IsReadFromItsOwnColumns) {
  const std::filesystem::path measured = std::filesystem::path(GROUSER_SOURCE_DIR) /
                                         "../shared/references/measurements/hdrb_bearing/hdrb_cyclic_shear.csv";
  if (!std::filesystem::exists(measured)) GTEST_SKIP() << "the measured bearing data are not beside this source tree";
  const TemporaryFolder folder;
  std::filesystem::copy_file(measured, folder.path() / "hdrb.csv");
  const std::string columns = R"("kind": "cyclic", "columns": {"displacement": "d_cm", "force": "f_tonf"})";
  const RigRecord record = read_rig(folder.write("rig.json", rig("hdrb.csv", columns, "", "y")));
  EXPECT_EQ(record.tests.at(0).force.size(), 26372u);
  EXPECT_DOUBLE_EQ(record.tests.at(0).displacement[1], -0.02616345911 / 100.0);
}

}  // namespace
}  // namespace grouser
