#include "simulator/suspension.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "simulator/lane_exponential.h"
#include "simulator/lane_trigonometry.h"

namespace grouser {
namespace {

constexpr double k_atmosphere = 1.0e5;  // Pa

void set_unit(const Hydropneumatic& unit, int lane, GasUnits& gas) {
  const double n = unit.polytropic_exponent;
  const double at_rest = unit.gas_volume * unit.gas_temperature / unit.gas_charge_temperature;
  const bool isothermal = std::abs(n - 1.0) <= 1e-9;
  gas.piston_area.set(lane, unit.piston_area);
  gas.crank_radius.set(lane, unit.crank_radius);
  gas.rod_length.set(lane, unit.rod_length);
  gas.crank_angle.set(lane, unit.crank_angle);
  gas.gas_volume.set(lane, unit.gas_volume);
  gas.rest_volume.set(lane, at_rest);
  gas.gas_pressure.set(lane, unit.gas_pressure);
  gas.atmosphere.set(lane, k_atmosphere);
  gas.exponent.set(lane, n);
  gas.compliance.set(lane, isothermal ? 0.0 : 1.0 / (n - 1.0));
  gas.isothermal_energy.set(lane, isothermal ? unit.gas_pressure * at_rest : 0.0);
  if (unit.orifice_area <= 0.0) return;
  gas.orifice_area.set(lane, unit.orifice_area);
  gas.orifice_drag.set(lane, 0.5 * unit.oil_density / (unit.orifice_area * unit.orifice_area));
  gas.oil_density.set(lane, unit.oil_density);
  gas.blow_off_area.set(lane, unit.blow_off_area);
  gas.blow_off_pressure.set(
      lane, unit.blow_off_area > 0.0 ? unit.blow_off_pressure : std::numeric_limits<double>::infinity());
}

void set_spring(const CompiledSuspension& s, int lane, SpringBlock& block) {
  block.sign.set(lane, s.bump_sign);
  if (s.kind == JointSpring::tensioner) {
    block.stiffness.set(lane, s.tensioner_stiffness);
    block.damping.set(lane, s.tensioner_damping);
    block.tensioner[static_cast<std::size_t>(index_of(s.side))].set(lane, 1.0);
    return;
  }
  block.bump_angle.set(lane, s.bump_angle);
  block.rebound_angle.set(lane, s.rebound_angle);
  block.stop_stiffness.set(lane, s.stop_stiffness);
  if (s.kind == JointSpring::torsion_bar) {
    block.stiffness.set(lane, s.bar.stiffness);
    block.damping.set(lane, s.bar.damping);
    block.free_angle.set(lane, s.design_angle - s.bar.free_angle);
  } else {
    block.any_gas = true;
    block.damping.set(lane, s.unit.linear_damping);
    set_unit(s.unit, lane, block.gas);
  }
}

/// Adds what gas and damper do at a bump angle and its rate; moments towards bump.
void add_gas(const GasUnits& unit, const Lanes& bump, const Lanes& bump_rate, SpringMoments& m) {
  const Strokes piston = piston_strokes(unit, bump);
  // Below 2 % of its volume at rest (some 3 GPa) the gas carries nothing real: bottomed. The floor keeps the figures of
  // the step that is then refused finite.
  const Lanes least = 0.02 * unit.rest_volume, left = unit.gas_volume - unit.piston_area * piston.stroke;
  const Lanes volume = left.max(least), log_ratio = natural_logarithm(unit.rest_volume / volume);
  const Lanes pressure = unit.gas_pressure * exp(unit.exponent * log_ratio);
  const Lanes area_lever = unit.piston_area * piston.lever, flow = area_lever * bump_rate;
  const Lanes resistance = damper_pressure(unit, flow.abs()), pushed_back = resistance * area_lever;
  m.moment -= area_lever * (pressure - unit.atmosphere) + choose(flow < 0.0, -pushed_back, pushed_back);
  m.energy += unit.compliance * pressure * volume + unit.isothermal_energy * log_ratio + unit.atmosphere * volume;
  m.loss += resistance * flow.abs();
  m.bottomed = left < least;
}

}  // namespace

std::vector<SpringBlock> arrange_springs(std::span<const CompiledSuspension> springs) {
  std::vector<SpringBlock> blocks;
  for (const CompiledSuspension& spring : springs) {
    if (blocks.empty() || blocks.back().count == k_lanes) {
      blocks.emplace_back();
      blocks.back().body.fill(spring.body);
    }
    SpringBlock& block = blocks.back();
    const int lane = block.count++;
    block.body[static_cast<std::size_t>(lane)] = spring.body;
    set_spring(spring, lane, block);
  }
  for (SpringBlock& block : blocks) block.gas.design_reach = -piston_strokes(block.gas, 0.0).stroke;
  return blocks;
}

Strokes piston_strokes(const GasUnits& units, const Lanes& bump_angle) {
  // Slider-crank s(phi) = r cos(phi) + sqrt(l^2 - r^2 sin^2(phi)): the piston moves in as s falls.
  const SineCosine phi = sine_cosine(units.crank_angle + bump_angle);
  const Lanes aside = units.crank_radius * phi.sine, along = units.crank_radius * phi.cosine;
  const Lanes rod = (units.rod_length * units.rod_length - aside * aside).sqrt();
  return {units.design_reach - (along + rod), aside + aside * along / rod};
}

Lanes damper_pressure(const GasUnits& units, const Lanes& flow) {
  const Lanes of_orifice = units.orifice_drag * flow * flow;
  const LaneMask open = units.blow_off_pressure < of_orifice;
  if (bits_of(open) == 0) return of_orifice;
  // flow = (A_o + c (rho y^2 / 2 - p_b)) y with the jet speed y: monotone above the knee, Newton from the knee. The
  // error left is of the order of the last change's square. Each joint stops for itself: what stands in the other lanes
  // must not show, for a vehicle has two sides.
  const Lanes density = choose(open, units.oil_density, 1.0),
              pressure_at_knee = choose(open, units.blow_off_pressure, 0.0);
  Lanes y = (2.0 * pressure_at_knee / density).sqrt();
  LaneMask moving = open;
  for (int i = 0; i < 30 && bits_of(moving) != 0; ++i) {
    const Lanes of_jet = density * y * y;
    const Lanes area = units.orifice_area + units.blow_off_area * (0.5 * of_jet - pressure_at_knee);
    const Lanes slope = choose(moving, area + units.blow_off_area * of_jet, 1.0);  // 0 where there is no unit
    const Lanes change = (area * y - flow) / slope;
    y -= choose(moving, change, 0.0);
    moving = moving & (1e-7 * y < change.abs());
  }
  return choose(open, 0.5 * density * y * y, of_orifice);
}

SpringMoments spring_moments(const SpringBlock& springs, const std::array<double, k_num_sides>& reference,
                             const Lanes& angle, const Lanes& rate) {
  const Lanes bump = springs.sign * angle, bump_rate = springs.sign * rate;
  const Lanes free_angle =
      springs.free_angle + springs.tensioner[0] * reference[0] + springs.tensioner[1] * reference[1];
  const Lanes stretch = bump - free_angle;
  const Lanes over = (bump - springs.bump_angle).max(0.0) + (bump + springs.rebound_angle).min(0.0);
  const Lanes elastic = springs.stiffness * stretch, stop = springs.stop_stiffness * over;
  const Lanes damping = springs.damping * bump_rate;
  SpringMoments m{-(elastic + stop + damping), 0.5 * (elastic * stretch + stop * over), damping * bump_rate,
                  LaneMask::first(0)};
  if (springs.any_gas) add_gas(springs.gas, bump, bump_rate, m);
  m.moment *= springs.sign;
  return m;
}

void suspension_forces(const AssemblyKnobs& knobs, const State& state, Workspace& work) {
  for (const SpringBlock& springs : work.suspension) {
    const SpringMoments m =
        spring_moments(springs, knobs.tensioner_reference, gather(state.chassis.angle.data(), springs.body),
                       gather(state.chassis.rate.data(), springs.body));
    const Lanes of_tensioners = (springs.tensioner[0] + springs.tensioner[1]) * m.loss;
    for (int lane = 0; lane < springs.count; ++lane) {
      const int body = springs.body[static_cast<std::size_t>(lane)];
      work.chassis.joint_torque[body] = m.moment[lane];
      if ((bits_of(m.bottomed) >> lane & 1u) != 0) work.bottomed_unit = body;
    }
    work.energy.suspension += m.energy.sum();
    work.energy.tensioner_power += of_tensioners.sum();
    work.energy.suspension_power += (m.loss - of_tensioners).sum();
  }
}

}  // namespace grouser
