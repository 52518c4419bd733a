#pragma once
#include <vector>

#include "render/figure.h"
#include "tests/validation/convergence_ladder.h"
#include "tests/validation/convergence_trajectory.h"

/// The figures of docs/convergence.md.
namespace grouser::validation {

[[nodiscard]] Figure figure_fluctuation(const Ladder& ladder);
[[nodiscard]] Figure figure_means_and_peaks(const Ladder& ladder);
[[nodiscard]] Figure figure_residual(const Ladder& ladder);
/// The paper's Fig. 4 at two tolerances.
[[nodiscard]] Figure figure_step_size(const Ladder& ladder, const System& system, const std::string& fine);
[[nodiscard]] Figure figure_trajectory(const TrajectoryErrors& errors);

}  // namespace grouser::validation
