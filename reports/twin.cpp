#include "reports/twin.h"

#include <algorithm>

namespace grouser {
namespace {

using nlohmann::json;

bool plain(const json& value) {
  return std::ranges::all_of(value, [](const json& item) { return item.is_number() || item.is_null(); });
}

void write(const json& value, std::size_t depth, std::string& text) {
  if (!value.is_structured() || value.empty() || (value.is_array() && plain(value))) {
    text += value.dump(-1, ' ', false, json::error_handler_t::replace);
    return;
  }
  const bool object = value.is_object();
  text += object ? '{' : '[';
  bool first = true;
  for (const auto& [key, item] : value.items()) {
    text += first ? "\n" : ",\n";
    first = false;
    text.append(depth + 1, ' ');
    if (object) text += json(key).dump() + ": ";
    write(item, depth + 1, text);
  }
  text += '\n';
  text.append(depth, ' ');
  text += object ? '}' : ']';
}

}  // namespace

json without_payloads(const json& value) {
  if (value.is_array()) {
    if (plain(value)) return value;
    json kept = json::array();
    for (const json& item : value) kept.push_back(without_payloads(item));
    return kept;
  }
  if (!value.is_object()) return value;
  json kept = json::object();
  for (const auto& [key, item] : value.items())
    if (!key.starts_with(k_payload_prefix)) kept[key] = without_payloads(item);
  return kept;
}

std::string twin_text(const json& facts) {
  std::string text;
  write(without_payloads(facts), 0, text);
  return text + "\n";
}

}  // namespace grouser
