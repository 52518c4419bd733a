#include "model/csv.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>

namespace grouser {
namespace {

constexpr std::size_t k_most_findings = 20;

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

/// Lines that carry something, with their number.
class Lines {
 public:
  explicit Lines(std::string_view bytes) : rest_(bytes) {
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
    if (rest_.substr(0, 3) == byte_order_mark) rest_.remove_prefix(3);
  }

  bool next() {
    while (!rest_.empty()) {
      const auto* newline = static_cast<const char*>(std::memchr(rest_.data(), '\n', rest_.size()));
      const std::size_t length = newline == nullptr ? rest_.size() : static_cast<std::size_t>(newline - rest_.data());
      line_ = rest_.substr(0, length);
      rest_.remove_prefix(std::min(length + 1, rest_.size()));
      ++number_;
      // A trailing divider is part of the row; only blanks that divide nothing are cut.
      const std::string_view content = trimmed(line_);
      if (!content.empty() && content.front() != '#') return true;
    }
    return false;
  }
  [[nodiscard]] std::string_view line() const { return line_; }
  [[nodiscard]] std::size_t number() const { return number_; }

 private:
  std::string_view rest_, line_;
  std::size_t number_ = 0;
};

char divider_of(std::string_view header) {
  for (const char divider : {';', '\t', ','}) {
    if (header.find(divider) != std::string_view::npos) return divider;
  }
  return ' ';
}

/// Takes fields off a line one by one.
class Fields {
 public:
  Fields(std::string_view line, char divider) : rest_(divider == ' ' ? trimmed(line) : line), divider_(divider) {}

  bool next(std::string_view& field) {
    if (done_) return false;
    std::size_t end = 0;
    if (divider_ == ' ') {
      while (end < rest_.size() && !is_blank(rest_[end])) ++end;
    } else {
      const auto* found = static_cast<const char*>(std::memchr(rest_.data(), divider_, rest_.size()));
      end = found == nullptr ? rest_.size() : static_cast<std::size_t>(found - rest_.data());
    }
    field = trimmed(rest_.substr(0, end));
    done_ = end == rest_.size();
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    if (divider_ == ' ') rest_ = trimmed(rest_);
    return true;
  }

 private:
  std::string_view rest_;
  char divider_;
  bool done_ = false;
};

std::vector<std::string> names_in(std::string_view header) {
  std::vector<std::string> names;
  Fields fields(header, divider_of(header));
  for (std::string_view field; fields.next(field);) {
    if (field.size() >= 2 && field.front() == '"' && field.back() == '"') field = field.substr(1, field.size() - 2);
    names.emplace_back(field);
  }
  return names;
}

std::optional<double> number_in(std::string_view field, bool decimal_comma) {
  std::string with_point;
  if (decimal_comma && field.find(',') != std::string_view::npos) {
    if (field.find('.') != std::string_view::npos) return std::nullopt;  // "1.234,5": which of the two is it?
    with_point = field;
    std::replace(with_point.begin(), with_point.end(), ',', '.');
    field = with_point;
  }
  if (!field.empty() && field.front() == '+') field.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc() || end != field.data() + field.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::string row_place(std::size_t row) { return "row " + std::to_string(row); }

std::string shown_field(std::string_view field) {
  return field.empty() ? "nothing" : std::string("\"").append(field.substr(0, 40)).append("\"");
}

bool header_is_usable(const std::vector<std::string>& names, std::size_t row, Findings& findings) {
  const std::size_t before = findings.size();
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].empty()) {
      findings.add(row_place(row) + ", column " + std::to_string(i + 1), "a column name", "nothing");
    } else if (std::find(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(i), names[i]) !=
               names.begin() + static_cast<std::ptrdiff_t>(i)) {
      findings.add(row_place(row), "each column name once", names[i] + " twice");
    }
  }
  if (number_in(names.front(), false)) findings.add(row_place(row), "names of columns, with units", "numbers");
  return findings.size() == before;
}

/// Converts the rows below the header.
class Table {
 public:
  Table(const std::vector<std::string>& names, const std::vector<std::string>& wanted, char divider, Findings& findings)
      : names_(names), divider_(divider), findings_(findings), target_(names.size(), nullptr) {
    columns_.reserve(wanted.size());
    for (const std::string& name : wanted) columns_.push_back({name, {}});
    for (CsvColumn& column : columns_) {
      const auto at = std::find(names.begin(), names.end(), column.name);
      if (at != names.end()) target_[static_cast<std::size_t>(at - names.begin())] = &column.values;
    }
  }

  void read_row(std::string_view line, std::size_t row) {
    Fields fields(line, divider_);
    std::size_t i = 0;
    for (std::string_view field; fields.next(field); ++i) {
      if (i >= target_.size() || target_[i] == nullptr) continue;
      const auto value = number_in(field, divider_ != ',');
      if (!value) findings_.add(row_place(row) + ", column " + names_[i], "a number", shown_field(field));
      target_[i]->push_back(value.value_or(0.0));
    }
    if (i != names_.size()) {
      findings_.add(row_place(row), std::to_string(names_.size()) + " fields, as in the header", std::to_string(i));
    }
  }

  [[nodiscard]] std::vector<CsvColumn> take() { return std::move(columns_); }

 private:
  const std::vector<std::string>& names_;
  char divider_;
  Findings& findings_;
  std::vector<CsvColumn> columns_;
  std::vector<std::vector<double>*> target_;
};

}  // namespace

std::vector<std::string> csv_header(std::string_view bytes) {
  Lines lines(bytes);
  return lines.next() ? names_in(lines.line()) : std::vector<std::string>{};
}

std::vector<CsvColumn> read_csv(std::string_view bytes, const std::vector<std::string>& wanted, Findings& findings) {
  Lines lines(bytes);
  if (!lines.next()) {
    findings.add("", "a header line that names the columns", "an empty file");
    return {};
  }
  const std::vector<std::string> names = names_in(lines.line());
  if (!header_is_usable(names, lines.number(), findings)) return {};
  Table table(names, wanted, divider_of(lines.line()), findings);
  const std::size_t before = findings.size();
  std::size_t rows = 0;
  for (; lines.next(); ++rows) {
    table.read_row(lines.line(), lines.number());
    if (findings.size() - before >= k_most_findings) {
      findings.add(row_place(lines.number()), "rows of numbers", "too many faults; the rest was not read");
      break;
    }
  }
  if (rows == 0) findings.add("", "rows of numbers below the header", "none");
  return table.take();
}

}  // namespace grouser
