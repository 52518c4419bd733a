#include "model/overrides.h"

#include <algorithm>
#include <charconv>

#include "model/units.h"
#include "model/utf8.h"

namespace grouser {
namespace {

std::vector<std::string> steps_of(const std::string& path) {
  const char separator = path.find('/') == std::string::npos ? '.' : '/';
  std::vector<std::string> steps;
  std::size_t begin = path.front() == separator ? 1 : 0;
  while (begin <= path.size()) {
    const std::size_t end = std::min(path.find(separator, begin), path.size());
    steps.push_back(path.substr(begin, end - begin));
    begin = end + 1;
  }
  return steps;
}

std::vector<std::string> keys_of(const Json& object) {
  std::vector<std::string> keys;
  for (const auto& item : object.items()) keys.push_back(item.key());
  return keys;
}

Json* element(Json& array, const std::string& step) {
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(step.data(), step.data() + step.size(), index);
  const bool whole = error == std::errc() && end == step.data() + step.size();
  return whole && index < array.size() ? &array[index] : nullptr;
}

/// A text that is not JSON is meant as itself: `--set left.track.connection=double_pin`.
Json parsed(const std::string& value) {
  Json json = Json::parse(value, nullptr, false);
  return json.is_discarded() ? Json(value) : json;
}

/// `max_step_s` and `max_step_ms` are one quantity.
void remove_same_quantity(Json& object, const std::string& key) {
  const auto given = split_name_and_unit(key);
  if (!given || object.contains(key)) return;
  for (const std::string& other : keys_of(object)) {
    const auto standing = split_name_and_unit(other);
    if (standing && standing->name == given->name) object.erase(other);
  }
}

}  // namespace

void apply_override(Json& document, const std::string& path, const std::string& value, Findings& findings) {
  if (path.empty()) return findings.add("--set", "path=value", "=" + value);
  if (!is_utf8(path) || !is_utf8(value)) return findings.add("--set", "text in UTF-8", path + "=" + value);
  const std::vector<std::string> steps = steps_of(path);
  Json* here = &document;
  std::string pointer;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const bool last = i + 1 == steps.size();
    const std::string& step = steps[i];
    if (here->is_array()) {
      Json* next = element(*here, step);
      const std::string range = "an index below " + std::to_string(here->size());
      if (next == nullptr) return findings.add(pointer_to(pointer, step), range, step, "in --set " + path);
      here = next;
    } else if (here->is_object()) {
      const bool unknown_step = !last && !here->contains(step);
      const std::string meant = unknown_step ? nearest_word(step, keys_of(*here)) : "";
      if (!meant.empty()) {
        return findings.add(pointer_to(pointer, step), "a known key", step, did_you_mean(meant));
      }
      if (last) remove_same_quantity(*here, step);
      if (unknown_step) (*here)[step] = Json::object();
      here = &(*here)[step];
    } else {
      return findings.add(pointer.empty() ? "--set" : pointer, "an object or an array on the way of --set " + path,
                          shown(*here));
    }
    pointer = pointer_to(pointer, step);
  }
  *here = parsed(value);
}

}  // namespace grouser
