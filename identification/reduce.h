#pragma once
#include <cstddef>
#include <vector>

#include "identification/loop_measures.h"

namespace grouser {

/// First samples of the parts that a record's clock is whole in: 0, then every sample that comes more than five usual
/// steps after the one before it, or before it.
[[nodiscard]] std::vector<std::size_t> parts_of(const std::vector<double>& time);

/// A record with no more samples than a fit needs, and the first samples of its parts.
struct ReducedRecord {
  Signals signals;
  std::vector<std::size_t> parts;
};

/// A record of many more than 400 samples a cycle, brought down to about 400 in one pass: on its way from one reversal
/// to the next, equal numbers of samples are averaged, time, displacement and force alike, so that no phase is turned
/// between them and noise falls as in any mean. At each reversal stands the straight continuation of the two means
/// before it: means alone would cut half a bin off the tip of a ramp. Against the full record the area of a sine's loop
/// is short by 1.5 (2 pi / 400)^2 / 6 = 6e-5 and its force range by 4e-5; ramps keep both. Shorter records are returned
/// as they are.
[[nodiscard]] ReducedRecord reduce(Signals record, std::vector<std::size_t> parts);

}  // namespace grouser
