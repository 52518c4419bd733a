#pragma once
#include <string>
#include <vector>

#include "simulator/assembly.h"

/// One piece of motion, short enough that chaos has not grown: fixed steps against another integrator.
namespace grouser::validation {

struct TrajectoryErrors {
  double from = 0.0;                       ///< s, of the drive
  std::vector<double> windows;             ///< s, lengths of the piece
  std::vector<double> steps;               ///< s, coarse to fine
  std::vector<std::vector<double>> error;  ///< m, [window][step]: largest |difference| of a link's position
  std::vector<double> reference_error;     ///< m, [window]: Runge-Kutta at its step against twice that step
  double reference_step = 0.0;             ///< s, of the Runge-Kutta run
};

/// From the state that a run of `system` has at `from`.
[[nodiscard]] TrajectoryErrors trajectory_errors(const System& system, const Assembled& rest, double from,
                                                 std::vector<double> windows, std::vector<double> steps,
                                                 double reference_step);

}  // namespace grouser::validation
