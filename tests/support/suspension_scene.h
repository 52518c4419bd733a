#pragma once
#include <cmath>

#include "simulator/suspension.h"

/// The torsion bar and the gas unit of a 51 t vehicle, an arm of 0.45 m at 25 degrees below horizontal.
namespace grouser::test {

inline constexpr double k_degree = k_pi / 180.0;
inline constexpr double k_arm = 0.45, k_design = 25.0 * k_degree;  // m, rad below horizontal

inline CompiledSuspension torsion_bar() {
  CompiledSuspension s;
  s.kind = JointSpring::torsion_bar;
  s.design_angle = k_design;
  s.bar = {5e4, 43.12 * k_degree, 300.0};
  s.bump_angle = 40.0 * k_degree;
  s.rebound_angle = 30.0 * k_degree;
  s.stop_stiffness = 1e6;
  return s;
}

/// A crank at right angles, whose lever is 0.12 m at design.
inline CompiledSuspension gas_unit() {
  CompiledSuspension s = torsion_bar();
  s.kind = JointSpring::hydropneumatic;
  s.unit.piston_area = 7.854e-3;
  s.unit.crank_radius = 0.12;
  s.unit.rod_length = 0.35;
  s.unit.crank_angle = 0.5 * k_pi;
  s.unit.gas_volume = 9.04e-4;
  s.unit.gas_pressure = 16.88e6;
  s.unit.polytropic_exponent = 1.3;
  s.unit.orifice_area = 17.85e-6;
  s.unit.blow_off_pressure = 4.5e6;
  s.unit.blow_off_area = 6.8e-12;
  s.unit.linear_damping = 1500.0;
  return s;
}

/// One joint spring by itself.
struct SpringMoment {
  double moment, energy, loss;
  bool bottomed;
};
inline SpringMoment tensioner_moment(const CompiledSuspension& s, double reference, double angle, double rate) {
  const SpringMoments m =
      spring_moments(arrange_springs(std::span(&s, 1)).front(), {reference, reference}, angle, rate);
  return {m.moment[0], m.energy[0], m.loss[0], (bits_of(m.bottomed) & 1u) != 0};
}
inline SpringMoment station_moment(const CompiledSuspension& s, double angle, double rate) {
  return tensioner_moment(s, 0.0, angle, rate);
}

/// One gas unit by itself.
inline GasUnits alone(const Hydropneumatic& unit) {
  CompiledSuspension s;
  s.kind = JointSpring::hydropneumatic;
  s.unit = unit;
  return arrange_springs(std::span(&s, 1)).front().gas;
}
struct Stroke {
  double stroke, lever;
};
inline Stroke piston_stroke(const Hydropneumatic& unit, double bump_angle) {
  const Strokes strokes = piston_strokes(alone(unit), bump_angle);
  return {strokes.stroke[0], strokes.lever[0]};
}
inline double damper_pressure(const Hydropneumatic& unit, double flow) {
  return grouser::damper_pressure(alone(unit), flow)[0];
}

/// Vertical wheel force [N] that balances the spring at a bump angle.
inline double wheel_force(const CompiledSuspension& s, double bump) {
  return -station_moment(s, bump, 0.0).moment / (k_arm * std::cos(k_design - bump));
}
/// Bump angle [rad] at which the wheel stands `rise` [m] above design.
inline double bump_at_rise(double rise) { return k_design - std::asin(std::sin(k_design) - rise / k_arm); }
/// Rate of that force over the wheel's rise [N/m], by a central difference over 2e-5 rad.
inline double wheel_rate(const CompiledSuspension& s, double bump) {
  constexpr double k_step = 1e-5;
  const double rise = k_arm * (std::sin(k_design - bump + k_step) - std::sin(k_design - bump - k_step));
  return (wheel_force(s, bump + k_step) - wheel_force(s, bump - k_step)) / rise;
}

}  // namespace grouser::test
