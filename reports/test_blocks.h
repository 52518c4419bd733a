#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "model/fit.h"

/// Blocks of a page over single tests, of one axis: shared by the pages of a fit and of a virtual rig.
namespace grouser {

/// What the blocks are about.
struct TestSet {
  Axis axis = Axis::x;
  std::vector<const TestFit*> tests;  ///< in reading order, see tests_of()
  std::string law = "fit";            ///< what the legend calls the computed response
  bool joint_fit = true;             ///< show each test's part in a joint fit: weight, gain, left-out error, force zero
  std::vector<FitWarning> warnings;  ///< may say why a test was left out
};

/// Facts for the template "tests": galleries of loops and residuals, the errors by test, the loop measures by test, and
/// every cycle. `id` begins the ids of its elements.
[[nodiscard]] nlohmann::json tests_facts(const TestSet& set, const std::string& id);

}  // namespace grouser
