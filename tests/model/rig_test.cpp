#include "model/rig.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
