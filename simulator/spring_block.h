#pragma once
#include <array>

#include "model/geometry.h"
#include "simulator/lanes.h"

namespace grouser {

/// Hydropneumatic units of eight joints (model/vehicle.h), with what their laws need made ready. A joint without one
/// has a unit that carries nothing.
struct GasUnits {
  Lanes piston_area = 0.0;                     ///< m^2
  Lanes crank_radius = 0.0, rod_length = 1.0;  ///< m
  Lanes crank_angle = 0.0;                     ///< rad, at the design arm angle
  Lanes design_reach = 0.0;                    ///< m, from crank axle to piston at the design arm angle
  Lanes gas_volume = 1.0;                      ///< m^3 at the design arm angle
  Lanes rest_volume = 1.0;                     ///< m^3, that the gas fills at `gas_pressure` in this run
  Lanes gas_pressure = 0.0, atmosphere = 0.0;  ///< Pa
  Lanes exponent = 1.0;                        ///< n of p V^n
  Lanes compliance = 0.0;                      ///< 1 / (n - 1): energy over p V; 0 where n is 1
  Lanes isothermal_energy = 0.0;               ///< J a unit of ln(1/V) where n is 1
  Lanes orifice_area = 0.0;                    ///< m^2
  Lanes orifice_drag = 0.0;                    ///< Pa/(m^3/s)^2
  Lanes oil_density = 0.0;                     ///< kg/m^3
  Lanes blow_off_pressure = 0.0;               ///< Pa; infinite where nothing blows off
  Lanes blow_off_area = 0.0;                   ///< m^2/Pa
};

/// Eight joints with springs.
struct SpringBlock {
  int count = 0;                    ///< lanes in use, from the first
  std::array<int, k_lanes> body{};  ///< tree bodies; in a lane not in use one of the others
  bool any_gas = false;
  Lanes sign = 1.0;                                    ///< +1: bump is a positive joint angle
  Lanes stiffness = 0.0, damping = 0.0;                ///< N m/rad, N m s/rad
  Lanes free_angle = 0.0;                              ///< bump angle [rad] where the spring is free
  std::array<Lanes, k_num_sides> tensioner{0.0, 0.0};  ///< by side: 1 for a tensioner, whose free angle is a knob
  Lanes bump_angle = 0.0, rebound_angle = 0.0, stop_stiffness = 0.0;  ///< rad, rad, N m/rad
  GasUnits gas;
};

}  // namespace grouser
