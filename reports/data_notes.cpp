#include <fmt/format.h>

#include <algorithm>

#include "reports/pages.h"
#include "reports/remedies.h"

namespace grouser {
namespace {

using nlohmann::json;

std::string where(const std::string& test) { return test.empty() ? "whole campaign" : test; }

}  // namespace

json warning_facts(const std::vector<FitWarning>& warnings) {
  json groups = json::array();
  for (const FitWarning& warning : warnings) {
    auto group = std::ranges::find_if(groups, [&](const json& g) { return g["code"] == warning.code; });
    if (group == groups.end()) {
      const Remedy remedy = remedy_of(warning.code);
      groups.push_back({{"code", warning.code},
                        {"title", remedy.title},
                        {"action", remedy.action},
                        {"correction", remedy.correction},
                        {"evidence", json::array()}});
      group = std::prev(groups.end());
    }
    (*group)["evidence"].push_back({{"test", where(warning.test)}, {"text", warning.text}});
  }
  constexpr std::size_t k_open = 4;  // more are folded away
  for (json& group : groups) {
    const std::size_t count = group["evidence"].size();
    group["folded"] = count > k_open;
    group["count"] = fmt::format("{} {}", count, count == 1 ? "warning" : "warnings");
  }
  return groups;
}

json correction_facts(const std::vector<AppliedCorrection>& corrections) {
  json rows = json::array();
  for (const AppliedCorrection& correction : corrections)
    rows.push_back({{"code", correction.code}, {"test", where(correction.test)}, {"text", correction.text}});
  return rows;
}

}  // namespace grouser
