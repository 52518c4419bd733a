#include "simulator/suspension.h"

#include <cmath>

#include "tests/support/suspension_scene.h"
#include "tests/validation/chapters.h"

namespace grouser::validation {
namespace {

using namespace grouser::test;

void add_torsion_bar(Chapter& chapter) {
  chapter.section("Torsion bar",
                  "K = 5e4 N m/rad, free at 43.12 degrees, on a trailing arm of 0.45 m at 25 degrees below horizontal: "
                  "the wheel load of a 51 t vehicle.");
  const CompiledSuspension s = torsion_bar();
  const double moment = s.bar.stiffness * (s.bar.free_angle - k_design), lever = k_arm * std::cos(k_design);
  const double force = moment / lever, rate = s.bar.stiffness / (lever * lever) - force * std::tan(k_design) / lever;
  chapter.add({"moment at design", "N m", moment, -station_moment(s, 0.0, 0.0).moment,
               fraction(1e-12, moment, "round-off"), "closed form: K (free angle - angle)"});
  chapter.add({"wheel force at design", "N", force, wheel_force(s, 0.0), fraction(1e-12, force, "round-off"),
               "closed form: M / (L cos)"});
  chapter.add({"wheel rate at design", "N/m", rate, wheel_rate(s, 0.0),
               fraction(1e-7, rate, "central difference over 2e-5 rad"),
               "closed form: K / (L cos)² - F tan / (L cos)"});
  const double droop = k_arm * (std::sin(s.bar.free_angle) - std::sin(k_design));
  chapter.add({"force where the bar is free, 117 mm below design", "N", 0.0, wheel_force(s, bump_at_rise(-droop)),
               within(1e-6, "round-off of 39 kN"), "closed form: droop L (sin free angle - sin angle)"});
}

void add_gas_unit(Chapter& chapter) {
  chapter.section(
      "Hydropneumatic unit",
      "78.5 cm² piston on a crank of 0.12 m at right angles (rod of 100 km, so that the crank alone sets the lever), "
      "1.00 l of gas at 16.9 MPa, "
      "p V^1.3; wheel force over the travel, and the rate at design with a rod of 0.35 m.");
  CompiledSuspension s = gas_unit();
  s.unit.rod_length = 1e5;
  s.unit.gas_volume = 1.002e-3;  // 1.30 l in droop
  s.stop_stiffness = 0.0;        // the travel goes past the stops
  const Hydropneumatic& unit = s.unit;
  const auto known = [&](double bump) {
    const double volume = unit.gas_volume - unit.piston_area * unit.crank_radius * std::sin(bump);
    const double pressure = unit.gas_pressure * std::pow(unit.gas_volume / volume, 1.3);
    return (pressure - 1e5) * unit.piston_area * unit.crank_radius * std::cos(bump) /
           (k_arm * std::cos(k_design - bump));
  };
  for (const int rise : {-117, -68, 0, 74, 151, 229, 307}) {
    const double bump = bump_at_rise(1e-3 * rise);
    chapter.add({"wheel force at " + std::to_string(rise) + " mm of rise", "kN", 1e-3 * known(bump),
                 1e-3 * wheel_force(s, bump),
                 fraction(1e-5, 1e-3 * known(bump), "lean of the rod, crank / rod = 1.2e-6"),
                 "closed form: p_s (V_s / (V_s - A r sin b))^n - p_atm on the lever r cos b"});
  }
  const CompiledSuspension real = gas_unit();
  const double lever = k_arm * std::cos(k_design), force = wheel_force(real, 0.0);
  const double r = real.unit.crank_radius, l = real.unit.rod_length, A = real.unit.piston_area,
               p = real.unit.gas_pressure;
  const double bend = -r * r / std::sqrt(l * l - r * r);  // s'' of the slider-crank at right angles
  const double angular = 1.3 * p * A * A * r * r / real.unit.gas_volume + (p - 1e5) * A * bend;
  const double rate = angular / (lever * lever) - force * std::tan(k_design) / lever;
  chapter.add({"wheel rate at design, rod of 0.35 m", "N/m", rate, wheel_rate(real, 0.0),
               fraction(1e-6, rate, "central difference over 2e-5 rad"),
               "closed form: [n p A² s'²/V + (p - p_atm) A s''] / (L cos)² - F tan / (L cos)"});
}

void add_damper(Chapter& chapter) {
  chapter.section("Damper with blow-off",
                  "Orifice of 17.85 mm² (discharge included), oil of 870 kg/m³, blow-off at 4.5 MPa.");
  const Hydropneumatic unit = gas_unit().unit;
  const double knee = unit.orifice_area * std::sqrt(2.0 * unit.blow_off_pressure / unit.oil_density);
  const char* orifice = "closed form: (rho / 2) (Q / A)²";
  chapter.add({"pressure at half the knee's flow", "MPa", 1e-6 * 0.25 * unit.blow_off_pressure,
               1e-6 * damper_pressure(unit, 0.5 * knee), within(1e-9, "round-off"), orifice});
  chapter.add({"pressure at the knee", "MPa", 1e-6 * unit.blow_off_pressure,
               1e-6 * damper_pressure(unit, knee * (1.0 - 1e-9)), within(1e-7, "1e-9 below the knee"), orifice});
  // Above it Q = (A + c (dp - p_b)) sqrt(2 dp / rho): the flow that belongs to a pressure.
  for (const double megapascal : {6.0, 10.0, 20.0}) {
    const double pressure = 1e6 * megapascal;
    const double flow = (unit.orifice_area + unit.blow_off_area * (pressure - unit.blow_off_pressure)) *
                        std::sqrt(2.0 * pressure / unit.oil_density);
    chapter.add({"pressure at the flow that belongs to " + std::to_string(static_cast<int>(megapascal)) + " MPa", "MPa",
                 megapascal, 1e-6 * damper_pressure(unit, flow), within(1e-9, "round-off of an iteration"),
                 "closed form: Q = (A + c (dp - p_b)) sqrt(2 dp / rho)"});
  }
}

}  // namespace

void add_suspension(Chapter& chapter) {
  add_torsion_bar(chapter);
  add_gas_unit(chapter);
  add_damper(chapter);
}

}  // namespace grouser::validation
