#include <algorithm>

#include "reports/number_text.h"
#include "reports/pages.h"

namespace grouser {

using nlohmann::json;

json quantity_facts(double value, const std::string& unit, int digits) {
  return {{"value", value}, {"unit", unit}, {"text", quantity_text(value, unit, digits)}};
}

int tile_columns(std::size_t num_tiles) {
  if (num_tiles <= 5) return static_cast<int>(num_tiles);
  return num_tiles == 6 ? 3 : num_tiles <= 8 ? 4 : 5;
}

json labelled_quantity(const std::string& label, double value, const std::string& unit, int digits) {
  json facts = quantity_facts(value, unit, digits);
  facts["label"] = label;
  return facts;
}

json provenance_facts(const Provenance& provenance, const std::vector<std::string>& commands) {
  json facts{{"program", provenance.program}, {"version", provenance.version}, {"hash", "SHA-256"},
             {"commands", commands},          {"inputs", json::array()},       {"options", json::array()}};
  for (const Provenance::Input& input : provenance.inputs)
    facts["inputs"].push_back({{"role", input.role}, {"path", input.path}, {"sha256", input.sha256}});
  for (const auto& [name, value] : provenance.options) facts["options"].push_back({{"name", name}, {"value", value}});
  facts["has_options"] = !provenance.options.empty();
  facts["has_inputs"] = !provenance.inputs.empty();
  return facts;
}

}  // namespace grouser
