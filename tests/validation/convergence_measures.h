#pragma once
#include <string>
#include <vector>

#include "simulator/assembly.h"

/// What is measured on a straight drive to see how it hangs on the step.
namespace grouser::validation {

/// How a quantity is judged: a mean, the amplitude of what fluctuates, or a peak.
enum class Kind { mean, fluctuation, peak };

struct Quantity {
  std::string name, unit;
  Kind kind = Kind::mean;
  double scale = 1.0;  ///< shown value = scale * SI value
  int digits = 2;      ///< shown behind the point
};
/// In the order of Measures::value.
[[nodiscard]] const std::vector<Quantity>& quantities();
/// Of the line that the fluctuation figure is about, in `quantities()`.
[[nodiscard]] int index_of_quantity(const std::string& name);

/// When the vehicle accelerates from rest, cruises and brakes, of a run A whose cruise may be longer [s].
struct Phases {
  double cruise_from = 10.0, cruise_to = 13.0, end = 17.0;
  double longer = 0.0;  ///< of the cruise, over run A's own
};

/// Steps of a tenth of a second of the drive.
struct TenthOfSteps {
  double time = 0.0;  ///< s, its middle
  double mean = 0.0, low = 0.0;
};

struct Measures {
  std::vector<double> value;           ///< SI, as quantities()
  double mean_step = 0.0;              ///< s, in cruise
  double residual_fraction = 0.0;      ///< of the energy book, the longer part of the cruise left out
  double error_share = 0.0;            ///< of the accepted steps in cruise: bounded by the error or by growth after it
  double stability_share = 0.0;        ///< bounded by stability
  long accepted = 0, evaluations = 0;  ///< whole run
  std::vector<TenthOfSteps> steps;     ///< over the run, by tenths of a second
};

/// Runs `system` from `start` to the end of its phases. Throws when a step fails.
[[nodiscard]] Measures measure(const System& system, const State& start, const AssemblyKnobs& knobs,
                               const Phases& phases);

}  // namespace grouser::validation
