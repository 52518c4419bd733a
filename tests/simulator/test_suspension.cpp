#include "simulator/suspension.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "simulator/drive.h"
#include "simulator/lane_exponential.h"
#include "tests/support/scenes.h"
#include "tests/support/suspension_scene.h"

namespace grouser::test {
namespace {

TEST(LaneExponential, AgreesWithTheLibraryToItsLastDigits) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> power(-500.0, 500.0), near(-1.0, 1.0);
  constexpr double k_ulp = 2.3e-16;
  for (int n = 0; n < 4000; ++n) {
    const double x = n % 2 == 0 ? power(random) : near(random);
    ASSERT_NEAR(exp(x)[0] / std::exp(x), 1.0, k_ulp) << x;
    const double y = std::exp(x), log_y = std::log(y);
    ASSERT_NEAR(natural_logarithm(y)[0], log_y, k_ulp * std::abs(log_y)) << y;
  }
  EXPECT_EQ(exp(0.0)[3], 1.0);
  EXPECT_LT(exp(-1e9)[3], 1e-300);
  EXPECT_EQ(natural_logarithm(1.0)[3], 0.0);
}

TEST(Suspension, SpringsOfEveryKindSideBySideActAsTheyDoAlone) {
  std::vector<CompiledSuspension> springs;
  for (int i = 0; i < 11; ++i) {  // a block and a part of one
    springs.push_back(i % 3 == 0 ? gas_unit() : torsion_bar());
    springs.back().bump_sign = i % 2 == 0 ? 1.0 : -1.0;
  }
  springs[7].kind = JointSpring::tensioner;
  springs[7].bump_sign = 1.0;
  springs[7].side = Side::right;
  springs[7].tensioner_stiffness = 7e5;
  springs[7].tensioner_damping = 2e3;
  const std::vector<SpringBlock> blocks = arrange_springs(springs);
  ASSERT_EQ(blocks.size(), 2u);
  EXPECT_EQ(blocks[1].count, 3);
  Lanes angle, rate;
  for (int lane = 0; lane < k_lanes; ++lane) {
    angle.set(lane, -0.7 + 0.19 * lane);
    rate.set(lane, 3.0 - 0.9 * lane);
  }
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const SpringMoments together = spring_moments(blocks[b], {0.4, 0.1}, angle, rate);
    for (int lane = 0; lane < blocks[b].count; ++lane) {
      const CompiledSuspension& spring = springs[b * k_lanes + static_cast<std::size_t>(lane)];
      // To the last bit: left and right springs share blocks with others.
      const SpringMoment alone = tensioner_moment(spring, 0.1, angle[lane], rate[lane]);
      EXPECT_EQ(together.moment[lane], alone.moment) << lane;
      EXPECT_EQ(together.energy[lane], alone.energy) << lane;
      EXPECT_EQ(together.loss[lane], alone.loss) << lane;
    }
  }
  const SpringMoments last = spring_moments(blocks[1], {0.4, 0.1}, angle, rate);
  EXPECT_EQ(last.energy[5], 0.0);  // lanes without a joint carry nothing
  EXPECT_EQ(last.loss[5], 0.0);
}

TEST(TorsionBar, CarriesTheWheelLoadOfTheDesignTable) {
  // 15.813 kN m at 25 degrees, 38.77 kN at the wheel, 256.3 kN/m, droop of 0.117 m to the free angle.
  const CompiledSuspension s = torsion_bar();
  EXPECT_NEAR(-station_moment(s, 0.0, 0.0).moment, 15813.0, 3.0);  // free angle given to 0.01 degree
  EXPECT_NEAR(wheel_force(s, 0.0), 38770.0, 10.0);
  EXPECT_NEAR(wheel_rate(s, 0.0), 256.3e3, 100.0);
  EXPECT_NEAR(station_moment(s, k_design - s.bar.free_angle, 0.0).moment, 0.0, 1e-9);
  EXPECT_NEAR(k_arm * (std::sin(s.bar.free_angle) - std::sin(k_design)), 0.117, 5e-4);
}

TEST(TorsionBar, LeadingArmIsTheMirrorOfATrailingOne) {
  const CompiledSuspension trailing = torsion_bar();
  CompiledSuspension leading = trailing;
  leading.bump_sign = -1.0;
  for (const double bump : {-0.6, -0.2, 0.0, 0.3, 0.8}) {
    const SpringMoment a = station_moment(trailing, bump, 0.7), b = station_moment(leading, -bump, -0.7);
    EXPECT_DOUBLE_EQ(a.moment, -b.moment);
    EXPECT_DOUBLE_EQ(a.energy, b.energy);
    EXPECT_DOUBLE_EQ(a.loss, b.loss);
  }
}

TEST(Hydropneumatic, CarriesTheSameLoadAndStiffensAlongPVn) {
  const CompiledSuspension s = gas_unit();
  EXPECT_NEAR(wheel_force(s, 0.0), 38770.0, 0.006 * 38770.0);  // 16.88 MPa x 78.54 cm2 x 0.12 m over 0.408 m
  double last = 0.0;
  for (double bump = -0.3; bump < 0.6; bump += 0.05) {
    const Stroke stroke = piston_stroke(s.unit, bump);
    const double volume = s.unit.gas_volume - s.unit.piston_area * stroke.stroke;
    const double pressure = s.unit.gas_pressure * std::pow(s.unit.gas_volume / volume, 1.3);
    const double moment = -station_moment(s, bump, 0.0).moment;
    EXPECT_NEAR(moment, (pressure - 1e5) * s.unit.piston_area * stroke.lever, 1e-9 * moment) << bump;
    EXPECT_GT(moment, last);
    last = moment;
  }
}

TEST(Hydropneumatic, FollowsTheTravelTableOfAConstantLever) {
  // Lever 0.12 m throughout, wheel force [kN] over the wheel's rise [m]. A crank on a very long rod keeps that
  // lever to 1 - cos(bump): 2 % within 10 degrees, 6 % at 20.
  CompiledSuspension s = gas_unit();
  s.unit.rod_length = 100.0;
  s.unit.gas_volume = 1.002e-3;  // 1.30e-3 m^3 in droop
  struct Row {
    double rise, force, tolerance;
  };
  for (const Row& row : {Row{-0.117, 34.3, 0.07}, Row{-0.068, 35.2, 0.025}, Row{0.0, 38.8, 0.005},
                         Row{0.074, 46.0, 0.025}, Row{0.151, 59.3, 0.08}}) {
    EXPECT_NEAR(wheel_force(s, bump_at_rise(row.rise)) / 1e3 / row.force, 1.0, row.tolerance) << row.rise;
  }
}

TEST(Hydropneumatic, CarriesItsLoadOnAVolumeProportionalToTheTemperature) {
  // The same mass of ideal gas. Where the unit carries the design load at another temperature, its gas fills
  // V_s T / T_charge at p_s.
  const CompiledSuspension cold = gas_unit();
  for (const double temperature : {253.15, 293.15, 353.15}) {  // -20, 20, 80 degC
    CompiledSuspension unit = cold;
    unit.unit.gas_temperature = temperature;
    const auto pressure = [&](double bump) {
      return -station_moment(unit, bump, 0.0).moment / (unit.unit.piston_area * piston_stroke(unit.unit, bump).lever);
    };
    const double wanted = cold.unit.gas_pressure - 1e5;
    double low = -0.35, high = 0.5;  // rad; pressure grows with bump
    for (int i = 0; i < 60; ++i) (pressure(0.5 * (low + high)) < wanted ? low : high) = 0.5 * (low + high);
    const double volume = unit.unit.gas_volume - unit.unit.piston_area * piston_stroke(unit.unit, low).stroke;
    EXPECT_NEAR(volume / (cold.unit.gas_volume * temperature / 293.15), 1.0, 1e-9) << temperature;
    // An isothermal unit held at its design angle: p proportional to T.
    unit.unit.polytropic_exponent = 1.0;
    EXPECT_NEAR((pressure(0.0) + 1e5) / (cold.unit.gas_pressure * temperature / 293.15), 1.0, 1e-12);
  }
}

TEST(Hydropneumatic, SaysWhenItsGasIsPressedToNothing) {
  CompiledSuspension s = gas_unit();
  s.unit.gas_volume = 5e-4;  // its crank can press out 7.8e-4
  double bump = 0.3;
  while (piston_stroke(s.unit, bump).stroke * s.unit.piston_area < 0.98 * s.unit.gas_volume) bump += 1e-4;
  EXPECT_FALSE(station_moment(s, bump - 2e-4, 0.0).bottomed);
  EXPECT_TRUE(station_moment(s, bump + 1e-4, 0.0).bottomed);
  EXPECT_TRUE(std::isfinite(station_moment(s, 1.3, 0.0).moment));
}

TEST(Suspension, MomentIsTheGradientOfItsEnergyAndLossIsNeverNegative) {
  for (const CompiledSuspension& s : {torsion_bar(), gas_unit()}) {
    for (double bump = -0.7; bump < 0.8; bump += 0.013) {  // both stops included
      constexpr double k_step = 1e-6;
      const double slope =
          (station_moment(s, bump + k_step, 0.0).energy - station_moment(s, bump - k_step, 0.0).energy) /
          (2.0 * k_step);
      const SpringMoment still = station_moment(s, bump, 0.0);
      EXPECT_NEAR(still.moment, -slope, 1e-6 * std::abs(slope) + 1.0) << bump;  // 1 N m: a stop's kink inside the step
      for (const double rate : {-3.0, -0.1, 0.1, 3.0}) {
        const SpringMoment moving = station_moment(s, bump, rate);
        EXPECT_GE(moving.loss, 0.0);
        EXPECT_NEAR((moving.moment - still.moment) * rate, -moving.loss, 1e-9 * moving.loss);
      }
    }
  }
}

TEST(Suspension, PistonLeverIsTheRateOfItsStroke) {
  const Hydropneumatic unit = gas_unit().unit;
  EXPECT_DOUBLE_EQ(piston_stroke(unit, 0.0).stroke, 0.0);
  EXPECT_DOUBLE_EQ(piston_stroke(unit, 0.0).lever, 0.12);  // crank at right angles to the cylinder
  for (double bump = -0.6; bump < 0.8; bump += 0.1) {
    constexpr double k_step = 1e-6;
    const double rate =
        (piston_stroke(unit, bump + k_step).stroke - piston_stroke(unit, bump - k_step).stroke) / (2.0 * k_step);
    EXPECT_NEAR(piston_stroke(unit, bump).lever, rate, 1e-9);
  }
}

TEST(Damper, OpensAtItsBlowOffPressureWithoutAJump) {
  const Hydropneumatic unit = gas_unit().unit;
  const double knee = unit.orifice_area * std::sqrt(2.0 * unit.blow_off_pressure / unit.oil_density);
  EXPECT_NEAR(damper_pressure(unit, 0.5 * knee), 0.25 * unit.blow_off_pressure, 1.0);  // square law below
  EXPECT_NEAR(damper_pressure(unit, knee * (1.0 - 1e-9)), damper_pressure(unit, knee * (1.0 + 1e-9)), 1.0);
  double last = 0.0;
  for (double flow = 0.1 * knee; flow < 8.0 * knee; flow += 0.1 * knee) {
    const double pressure = damper_pressure(unit, flow);
    EXPECT_GT(pressure, last);
    last = pressure;
    if (flow < 1.05 * knee) continue;
    // Through both openings together flows what comes in; the orifice alone would ask for much more pressure.
    const double area = unit.orifice_area + unit.blow_off_area * (pressure - unit.blow_off_pressure);
    EXPECT_NEAR(area * std::sqrt(2.0 * pressure / unit.oil_density) / flow, 1.0, 1e-9);
    EXPECT_LT(pressure, 0.5 * unit.oil_density * std::pow(flow / unit.orifice_area, 2));
  }
}

TEST(Tensioner, IsASpringAndADamperAboutItsReference) {
  CompiledSuspension s;
  s.kind = JointSpring::tensioner;
  s.tensioner_stiffness = 7e5;
  s.tensioner_damping = 2e3;
  const SpringMoment m = tensioner_moment(s, 0.1, 0.15, -0.4);
  EXPECT_DOUBLE_EQ(m.moment, -7e5 * 0.05 + 2e3 * 0.4);
  EXPECT_DOUBLE_EQ(m.energy, 0.5 * 7e5 * 0.05 * 0.05);
  EXPECT_DOUBLE_EQ(m.loss, 2e3 * 0.16);
}

TEST(Drive, TurnsTheExactIntegralOfItsSpeedTable) {
  const DriveTable run_a{{0.0, 10.0, 13.0, 17.0}, {0.0, 45.0, 45.0, 0.0}};
  EXPECT_DOUBLE_EQ(drive_motion(run_a, 10.0).angle, 225.0);
  EXPECT_DOUBLE_EQ(drive_motion(run_a, 13.0).angle, 360.0);
  EXPECT_DOUBLE_EQ(drive_motion(run_a, 17.0).angle, 450.0);  // 716.2 pitches: 138.9 m
  EXPECT_DOUBLE_EQ(drive_motion(run_a, 20.0).angle, 450.0);
  EXPECT_DOUBLE_EQ(drive_motion(run_a, 5.0).speed, 22.5);
  EXPECT_DOUBLE_EQ(drive_motion(run_a, 5.0).acceleration, 4.5);
  EXPECT_DOUBLE_EQ(drive_motion(run_a, 10.0).acceleration, 0.0);  // of the interval that begins
  EXPECT_DOUBLE_EQ(drive_motion(run_a, 15.0).acceleration, -11.25);
  EXPECT_DOUBLE_EQ(drive_motion(run_a, 20.0).speed, 0.0);
  const DriveTable late{{2.0, 4.0}, {3.0, -1.0}};  // constant outside; angle counted from time 0
  EXPECT_DOUBLE_EQ(drive_motion(late, 2.0).angle, 6.0);
  EXPECT_DOUBLE_EQ(drive_motion(late, 4.0).angle, 8.0);
  EXPECT_DOUBLE_EQ(drive_motion(late, 5.0).angle, 7.0);
  EXPECT_DOUBLE_EQ(drive_motion(late, -1.0).angle, -3.0);
}

}  // namespace
}  // namespace grouser::test
