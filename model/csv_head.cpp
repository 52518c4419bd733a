#include "model/csv_head.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "model/csv_fields.h"
#include "model/units.h"

namespace grouser {
namespace {

char divider_of(std::string_view header) {
  for (const char divider : {';', '\t', ','}) {
    if (header.find(divider) != std::string_view::npos) return divider;
  }
  return ' ';
}

std::string with_replaced(std::string text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

/// Suffix of a name for a unit as people write it ("N/mm" -> "N_per_mm", "°C" -> "degC"); empty when it is unknown.
std::string unit_suffix(std::string_view written) {
  // Degree and micro signs also in Latin-1, as older loggers write them.
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 18> spellings{{
      {"\xC2\xB0"
       "C",
       "degC"},
      {"\xC2\xB0"
       "F",
       "degF"},
      {"\xC2\xB0", "deg"},
      {"\xB0"
       "C",
       "degC"},
      {"\xB0", "deg"},
      {"\xC2\xB5", "u"},
      {"\xCE\xBC", "u"},
      {"\xB5", "u"},
      {"^", ""},
      {"\xC2\xB2", "2"},
      {"\xB2", "2"},
      {"\xC2\xB3", "3"},
      {"/", "_per_"},
      {"\xC2\xB7", "_"},
      {"*", "_"},
      {" ", "_"},
      {"Nm", "N_m"},
      {"sec", "s"},
  }};
  std::string suffix(trimmed(written));
  if (parse_unit(suffix)) return suffix;
  for (const auto& [from, to] : spellings) suffix = with_replaced(suffix, from, to);
  return parse_unit(suffix) ? suffix : std::string();
}

/// What stands between a pair of brackets that is the whole text.
std::optional<std::string_view> in_brackets(std::string_view text) {
  const bool closed =
      text.size() >= 2 && ((text.front() == '[' && text.back() == ']') || (text.front() == '(' && text.back() == ')'));
  return closed ? std::optional(text.substr(1, text.size() - 2)) : std::nullopt;
}

/// "Force [kN]" -> "Force_kN"; other names stay as they are.
std::string with_unit_in_name(const std::string& name) {
  const std::size_t bracket = name.find_last_of("[(");
  if (bracket == std::string::npos || bracket == 0) return name;
  const auto unit = in_brackets(std::string_view(name).substr(bracket));
  const std::string suffix = unit ? unit_suffix(*unit) : std::string();
  if (suffix.empty()) return name;
  return std::string(trimmed(std::string_view(name).substr(0, bracket))) + "_" + suffix;
}

std::vector<std::string> names_in(const std::string& header, char divider) {
  std::vector<std::string> names;
  for (const std::string& field : fields_of(header, divider)) {
    // Where blanks divide, "Force [kN]" came apart.
    if (divider == ' ' && !names.empty() && in_brackets(field)) {
      names.back() += " " + field;
    } else {
      names.push_back(field);
    }
  }
  for (std::string& name : names) name = with_unit_in_name(name);
  if (names.size() > 1 && names.back().empty()) names.pop_back();  // a divider at the end divides nothing
  return names;
}

/// What a row of units says of one column.
struct ColumnUnit {
  std::string suffix;   ///< empty: it has none that is known
  std::string unknown;  ///< as written, where nobody knows it
};

/// Units that a row gives to the columns; empty when the row is none: no field is a number, and of those that say
/// something outside brackets at least half are known units, or it stands where a row of units does.
std::vector<ColumnUnit> units_in(const std::string& row, char divider, std::size_t columns, bool in_its_place) {
  std::vector<std::string> fields = fields_of(row, divider);
  if (fields.size() == columns + 1 && fields.back().empty()) fields.pop_back();
  if (fields.size() != columns) return {};
  std::vector<ColumnUnit> units;
  std::size_t known = 0, unknown = 0;
  for (const std::string& field : fields) {
    if (number_in(field)) return {};
    const auto bracketed = in_brackets(field);
    ColumnUnit& unit = units.emplace_back(ColumnUnit{unit_suffix(bracketed.value_or(field)), {}});
    if (!unit.suffix.empty()) {
      ++known;
    } else if (!field.empty() && field != "-") {
      unit.unknown = bracketed.value_or(field);
      unknown += bracketed ? 0 : 1;
    }
  }
  return in_its_place || (known > 0 && known >= unknown) ? units : std::vector<ColumnUnit>{};
}

bool has_unit(const std::string& name) { return split_name_and_unit(name).has_value(); }

class HeadFinder {
 public:
  explicit HeadFinder(const std::vector<CsvHeadLine>& lines) : lines_(lines) {}

  [[nodiscard]] std::size_t choose() const {
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      if (numbers_fit(head_at(i))) return i;
    }
    const auto index_of = [&](auto&& wanted) {
      std::size_t i = 0;
      while (i < lines_.size() && (lines_[i].remark || !wanted(i))) ++i;
      return i;
    };
    const std::size_t with_unit = index_of([&](std::size_t i) {
      const CsvHead head = head_at(i);
      return head.names.size() > 1 && std::any_of(head.names.begin(), head.names.end(), has_unit);
    });
    return with_unit < lines_.size() ? with_unit : index_of([](std::size_t) { return true; });
  }

  /// The head, if line i names the columns; units that contradict the names are told.
  [[nodiscard]] CsvHead head_at(std::size_t i, Findings* findings = nullptr) const {
    CsvHead head;
    head.row = lines_[i].row;
    head.divider = divider_of(lines_[i].text);
    head.names = names_in(lines_[i].text, head.divider);
    head.first = i + 1;
    if (head.first == lines_.size()) return head;
    const CsvHeadLine& below = lines_[head.first];
    // Between names without any unit and numbers, so that units which nobody knows are at least told.
    const bool in_its_place = std::none_of(head.names.begin(), head.names.end(), has_unit) &&
                              numbers_at(head.first + 1, head.divider, head.names.size());
    const std::vector<ColumnUnit> units = units_in(below.text, head.divider, head.names.size(), in_its_place);
    if (units.empty()) return head;
    ++head.first;
    for (std::size_t k = 0; k < units.size(); ++k) {
      const auto split = split_name_and_unit(head.names[k]);
      const auto& [suffix, unknown] = units[k];
      if (!split && !suffix.empty()) head.names[k] += "_" + suffix;
      if (!split && !unknown.empty()) head.names[k] += " [" + unknown + "]";  // as loggers write it in one row
      if (split && !suffix.empty() && suffix != split->suffix && findings != nullptr) {
        findings->add("row " + std::to_string(below.row) + ", column " + head.names[k], "the unit of the column's name",
                      suffix);
      }
    }
    return head;
  }

 private:
  [[nodiscard]] bool numbers_at(std::size_t i, char divider, std::size_t columns) const {
    if (i >= lines_.size() || lines_[i].remark) return false;
    std::vector<std::string> fields = fields_of(lines_[i].text, divider);
    fields.resize(std::min(fields.size(), columns));
    return fields.size() == columns && std::all_of(fields.begin(), fields.end(), [](const std::string& field) {
             return number_in(field).has_value();
           });
  }

  /// Columns with a unit, and the first row below has a number in each of them.
  [[nodiscard]] bool numbers_fit(const CsvHead& head) const {
    std::size_t row = head.first;
    while (row < lines_.size() && lines_[row].remark) ++row;
    if (row == lines_.size()) return false;
    const std::vector<std::string> fields = fields_of(lines_[row].text, head.divider);
    const bool trailing = fields.size() == head.names.size() + 1 && fields.back().empty();
    if (fields.size() != head.names.size() && !trailing) return false;
    bool any = false;
    for (std::size_t k = 0; k < head.names.size(); ++k) {
      if (!has_unit(head.names[k])) continue;
      if (!number_in(fields[k])) return false;
      any = true;
    }
    return any;
  }

  const std::vector<CsvHeadLine>& lines_;
};

}  // namespace

CsvHead find_csv_head(const std::vector<CsvHeadLine>& lines, Findings& findings) {
  const HeadFinder finder(lines);
  return finder.head_at(finder.choose(), &findings);
}

}  // namespace grouser
