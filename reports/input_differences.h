#pragma once
#include <optional>
#include <string>
#include <vector>

#include "model/run.h"

/// In which inputs several runs differ, read from the documents that every run folder keeps.
namespace grouser {

/// One input that is not the same in all runs. A quantity is one input whatever its unit; an input that left and right,
/// or several axes of `bushing_scale`, change alike is one too.
struct InputDifference {
  std::string label;                           ///< "bushing scale", "vehicle track pre tension"
  std::string unit;                            ///< of the numbers, as the first run spells it: "kN", "N s/m"; may be ""
  std::vector<std::optional<double>> numbers;  ///< of each run, in `unit`; empty where it is no number or not stated
  std::vector<std::string> texts;              ///< of each run, for tables; "–" where it is not stated
};

/// In the order of the documents: scenario, vehicle, bushings. Names, notes and provenance are no inputs. A document
/// that differs in very many places is one difference, told by its name.
[[nodiscard]] std::vector<InputDifference> input_differences(const std::vector<RunFolder>& runs);

}  // namespace grouser
