#include "model/json_reader.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "model/provenance.h"

namespace grouser {
namespace {

const Json& empty_object() {
  static const Json empty = Json::object();
  return empty;
}

bool contains(const std::vector<std::string>& list, const std::string& word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

std::string with_article(const std::string& noun) {
  const bool vowel = std::string("aeiou").find(noun.front()) != std::string::npos;
  return (vowel ? "an " : "a ") + noun;
}

std::string expectation(const std::string& noun, Range range) {
  std::string text = with_article(noun);
  if (range == Range::positive) text += " > 0";
  if (range == Range::non_negative) text += " >= 0";
  return text;
}

bool satisfies(double value, Range range) {
  if (!std::isfinite(value)) return false;
  return range == Range::any || (range == Range::positive ? value > 0.0 : value >= 0.0);
}

std::string key_with_usual_unit(const std::string& name, const Dimension& dimension) {
  const std::string usual = usual_unit(dimension);
  return name + "_" + (usual.empty() ? "<unit>" : usual);
}

}  // namespace

ObjectReader::ObjectReader(const Json& value, std::string pointer, Findings& findings)
    : object_(&value), pointer_(std::move(pointer)), findings_(findings) {
  if (!value.is_object()) {
    findings_.add(pointer_, "an object", shown(value));
    object_ = &empty_object();
    usable_ = false;
  }
  const auto note = object_->find("note");
  if (note != object_->end() && note->is_string()) used_.emplace_back("note");
}

ObjectReader::~ObjectReader() {
  if (usable_) report_unasked();
}

void ObjectReader::report(const std::string& key, std::string expected, std::string found, std::string hint) {
  if (!usable_) return;
  findings_.add(key.empty() ? pointer_ : pointer_to(pointer_, key), std::move(expected), std::move(found),
                std::move(hint));
}

std::vector<std::string> ObjectReader::keys_of_quantity(const std::string& name) const {
  std::vector<std::string> keys;
  for (const auto& item : object_->items()) {
    const std::string& key = item.key();
    const bool named =
        key.size() > name.size() + 1 && key.compare(0, name.size(), name) == 0 && key[name.size()] == '_';
    if (named && parse_unit(std::string_view(key).substr(name.size() + 1))) keys.push_back(key);
  }
  return keys;
}

std::string ObjectReader::key_of(const std::string& name) const {
  const std::vector<std::string> keys = keys_of_quantity(name);
  return keys.empty() ? name : keys.front();
}

std::optional<ObjectReader::Found> ObjectReader::find_quantity(const std::string& name, const Dimension& dimension,
                                                               bool required) {
  known_.push_back({name, dimension});
  const std::vector<std::string> keys = keys_of_quantity(name);
  used_.insert(used_.end(), keys.begin(), keys.end());
  if (keys.empty()) {
    if (required) missing_.push_back({name, dimension});
    return std::nullopt;
  }
  if (keys.size() > 1) {
    report(keys[1], "each quantity once", "also " + keys[0]);
    return std::nullopt;
  }
  const Unit found = unit(std::string_view(keys[0]).substr(name.size() + 1));
  if (found.dimension != dimension) {
    report(keys[0], "a unit of " + name_of(dimension) + ", as in " + key_with_usual_unit(name, dimension),
           "a unit of " + name_of(found.dimension));
    return std::nullopt;
  }
  return Found{keys[0], found};
}

const Json* ObjectReader::find(const std::string& key, bool required) {
  known_.push_back({key, std::nullopt});
  const auto at = object_->find(key);
  if (at == object_->end()) {
    if (required) missing_.push_back({key, std::nullopt});
    return nullptr;
  }
  used_.push_back(key);
  return &*at;
}

double ObjectReader::number_at(const Json& value, const std::string& pointer, const std::string& what, Range range) {
  if (value.is_number() && satisfies(value.get<double>(), range)) return value.get<double>();
  findings_.add(pointer, expectation(what, range), shown(value));
  return range == Range::positive ? 1.0 : 0.0;
}

std::vector<double> ObjectReader::numbers_at(const Json& value, const std::string& pointer, const std::string& what,
                                             const Unit& unit, Range range) {
  std::vector<double> numbers;
  if (!value.is_array()) {
    findings_.add(pointer, "an array of numbers", shown(value));
    return numbers;
  }
  numbers.reserve(value.size());
  for (std::size_t i = 0; i < value.size(); ++i) {
    const std::string place = pointer_to(pointer, std::to_string(i));
    numbers.push_back(unit.to_si(number_at(value[i], place, what, range)));
    if (!std::isfinite(numbers.back())) findings_.add(place, "a number that a double can hold in SI", shown(value[i]));
  }
  return numbers;
}

std::optional<double> ObjectReader::optional_quantity(const std::string& name, const Dimension& dimension,
                                                      Range range) {
  const auto found = find_quantity(name, dimension, false);
  if (!found) return std::nullopt;
  const std::string pointer = pointer_to(pointer_, found->key);
  const double value = found->unit.to_si(number_at((*object_)[found->key], pointer, name_of(dimension), range));
  if (!std::isfinite(value))
    findings_.add(pointer, "a number that a double can hold in SI", shown((*object_)[found->key]));
  return value;
}

double ObjectReader::quantity(const std::string& name, const Dimension& dimension, Range range) {
  const auto value = optional_quantity(name, dimension, range);
  if (!value && keys_of_quantity(name).empty()) missing_.push_back({name, dimension});
  return value.value_or(range == Range::positive ? 1.0 : 0.0);
}

double ObjectReader::quantity_or(const std::string& name, const Dimension& dimension, double fallback, Range range) {
  return optional_quantity(name, dimension, range).value_or(fallback);
}

std::optional<std::vector<double>> ObjectReader::optional_quantities(const std::string& name,
                                                                     const Dimension& dimension) {
  const auto found = find_quantity(name, dimension, false);
  if (!found) return std::nullopt;
  const Json& value = (*object_)[found->key];
  if (value.is_array() && value.empty()) report(found->key, "at least 1 value", "none");
  return numbers_at(value, pointer_to(pointer_, found->key), name_of(dimension), found->unit);
}

std::vector<double> ObjectReader::quantities(const std::string& name, const Dimension& dimension) {
  auto values = optional_quantities(name, dimension);
  if (!values && keys_of_quantity(name).empty()) missing_.push_back({name, dimension});
  return values ? std::move(*values) : std::vector<double>{};
}

Vector3d ObjectReader::vector(const std::string& name, const Dimension& dimension, Range range) {
  const auto found = find_quantity(name, dimension, true);
  const Vector3d harmless = range == Range::positive ? Vector3d::Ones() : Vector3d::Zero();
  if (!found) return harmless;
  const Json& value = (*object_)[found->key];
  if (!value.is_array() || value.size() != 3) {
    report(found->key, "three numbers", shown(value));
    return harmless;
  }
  const auto numbers = numbers_at(value, pointer_to(pointer_, found->key), name_of(dimension), found->unit, range);
  return {numbers[0], numbers[1], numbers[2]};
}

std::vector<Vector3d> ObjectReader::vectors(const std::string& name, const Dimension& dimension,
                                            std::size_t components) {
  const auto found = find_quantity(name, dimension, true);
  if (!found) return {};
  const Json& value = (*object_)[found->key];
  const std::string pointer = pointer_to(pointer_, found->key);
  const std::string expected = std::to_string(components) + " numbers";
  if (!value.is_array()) {
    findings_.add(pointer, "an array, each item of " + expected, shown(value));
    return {};
  }
  std::vector<Vector3d> vectors;
  for (std::size_t i = 0; i < value.size(); ++i) {
    const std::string place = pointer_to(pointer, std::to_string(i));
    if (!value[i].is_array() || value[i].size() != components) {
      findings_.add(place, expected, shown(value[i]));
      continue;
    }
    const auto n = numbers_at(value[i], place, name_of(dimension), found->unit);
    vectors.emplace_back(components == 3 ? Vector3d(n[0], n[1], n[2]) : Vector3d(n[0], 0.0, n[1]));
  }
  return vectors;
}

double ObjectReader::number(const std::string& key, Range range) {
  const Json* value = find(key, true);
  if (value == nullptr) return range == Range::positive ? 1.0 : 0.0;
  return number_at(*value, pointer_to(pointer_, key), "number", range);
}

double ObjectReader::number_or(const std::string& key, double fallback, Range range) {
  const Json* value = find(key, false);
  return value == nullptr ? fallback : number_at(*value, pointer_to(pointer_, key), "number", range);
}

std::vector<double> ObjectReader::numbers_or_none(const std::string& key) {
  const Json* value = find(key, false);
  if (value == nullptr) return {};
  return numbers_at(*value, pointer_to(pointer_, key), "number", Unit{});
}

long ObjectReader::integer(const std::string& key, long least, long most) {
  if (find(key, true) == nullptr) return least;
  return integer_or(key, least, least, most);
}

long ObjectReader::integer_or(const std::string& key, long fallback, long least, long most) {
  const Json* value = find(key, false);
  if (value == nullptr) return fallback;
  const bool fits = value->is_number_integer() && std::abs(value->get<double>()) <= static_cast<double>(k_most_integer);
  const long number = fits ? value->get<long>() : least;
  if (fits && number >= least && number <= most) return number;
  std::string expected = "a whole number >= " + std::to_string(least);
  if (fits && number > most) expected = "a whole number from " + std::to_string(least) + " to " + std::to_string(most);
  report(key, std::move(expected), shown(*value));
  return least;
}

bool ObjectReader::boolean_or(const std::string& key, bool fallback) {
  const Json* value = find(key, false);
  if (value == nullptr) return fallback;
  if (value->is_boolean()) return value->get<bool>();
  report(key, "true or false", shown(*value));
  return fallback;
}

std::string ObjectReader::text(const std::string& key) { return find(key, true) == nullptr ? "" : text_or(key, ""); }

std::string ObjectReader::text_or(const std::string& key, const std::string& fallback) {
  const Json* value = find(key, false);
  if (value == nullptr) return fallback;
  if (value->is_string()) return value->get<std::string>();
  report(key, "a text", shown(*value));
  return fallback;
}

std::string ObjectReader::file_name_at(const Json* value, const std::string& key) {
  if (value == nullptr) return "";
  if (!value->is_string()) return text_or(key, "");
  std::string name = value->get<std::string>();
  if (!name.empty() && name.find('\0') == std::string::npos) return name;
  report(key, "the name of a file", shown(*value));
  return "";
}

std::vector<std::string> ObjectReader::texts_or_none(const std::string& key) {
  const Json* value = find(key, false);
  if (value == nullptr) return {};
  std::vector<std::string> texts;
  if (!value->is_array()) report(key, "an array of texts", shown(*value));
  for (std::size_t i = 0; value->is_array() && i < value->size(); ++i) {
    const Json& item = (*value)[i];
    if (item.is_string()) {
      texts.push_back(item.get<std::string>());
    } else {
      findings_.add(pointer_to(pointer_to(pointer_, key), std::to_string(i)), "a text", shown(item));
    }
  }
  return texts;
}

std::size_t ObjectReader::choice_index(const std::string& key, const std::vector<std::string>& words) {
  const Json* value = find(key, true);
  return value == nullptr ? 0 : index_of_word(*value, pointer_to(pointer_, key), words).value_or(0);
}

std::optional<std::size_t> ObjectReader::index_of_word(const Json& value, const std::string& pointer,
                                                       const std::vector<std::string>& words) {
  const std::string word = value.is_string() ? value.get<std::string>() : "";
  const auto at = std::find(words.begin(), words.end(), word);
  if (value.is_string() && at != words.end()) return static_cast<std::size_t>(at - words.begin());
  std::string expected;
  for (const std::string& w : words) expected += (expected.empty() ? "\"" : " | \"") + w + "\"";
  findings_.add(pointer, expected, shown(value), did_you_mean(nearest_word(word, words)));
  return std::nullopt;
}

std::vector<std::size_t> ObjectReader::choices_or_none(const std::string& key, const std::vector<std::string>& words) {
  const Json* value = find(key, false);
  if (value == nullptr) return {};
  if (!value->is_array()) {
    report(key, "an array of texts", shown(*value));
    return {};
  }
  std::set<std::size_t> chosen;
  for (std::size_t i = 0; i < value->size(); ++i) {
    const std::string place = pointer_to(pointer_to(pointer_, key), std::to_string(i));
    if (const auto index = index_of_word((*value)[i], place, words)) chosen.insert(*index);
  }
  return {chosen.begin(), chosen.end()};
}

void ObjectReader::object(const std::string& key, const Visit& visit) {
  if (find(key, true) != nullptr) optional_object(key, visit);
}

bool ObjectReader::optional_object(const std::string& key, const Visit& visit) {
  const Json* value = find(key, false);
  if (value == nullptr) return false;
  ObjectReader reader(*value, pointer_to(pointer_, key), findings_);
  if (reader.usable_) visit(reader);
  return true;
}

void ObjectReader::each(const std::string& key, std::size_t least, const Visit& visit) {
  const Json* value = find(key, true);
  if (value == nullptr) return;
  if (value->is_array() && value->size() < least) {
    report(key, "at least " + std::to_string(least) + " item" + (least == 1 ? "" : "s"), shown(*value));
  }
  each_optional(key, visit);
}

void ObjectReader::each_optional(const std::string& key, const Visit& visit) {
  const Json* value = find(key, false);
  if (value == nullptr) return;
  if (!value->is_array()) {
    report(key, "an array", shown(*value));
    return;
  }
  for (std::size_t i = 0; i < value->size(); ++i) {
    ObjectReader reader((*value)[i], pointer_to(pointer_to(pointer_, key), std::to_string(i)), findings_);
    if (reader.usable_) visit(reader);
  }
}

void ObjectReader::each_member(const std::function<void(const std::string&, const Json&)>& visit) {
  for (const auto& item : object_->items()) {
    used_.push_back(item.key());
    visit(item.key(), item.value());
  }
}

const Json* ObjectReader::raw(const std::string& key) { return find(key, false); }

std::string ObjectReader::suggestion(const std::string& key) const {
  std::vector<std::string> candidates;
  for (const Missing& known : known_) {
    if (!known.dimension) {
      if (!contains(used_, known.name)) candidates.push_back(known.name);
      continue;
    }
    if (!keys_of_quantity(known.name).empty()) continue;
    candidates.push_back(key_with_usual_unit(known.name, *known.dimension));
    for (std::size_t at = key.find('_'); at != std::string::npos; at = key.find('_', at + 1)) {
      const auto suffix = parse_unit(std::string_view(key).substr(at + 1));
      if (suffix && suffix->dimension == *known.dimension) candidates.push_back(known.name + key.substr(at));
    }
  }
  // Of a key that is there already the misspelt one is a second: an override, say.
  const std::string missing = nearest_word(key, candidates);
  return missing.empty() ? nearest_word(key, used_) : missing;
}

/// A required quantity that is there in the wrong form; returns whether a finding was made of it.
bool ObjectReader::explain_missing(const Missing& missing) {
  if (!missing.dimension) return false;
  const std::string wanted = key_with_usual_unit(missing.name, *missing.dimension);
  for (const auto& item : object_->items()) {
    const std::string& key = item.key();
    if (contains(used_, key) || key.compare(0, missing.name.size(), missing.name) != 0) continue;
    const std::string rest = key.substr(missing.name.size());
    if (!rest.empty() && rest.front() != '_') continue;
    report(key, "a unit of " + name_of(*missing.dimension) + " in the key, as in " + wanted,
           rest.empty() ? "no unit" : "the unknown unit " + rest.substr(1));
    used_.push_back(key);
    return true;
  }
  return false;
}

void ObjectReader::report_unasked() {
  std::vector<Missing> absent;
  for (const Missing& missing : missing_) {
    if (!explain_missing(missing)) absent.push_back(missing);
  }
  std::vector<std::string> suggested;
  for (const auto& item : object_->items()) {
    if (findings_.full()) return;
    if (contains(used_, item.key())) continue;
    const std::string meant = suggestion(item.key());
    suggested.push_back(meant);
    report(item.key(), "a known key", item.key(), did_you_mean(meant));
  }
  for (const Missing& missing : absent) {
    const auto is_meant = [&](const std::string& s) {
      return s == missing.name || (missing.dimension && s.rfind(missing.name + "_", 0) == 0);
    };
    if (std::any_of(suggested.begin(), suggested.end(), is_meant)) continue;  // one finding a mistake
    const std::string key = missing.dimension ? key_with_usual_unit(missing.name, *missing.dimension) : missing.name;
    report("", "the key " + key + (missing.dimension ? " (or another unit)" : ""), "no such key");
  }
}

void read_document(const Json& document, const std::string& format, Findings& findings,
                   const ObjectReader::Visit& visit) {
  if (!document.is_object()) {
    findings.add("", "an object with \"format\": \"" + format + "\"", shown(document));
    return;
  }
  const auto found = document.find("format");
  if (found == document.end() || *found != format) {
    findings.add(found == document.end() ? "" : "/format", "\"format\": \"" + format + "\"",
                 found == document.end() ? "no such key" : shown(*found));
    return;
  }
  ObjectReader reader(document, "", findings);
  static_cast<void>(reader.raw("format"));
  visit(reader);
}

void read_document(const std::filesystem::path& file, const std::string& format, const ObjectReader::Visit& visit) {
  Findings findings(file.string());
  const Json document = parse_json(read_whole(file), findings);
  const bool syntax_is_right = findings.empty() || !document.is_null();
  if (syntax_is_right) read_document(document, format, findings, visit);
  findings.throw_if_any();
}

}  // namespace grouser
