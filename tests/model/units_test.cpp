#include "model/units.h"

#include <gtest/gtest.h>

#include <cmath>

namespace grouser {
namespace {

TEST(Unit, OfAKeyTurnsIntoSi) {
  EXPECT_DOUBLE_EQ(unit("mm").to_si(194.0), 0.194);
  EXPECT_DOUBLE_EQ(unit("tonf").to_si(10.0), 98066.5);  // the rig's 10 ton, standard gravity
  EXPECT_DOUBLE_EQ(unit("lbf").to_si(1.0), 4.4482216152605);
  EXPECT_DOUBLE_EQ(unit("mm_per_min").to_si(2.0), 2e-3 / 60.0);
  EXPECT_DOUBLE_EQ(unit("km_per_h").to_si(50.0), 50.0 / 3.6);
  EXPECT_DOUBLE_EQ(unit("kN_per_mm").to_si(100.0), 1e8);
  EXPECT_DOUBLE_EQ(unit("N_m_per_deg").to_si(1.0), 180.0 / 3.14159265358979323846);
  EXPECT_DOUBLE_EQ(unit("rpm").to_si(60.0), 2.0 * 3.14159265358979323846);
  EXPECT_DOUBLE_EQ(unit("mm2_per_MPa").to_si(6.8), 6.8e-12);
  EXPECT_DOUBLE_EQ(unit("degC").to_si(20.0), 293.15);
  EXPECT_DOUBLE_EQ(unit("degF").to_si(68.0), 293.15);
  EXPECT_DOUBLE_EQ(unit("degF").to_si(-40.0), unit("degC").to_si(-40.0));  // where the two scales meet
  EXPECT_DOUBLE_EQ(unit("per_mm2").to_si(1.0), 1e6);
  EXPECT_DOUBLE_EQ(unit("per_deg2").to_si(1.0), std::pow(180.0 / 3.14159265358979323846, 2));
  EXPECT_DOUBLE_EQ(unit("deg_per_kN_m").to_si(1.0), 3.14159265358979323846 / 180.0 / 1e3);
}

TEST(Unit, ComesBackFromSiToTheLastDigitsOfADouble) {
  for (int i = 1; i < 2000; ++i) {
    const double value = i / 8.0;  // exact in binary, so any loss is the conversion's
    EXPECT_DOUBLE_EQ(unit("mm").from_si(unit("mm").to_si(value)), value);
    EXPECT_DOUBLE_EQ(unit("kN_per_mm").from_si(unit("kN_per_mm").to_si(value)), value);
  }
}

TEST(Unit, KnowsItsDimension) {
  EXPECT_EQ(unit("N_m_s_per_rad").dimension, dimension::angular_damping);
  EXPECT_EQ(unit("N_per_mm2").dimension, dimension::pressure);
  EXPECT_EQ(unit("kg_m2").dimension, dimension::inertia);
  EXPECT_EQ(unit("J").dimension, unit("N_m").dimension);
  EXPECT_NE(unit("N_m").dimension, unit("N_m_per_rad").dimension);  // torque is not torsional stiffness
  EXPECT_NE(unit("Hz").dimension, unit("rad_per_s").dimension);
  EXPECT_NE(unit("mm_per_V").dimension, unit("mm").dimension);
  EXPECT_EQ(unit("per_s").dimension, unit("Hz").dimension);
}

TEST(Unit, ThatNobodyKnowsIsRefused) {
  for (const char* wrong : {"furlong", "mM", "kn", "", "per", "per_per_s", "N_per", "N__m", "mm_per_per_s",
                            "degC_per_s", "per_degC", "degF2", "m0"}) {
    EXPECT_FALSE(parse_unit(wrong)) << wrong;
  }
}

TEST(Key, SplitsIntoNameAndUnit) {
  const auto split = split_name_and_unit("lvdt_a_V");
  ASSERT_TRUE(split);
  EXPECT_EQ(split->name, "lvdt_a");
  EXPECT_EQ(split->suffix, "V");
  EXPECT_EQ(split_name_and_unit("slope_kN_per_mm")->name, "slope");
  EXPECT_EQ(split_name_and_unit("stiffness_change_per_K")->name, "stiffness_change");
  EXPECT_FALSE(split_name_and_unit("sample"));
  EXPECT_FALSE(split_name_and_unit("_mm"));
}

}  // namespace
}  // namespace grouser
