#pragma once
#include <Eigen/Core>

#include "simulator/step.h"

namespace grouser::test {

/// Small motions of one side about a state: u'' = -K u - C u' with u the motions of its links (translations in W, turns
/// about their own axes), of the chassis and of the side's joints, by central differences of `evaluate`. Stops of the
/// rubber stick.
struct LinearVehicle {
  Eigen::MatrixXd stiffness, damping;
};
[[nodiscard]] LinearVehicle linearise(const System& system, const AssemblyKnobs& knobs, const State& state, Side side);

/// Step at which (4 beta - 3) h^2 K + 4 h C first has the eigenvalue 4 [s].
[[nodiscard]] double largest_stable_step(const LinearVehicle& vehicle, double beta);

}  // namespace grouser::test
