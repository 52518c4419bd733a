#pragma once
#include <functional>

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
/// Steps from `start` to `until`; `look` sees every accepted step. Throws when a step fails.
ShortRun follow(const System& system, const State& start, const AssemblyKnobs& knobs, double until,
                const std::function<void(const Stepper&)>& look = {});
/// The same with the knobs of reference_scene().
[[nodiscard]] ShortRun run_for(const System& system, const State& start, double duration);

/// The same state in a world turned by `angle` about z.
[[nodiscard]] State turned(const State& state, double angle);

}  // namespace grouser::test
