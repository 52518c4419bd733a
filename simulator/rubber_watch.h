#pragma once
#include "model/run.h"
#include "simulator/workspace.h"

namespace grouser {

/// Largest and root mean square over all bushings and over time.
struct LoadMeasure {
  double largest = 0.0;      ///< of the absolute value, any bushing, any step
  double square_time = 0.0;  ///< integral of the mean square over the bushings
};

/// What the rubber of ONE bushing carries, over the accepted steps of a run. A single pin has one bushing a joint, a
/// double pin two, each with its own loads: the measures of both kinds of track can be compared as they are.
struct RubberLoads {
  double time = 0.0;                                    ///< s
  LoadMeasure torsion;                                  ///< rad, hinge angle from where the rubber is free
  LoadMeasure torsion_moment;                           ///< N m
  LoadMeasure radial_force;                             ///< N, across the pin: x and z
  LoadMeasure axial_force;                              ///< N, along the pin
  std::array<double, k_num_axes> largest_deflection{};  ///< m, rad, from the free state
  double largest_tension = -std::numeric_limits<double>::infinity();  ///< N, x of any bushing
  double least_tension = std::numeric_limits<double>::infinity();
};

/// Adds an accepted step of length h that led to `state`.
void watch_rubber(const System& system, const State& state, const Workspace& work, double h, RubberLoads& loads);

/// bushing_torsion_* and the like.
[[nodiscard]] std::vector<RunResult> rubber_results(const RubberLoads& loads);

}  // namespace grouser
