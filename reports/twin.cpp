#include "reports/twin.h"

#include <algorithm>

#include "model/provenance.h"

namespace grouser {
namespace {

using nlohmann::json;

constexpr std::uintmax_t k_largest_twin = 100 << 20;  ///< bytes; that of the reference fit has 1.5 MB

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

json head_of_twin(const std::filesystem::path& file) {
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(file, unknown) || std::filesystem::file_size(file, unknown) > k_largest_twin)
    return {};
  const auto shallow = [](int depth, json::parse_event_t, json&) { return depth < 2; };
  json head = json::parse(read_whole(file), shallow, false);
  return head.is_object() && head.value("format", json()) == k_report_format ? head : json();
}

}  // namespace grouser
