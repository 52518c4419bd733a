#include "reports/input_differences.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>

#include "model/provenance.h"
#include "model/units.h"
#include "reports/number_text.h"

namespace grouser {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t k_many = 12;  ///< differences of one document that a table still shows

/// One plain value of a document.
struct Leaf {
  std::optional<double> number;  ///< in SI where the key says a unit
  std::string text;
  std::string suffix;  ///< unit as the key spells it
};

/// Values of one document by their path, in the document's order; a path is without units.
struct Flat {
  std::vector<std::string> order;
  std::map<std::string, Leaf> values;
};

bool is_no_input(const std::string& key) {
  static constexpr std::array<const char*, 8> k_words{"format", "name",    "note",    "provenance",
                                                      "visual", "vehicle", "bushing", "synthetic"};
  return std::ranges::find(k_words, key) != k_words.end();
}

void flatten(const Json& value, const std::string& path, const std::string& suffix, Flat& flat) {
  if (value.is_object()) {
    for (const auto& [key, item] : value.items()) {
      if (is_no_input(key)) continue;
      const std::optional<NamedUnit> quantity = split_name_and_unit(key);
      flatten(item, path + "/" + (quantity ? quantity->name : key), quantity ? quantity->suffix : suffix, flat);
    }
    return;
  }
  if (value.is_array()) {
    for (std::size_t i = 0; i < value.size(); ++i) flatten(value[i], path + "/" + std::to_string(i), suffix, flat);
    return;
  }
  Leaf leaf{{}, value.is_string() ? value.get<std::string>() : value.dump(), suffix};
  if (value.is_number()) {
    const double number = value.get<double>();
    leaf.number = suffix.empty() ? number : unit(suffix).to_si(number);
  }
  if (flat.values.emplace(path, leaf).second) flat.order.push_back(path);
}

/// A factor for every axis, as the reader understands one for all of them.
void expand_bushing_scale(Json& scenario) {
  const Json given = scenario.value("bushing_scale", Json(1.0));
  Json axes = Json::object();
  for (const char* axis : k_axis_names) axes[axis] = given.is_object() ? given.value(axis, 1.0) : given.get<double>();
  scenario["bushing_scale"] = axes;
}

/// Path with what may be alike several times replaced by "*": the side, and the axis of a bushing's scale.
std::string family_of(const std::string& path, std::string& member) {
  for (const std::string side : {"left", "right"}) {
    const std::size_t at = ("/" + path + "/").find("/" + side + "/");
    if (at == std::string::npos) continue;
    member = side;
    return std::string(path).replace(at, side.size(), "*");
  }
  const std::string scale = "/bushing_scale/";
  if (!path.starts_with(scale)) return path;
  member = path.substr(scale.size());
  return scale + "*";
}

std::string spelled(const std::string& suffix) {
  std::string text = suffix;
  const std::size_t per = text.find("_per_");
  if (per != std::string::npos) text.replace(per, 5, "/");
  std::ranges::replace(text, '_', ' ');
  return text;
}

/// One member of a family, with its value in every run.
struct Row {
  std::string member;
  std::vector<const Leaf*> leaves;
};

bool same(const Leaf* a, const Leaf* b) {
  if (a == nullptr || b == nullptr) return a == b;
  return a->number && b->number ? *a->number == *b->number : a->text == b->text;
}

bool alike(const Row& a, const Row& b) {
  return std::ranges::equal(a.leaves, b.leaves, [](const Leaf* x, const Leaf* y) { return same(x, y); });
}

std::string label_of(const std::string& document, const std::string& family, const std::string& members) {
  std::string label = document == "scenario" ? "" : document;
  std::string word;
  for (const char c : family + "/") {
    if (c != '/') {
      word += c == '_' ? ' ' : c;
      continue;
    }
    if (!word.empty() && word != "*") label += (label.empty() ? "" : " ") + word;
    word.clear();
  }
  for (const auto& [plain, right] : {std::pair{"pre tension", "pre-tension"}, {"pre torsion", "pre-torsion"}})
    if (const std::size_t at = label.find(plain); at != std::string::npos) label.replace(at, 11, right);
  return members.empty() ? label : label + " (" + members + ")";
}

InputDifference difference_of(const std::string& label, const Row& row) {
  InputDifference difference{label, "", {}, {}};
  std::string suffix;
  for (const Leaf* leaf : row.leaves)
    if (leaf != nullptr && suffix.empty()) suffix = leaf->suffix;
  difference.unit = spelled(suffix);
  for (const Leaf* leaf : row.leaves) {
    std::optional<double> number;
    if (leaf != nullptr && leaf->number) number = suffix.empty() ? *leaf->number : unit(suffix).from_si(*leaf->number);
    difference.numbers.push_back(number);
    const std::string with_unit = number ? number_text(*number) + (suffix.empty() ? "" : " " + difference.unit) : "";
    difference.texts.push_back(leaf == nullptr ? "–" : number ? with_unit : leaf->text);
  }
  return difference;
}

/// Members of a family that are alike become one difference; all of them need no telling which.
void add_family(const std::string& document, const std::string& family, std::vector<Row> rows, std::size_t family_size,
                std::vector<InputDifference>& differences) {
  while (!rows.empty()) {
    const Row first = rows.front();
    std::string members;
    std::size_t count = 0;
    for (const Row& row : rows) {
      if (!alike(row, first)) continue;
      members += (members.empty() ? "" : ", ") + row.member;
      ++count;
    }
    std::erase_if(rows, [&](const Row& row) { return alike(row, first); });
    differences.push_back(difference_of(label_of(document, family, count == family_size ? "" : members), first));
  }
}

std::vector<InputDifference> differences_of(const std::string& document, const std::vector<Flat>& flats) {
  std::vector<std::string> order;
  std::map<std::string, std::vector<Row>> families;
  std::map<std::string, std::size_t> sizes;
  std::map<std::string, bool> seen;
  for (const Flat& flat : flats)
    for (const std::string& path : flat.order) {
      if (seen[path]) continue;
      seen[path] = true;
      Row row;
      const std::string family = family_of(path, row.member);
      ++sizes[family];
      for (const Flat& other : flats) {
        const auto found = other.values.find(path);
        row.leaves.push_back(found == other.values.end() ? nullptr : &found->second);
      }
      if (std::ranges::all_of(row.leaves, [&](const Leaf* leaf) { return same(leaf, row.leaves.front()); })) continue;
      if (families[family].empty()) order.push_back(family);
      families[family].push_back(row);
    }
  std::vector<InputDifference> differences;
  for (const std::string& family : order) add_family(document, family, families[family], sizes[family], differences);
  return differences;
}

Json document_of(const RunFolder& run, const std::string& file) {
  const std::filesystem::path path = run.path / "inputs" / file;
  return std::filesystem::exists(path) ? Json::parse(read_whole(path)) : Json::object();
}

}  // namespace

std::vector<InputDifference> input_differences(const std::vector<RunFolder>& runs) {
  std::vector<InputDifference> all;
  for (const std::string document : {"scenario", "vehicle", "bushing", "bushing_left", "bushing_right"}) {
    std::vector<Flat> flats;
    InputDifference whole{document + " file", "", std::vector<std::optional<double>>(runs.size()), {}};
    for (const RunFolder& run : runs) {
      Json json = document_of(run, document + ".json");
      if (document == "scenario") expand_bushing_scale(json);
      flatten(json, "", "", flats.emplace_back());
      whole.texts.push_back(json.value("name", std::string("–")));
    }
    std::vector<InputDifference> differences = differences_of(document, flats);
    if (differences.size() > k_many) {
      whole.label += fmt::format(" ({} values differ)", differences.size());
      differences = {whole};
    }
    all.insert(all.end(), differences.begin(), differences.end());
  }
  return all;
}

}  // namespace grouser
