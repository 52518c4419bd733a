#include "model/bushing.h"

#include <gtest/gtest.h>

#include <cmath>

#include "model/bushing_law.h"
#include "model/errors.h"
#include "model/provenance.h"
#include "tests/support/test_data.h"

namespace grouser {
namespace {

std::string with_x_axis(const std::string& axis) {
  return R"({"format": "grouser.bushing/1", "name": "b", "axes": {"x": )" + axis + "}}";
}

const char* const k_line = R"("stiffness": {"displacement_mm": [-1, 0, 1], "force_kN": [-100, 0, 100]})";

Bushing read(const std::string& text) {
  const TemporaryFolder folder;
  return read_bushing(folder.write("bushing.json", text));
}

TEST(BushingFile, TakesAnyUnitOfTheRightDimension) {
  const Bushing bushing =
      read(with_x_axis(R"({"stiffness": {"displacement_cm": [-0.1, 0, 0.1], "force_tonf": [-10, 0, 10],
      "slope_N_per_m": [9.8e7, 9.8e7, 9.8e7]}, "friction": [{"stiffness_N_per_mm": 1000, "yield_um": 50}],
      "maxwell": [{"stiffness_kN_per_mm": 5, "relaxation_time_ms": 20}], "viscous_N_s_per_m": 100})"));
  const AxisLaw& law = bushing.axis(Axis::x);
  EXPECT_DOUBLE_EQ(law.spring.displacement.back(), 1e-3);
  EXPECT_DOUBLE_EQ(law.spring.force.back(), 98066.5);
  EXPECT_DOUBLE_EQ(law.stops.at(0).stiffness, 1e6);
  EXPECT_DOUBLE_EQ(law.stops.at(0).yield, 5e-5);
  EXPECT_DOUBLE_EQ(law.branches.at(0).relaxation_time, 0.02);
  EXPECT_DOUBLE_EQ(law.viscous, 100.0);
}

TEST(BushingFile, FillsMissingSlopesMonotonely) {
  const Bushing bushing = read(with_x_axis(std::string("{") + k_line + "}"));
  EXPECT_DOUBLE_EQ(evaluate(bushing.axis(Axis::x).spring, 5e-4).force, 5e4);
}

TEST(BushingFile, RotationsMaySayAngleOrDisplacement) {
  const char* const angle = R"({"stiffness": {"angle_deg": [-40, 40], "torque_N_m": [-1000, 1000]}})";
  const char* const displacement = R"({"stiffness": {"displacement_deg": [-40, 40], "force_N_m": [-1000, 1000]}})";
  for (const char* const axis : {angle, displacement}) {
    const std::string text =
        R"({"format": "grouser.bushing/1", "name": "b", "axes": {"ry": )" + std::string(axis) + "}}";
    EXPECT_DOUBLE_EQ(read(text).axis(Axis::ry).spring.displacement.back(), 40.0 * 3.14159265358979323846 / 180.0);
  }
}

TEST(BushingFile, SurvivesWritingAndReading) {
  Bushing bushing;
  bushing.name = "round trip";
  bushing.synthetic = true;
  bushing.provenance.inputs.push_back({"rig", "rig.json", std::string(64, 'a')});
  for (int i = 0; i < k_num_axes; ++i) {
    AxisLaw& law = bushing.axes[static_cast<std::size_t>(i)];
    law.spring = SpringSpline::linear(1.0 / 3.0 * 1e8, 0.1 / 7.0);
    law.stops = {{1e7 / 3.0, 1e-4 / 7.0}};
    law.branches = {{2e7 / 7.0, 1.0 / 3.0}};
    law.yield_growth = 1e6 / 7.0;
    law.viscous = 100.0 / 3.0;
    law.valid = ValidRange{1e-3, 0.01, 30.0, 0.2};
  }
  const TemporaryFolder folder;
  write_bushing(bushing, folder.path() / "a.json");
  const Bushing again = read_bushing(folder.path() / "a.json");
  for (int i = 0; i < k_num_axes; ++i) {
    const AxisLaw &a = bushing.axes[static_cast<std::size_t>(i)], &b = again.axes[static_cast<std::size_t>(i)];
    EXPECT_DOUBLE_EQ(a.spring.force.front(), b.spring.force.front());  // one rounding for the unit
    EXPECT_DOUBLE_EQ(a.spring.slope.back(), b.spring.slope.back());
    EXPECT_DOUBLE_EQ(a.stops.at(0).yield, b.stops.at(0).yield);
    EXPECT_DOUBLE_EQ(a.yield_growth, b.yield_growth);
    EXPECT_DOUBLE_EQ(a.branches.at(0).stiffness, b.branches.at(0).stiffness);
    EXPECT_DOUBLE_EQ(a.valid->rate, b.valid->rate);
  }
  EXPECT_TRUE(again.synthetic);
  EXPECT_EQ(again.provenance.inputs.at(0).sha256, std::string(64, 'a'));
  write_bushing(again, folder.path() / "b.json");
  EXPECT_EQ(read_whole(folder.path() / "a.json"), read_whole(folder.path() / "b.json"));
}

TEST(BushingFile, ReadsTheGrowthOfTheYieldInAnyInverseSquare) {
  const std::string friction = R"(, "friction": [{"stiffness_kN_per_mm": 1, "yield_mm": 0.05}], )";
  const std::string start = std::string("{") + k_line + friction;
  EXPECT_DOUBLE_EQ(read(with_x_axis(start + R"("friction_yield_growth_per_mm2": 2})")).axis(Axis::x).yield_growth, 2e6);
  EXPECT_DOUBLE_EQ(read(with_x_axis(start + R"("friction_yield_growth_per_cm2": 2})")).axis(Axis::x).yield_growth, 2e4);
  const std::string turning = R"({"format": "grouser.bushing/1", "name": "b", "axes": {"ry": {"stiffness":
      {"angle_deg": [-40, 40], "torque_N_m": [-1000, 1000]}, "friction_yield_growth_per_deg2": 1}}})";
  EXPECT_DOUBLE_EQ(read(turning).axis(Axis::ry).yield_growth, std::pow(180.0 / 3.14159265358979323846, 2));
  EXPECT_THROW(read(with_x_axis(start + R"("friction_yield_growth_per_mm2": -1})")), InputError);
  EXPECT_THROW(read(with_x_axis(start + R"("friction_yield_growth_per_rad2": 1})")), InputError);
}

TEST(BushingFile, LeavesOutAYieldThatDoesNotGrow) {
  Bushing bushing;
  bushing.axis(Axis::x).spring = SpringSpline::linear(1e8, 1e-3);
  const TemporaryFolder folder;
  write_bushing(bushing, folder.path() / "a.json");
  EXPECT_EQ(read_whole(folder.path() / "a.json").find("growth"), std::string::npos);
}

TEST(BushingFile, RefusesToHoldANumberThatIsNone) {
  Bushing bushing;
  bushing.axis(Axis::x).spring = SpringSpline::linear(std::nan(""), 1.0);
  const TemporaryFolder folder;
  EXPECT_THROW(write_bushing(bushing, folder.path() / "a.json"), NumericalError);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "a.json"));
}

TEST(BergElement, BecomesStopsOnItsVirginCurve) {
  const double force_max = 2000.0, half = 0.15e-3;
  const Bushing bushing =
      read(with_x_axis(std::string("{") + k_line +
                       R"(, "friction": [{"law": "berg", "force_max_N": 2000, "half_displacement_mm": 0.15}]})"));
  const auto& stops = bushing.axis(Axis::x).stops;
  ASSERT_EQ(stops.size(), 6u);
  for (double x = 0.0; x < 35.0 * half; x += 0.01 * half) {
    double force = 0.0;
    for (const FrictionStop& stop : stops) force += stop.stiffness * advance_stop(0.0, x, stop.yield);
    EXPECT_NEAR(force, force_max * x / (half + x), 0.02 * force_max);  // chords of six pieces
  }
}

TEST(BergElement, LosesNearlyTheClosedFormOfItsLoop) {
  // F_max 2 kN, x_2 0.15 mm, x_0 0.5 mm: 1.3176 J a cycle.
  const Bushing bushing =
      read(with_x_axis(std::string("{") + k_line +
                       R"(, "friction": [{"law": "berg", "force_max_N": 2000, "half_displacement_mm": 0.15}]})"));
  double loss = 0.0;
  for (const FrictionStop& stop : bushing.axis(Axis::x).stops) {
    loss += 4.0 * stop.stiffness * stop.yield * std::max(0.0, 0.5e-3 - stop.yield);
  }
  // Masing's rule doubles the virgin curve on reversal; Berg's element reverses a little more softly.
  EXPECT_NEAR(loss, 1.3176, 0.1 * 1.3176);
}

}  // namespace
}  // namespace grouser
