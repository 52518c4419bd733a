#pragma once
#include <span>

#include "simulator/assembly.h"
#include "simulator/step.h"

/// The stages of a step, each alone on a state of the reference vehicle, for the programs that time them.
namespace grouser::benchmarks {

inline constexpr double k_step = 1e-4;  ///< s, about the mean step of run A

/// A vehicle in one state, with everything that a stage reads already computed.
struct Scene {
  System system;
  AssemblyKnobs knobs;
  State before, state;
  Acceleration acceleration_before, acceleration;
  Workspace work;
};
/// Run A's vehicle after one step from rest, and at 50 km/h.
[[nodiscard]] const Scene& rest_scene();
[[nodiscard]] const Scene& cruise_scene();

struct Stage {
  const char* name;
  void (*run)(Scene&);
};
/// The whole evaluation first, then its parts in their order, then what follows it.
[[nodiscard]] std::span<const Stage> stages();

}  // namespace grouser::benchmarks
