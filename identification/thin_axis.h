#pragma once
#include <deque>

#include "identification/axis_problem.h"

namespace grouser {

/// A small stand-in for an axis' data, whatever the length of the records: of every block the two cycles in its middle
/// with about 100 samples each, reversals kept, and two cycles of history before them. Yields and relaxation times are
/// searched on it; ranges, measured energies and weights are those of the whole data.
struct ThinAxis {
  std::deque<PreparedTest> tests;  ///< `data` points into it; moving keeps their places
  AxisData data;
};
[[nodiscard]] ThinAxis thin(const AxisData& data);

}  // namespace grouser
