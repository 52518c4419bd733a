#pragma once
#include <string>
#include <vector>

#include "model/run.h"

/// The numbers by which a study tells one run from another.
namespace grouser {

/// Measures that belong into one panel, with how it is drawn.
struct MeasureGroup {
  const char* key;
  const char* title;
  const char* y_label;
  double scale;  ///< from SI to the unit of the label
  bool log_y;
};
/// All groups, in the order in which a reader wants them.
[[nodiscard]] const std::vector<MeasureGroup>& measure_groups();

struct Measure {
  std::string group;  ///< key of its group
  std::string name;   ///< "upper run"; alone in its group: what the group's title says
  std::string unit;   ///< SI
  double value = 0.0;
};

/// What the run holds of: mean tension of each span of the track (both sides, over the steady drive, else over the
/// whole run), largest and least tension in a bushing, sprocket torque at link passing, the force that 99.9 % of the
/// contact samples of a partner stay below (all links, whole run), step sizes and what bounded them, force evaluations
/// a simulated second, rolling resistance (sprocket work over distance in the steady drive), energy residual, ride
/// height, twist and hinge moment of one bushing, and how far the rubber was deflected beyond what was identified.
[[nodiscard]] std::vector<Measure> run_measures(const RunFolder& run);

}  // namespace grouser
