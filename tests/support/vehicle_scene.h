#pragma once
#include "simulator/assembly.h"
#include "simulator/energy_book.h"
#include "tests/support/scenes.h"

namespace grouser::test {

/// The reference vehicle on rubber_bushing(), assembled once for the whole program.
struct VehicleScene {
  System system;
  Assembled rest;
};
[[nodiscard]] const VehicleScene& reference_scene();

/// Its system with other sprocket speeds: from 0 linearly to `left` and `right` [rad/s] at 1 s.
[[nodiscard]] System driven(double left, double right);

/// A run from rest.
struct ShortRun {
  State state;
  Acceleration acceleration;
  EnergyBook book;
  long steps = 0;
};
[[nodiscard]] ShortRun run_for(const System& system, const State& start, double duration);

}  // namespace grouser::test
