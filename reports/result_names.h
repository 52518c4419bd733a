#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "model/run.h"

/// What a reader calls the named scalars of a run.
namespace grouser {

/// Heading under which a table puts a result: "Drive", "At rest", "Track", "Rubber", "Integration", "Contacts".
[[nodiscard]] std::string result_group(const RunResult& result);
/// "Largest tension in a bushing" of "largest_tension_N"; of a result that is not in the list its name in plain words,
/// without the unit.
[[nodiscard]] std::string result_label(const RunResult& result);

/// {value, unit, text} of a result: what is round-off of a computation reads "0", whatever the unit.
[[nodiscard]] nlohmann::json result_facts(double value, const std::string& unit, int digits = 4);

/// Mean number of contacts of one case (paper Section 5) that stand at a time.
[[nodiscard]] bool is_contact_count(const RunResult& result);
/// The partner that a contact case belongs to ("Sprocket") and what the case is ("driving flank").
struct ContactCase {
  std::string partner, meaning;
};
[[nodiscard]] ContactCase contact_case(const RunResult& result);

}  // namespace grouser
