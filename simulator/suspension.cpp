#include "simulator/suspension.h"

#include <algorithm>
#include <cmath>

namespace grouser {
namespace {

constexpr double k_atmosphere = 1.0e5;  // Pa

SpringMoment bar_moment(const CompiledSuspension& s, double bump, double bump_rate) {
  const double twist = s.bar.free_angle - (s.design_angle - bump);
  return {-s.bar.stiffness * twist - s.bar.damping * bump_rate, 0.5 * s.bar.stiffness * twist * twist,
          s.bar.damping * bump_rate * bump_rate, false};
}

SpringMoment gas_moment(const Hydropneumatic& unit, double bump, double bump_rate) {
  const Stroke stroke = piston_stroke(unit, bump);
  // Below 2 % of its volume at rest (some 3 GPa) the gas carries nothing real: bottomed. The floor keeps the figures of
  // the step that is then refused finite.
  const double at_rest = unit.gas_volume * unit.gas_temperature / unit.gas_charge_temperature, least = 0.02 * at_rest;
  const double left = unit.gas_volume - unit.piston_area * stroke.stroke, volume = std::max(left, least);
  const double n = unit.polytropic_exponent;
  const double pressure = unit.gas_pressure * std::pow(at_rest / volume, n);
  const double work_of_gas = std::abs(n - 1.0) > 1e-9 ? pressure * volume / (n - 1.0)
                                                      : -unit.gas_pressure * at_rest * std::log(volume / at_rest);
  const double area_lever = unit.piston_area * stroke.lever;
  const double flow = area_lever * bump_rate;
  const double damping =
      damper_pressure(unit, std::abs(flow)) * area_lever * (flow < 0.0 ? -1.0 : 1.0) + unit.linear_damping * bump_rate;
  return {-area_lever * (pressure - k_atmosphere) - damping, work_of_gas + k_atmosphere * volume, damping * bump_rate,
          left < least};
}

/// Elastic end stops of the arm's travel.
void add_stops(const CompiledSuspension& s, double bump, SpringMoment& m) {
  const double over = bump > s.bump_angle ? bump - s.bump_angle : std::min(0.0, bump + s.rebound_angle);
  m.moment -= s.stop_stiffness * over;
  m.energy += 0.5 * s.stop_stiffness * over * over;
}

}  // namespace

Stroke piston_stroke(const Hydropneumatic& unit, double bump_angle) {
  // Slider-crank s(phi) = r cos(phi) + sqrt(l^2 - r^2 sin^2(phi)) (D 4.2): the piston moves in as s falls.
  const double r = unit.crank_radius, l = unit.rod_length;
  const auto reach = [&](double phi) {
    return r * std::cos(phi) + std::sqrt(l * l - r * r * std::sin(phi) * std::sin(phi));
  };
  const double phi = unit.crank_angle + bump_angle;
  const double root = std::sqrt(l * l - r * r * std::sin(phi) * std::sin(phi));
  return {reach(unit.crank_angle) - reach(phi), r * std::sin(phi) + r * r * std::sin(phi) * std::cos(phi) / root};
}

double damper_pressure(const Hydropneumatic& unit, double flow) {
  if (flow <= 0.0 || unit.orifice_area <= 0.0) return 0.0;
  const double through_orifice = flow / unit.orifice_area;
  const double pressure = 0.5 * unit.oil_density * through_orifice * through_orifice;
  if (pressure <= unit.blow_off_pressure || unit.blow_off_area <= 0.0) return pressure;
  // flow = (A_o + c (rho y^2 / 2 - p_b)) y with the jet speed y: monotone above the knee, Newton from the knee.
  double y = std::sqrt(2.0 * unit.blow_off_pressure / unit.oil_density);
  for (int i = 0; i < 30; ++i) {
    const double area =
        unit.orifice_area + unit.blow_off_area * (0.5 * unit.oil_density * y * y - unit.blow_off_pressure);
    const double residual = area * y - flow, slope = area + unit.blow_off_area * unit.oil_density * y * y;
    const double change = residual / slope;
    y -= change;
    if (std::abs(change) < 1e-12 * y) break;
  }
  return 0.5 * unit.oil_density * y * y;
}

SpringMoment station_moment(const CompiledSuspension& s, double angle, double rate) {
  const double bump = s.bump_sign * angle, bump_rate = s.bump_sign * rate;
  SpringMoment m =
      s.kind == JointSpring::torsion_bar ? bar_moment(s, bump, bump_rate) : gas_moment(s.unit, bump, bump_rate);
  add_stops(s, bump, m);
  m.moment *= s.bump_sign;
  return m;
}

SpringMoment tensioner_moment(const CompiledSuspension& s, double reference, double angle, double rate) {
  const double stretch = angle - reference;
  return {-s.tensioner_stiffness * stretch - s.tensioner_damping * rate,
          0.5 * s.tensioner_stiffness * stretch * stretch, s.tensioner_damping * rate * rate, false};
}

void suspension_forces(const System& system, const AssemblyKnobs& knobs, const State& state, Workspace& work) {
  for (const CompiledSuspension& spring : system.suspension) {
    const double angle = state.chassis.angle[spring.body], rate = state.chassis.rate[spring.body];
    const bool tensioner = spring.kind == JointSpring::tensioner;
    const auto side = static_cast<std::size_t>(index_of(spring.side));
    const SpringMoment m = tensioner ? tensioner_moment(spring, knobs.tensioner_reference[side], angle, rate)
                                     : station_moment(spring, angle, rate);
    work.chassis.joint_torque[spring.body] = m.moment;
    work.energy.suspension += m.energy;
    if (m.bottomed) work.bottomed_unit = spring.body;
    (tensioner ? work.energy.tensioner_power : work.energy.suspension_power) += m.loss;
  }
}

}  // namespace grouser
