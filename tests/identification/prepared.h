#pragma once
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "identification/prepared_test.h"
#include "tests/identification/bench.h"

namespace grouser {

/// The first test of a rig, prepared, with everything that was said about it.
struct Prepared {
  RigRecord rig;
  std::vector<FitWarning> warnings;
  std::vector<AppliedCorrection> corrections;
  PreparedTest test;
  explicit Prepared(RigTest source) : Prepared(record_of({std::move(source)})) {}
  explicit Prepared(RigRecord record)
      : rig(std::move(record)), test(prepare_test(rig.tests[0], rig, warnings, corrections)) {}
  Prepared(const Prepared&) = delete;
  Prepared& operator=(const Prepared&) = delete;

  /// Text of the warning with that code; empty without one.
  [[nodiscard]] std::string text(const std::string& code) const {
    const auto at = std::ranges::find(warnings, code, &FitWarning::code);
    return at == warnings.end() ? "" : at->text;
  }
  [[nodiscard]] const LoopMeasures& last() const { return test.cycles.back().measured; }
};

template <typename Entry>
[[nodiscard]] std::vector<std::string> codes(const std::vector<Entry>& entries) {
  std::vector<std::string> result;
  for (const Entry& entry : entries) result.push_back(entry.code);
  return result;
}

}  // namespace grouser
