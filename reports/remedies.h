#pragma once
#include <string>

namespace grouser {

/// What a warning about the data means and what its reader can do.
struct Remedy {
  std::string title;       ///< "The force’s zero wanders"
  std::string action;      ///< what to do at the rig or in the rig file
  std::string correction;  ///< entry of `corrections` in the rig file that mends it; empty: none does
};
/// Of a FitWarning::code; an unknown code gives its words as title and no action.
[[nodiscard]] Remedy remedy_of(const std::string& code);

}  // namespace grouser
