#include "model/csv.h"

#include <algorithm>
#include <cmath>

#include "model/csv_fields.h"

namespace grouser {
namespace {

constexpr std::size_t k_most_findings = 20;
// The names stand among the first so many lines that are not empty, and so many bytes.
constexpr std::size_t k_head_lines = 200, k_head_bytes = 1u << 20;
constexpr std::size_t k_most_columns = 10'000;
constexpr double k_largest = 1e152;  // nobody measured it

std::string row_place(std::size_t row) { return "row " + std::to_string(row); }

std::string shown_field(std::string_view field) {
  return field.empty() ? "nothing" : std::string("\"").append(field.substr(0, 40)).append("\"");
}

bool is_missing(std::string_view field) { return field.empty() || field == "NaN" || field == "nan" || field == "NAN"; }

std::string_view without_mark(std::string_view remark) {
  while (!remark.empty() && (remark.front() == '#' || remark.front() == '%' || remark.front() == '/')) {
    remark.remove_prefix(1);
  }
  return trimmed(remark);
}

/// Converts the rows below the header.
class Table {
 public:
  Table(const CsvHead& head, const std::vector<std::string>& wanted, CsvReader::Missing missing, Findings& findings)
      : head_(head), missing_(missing), findings_(findings), target_(head.names.size(), nullptr) {
    columns_.reserve(wanted.size());
    for (const std::string& name : wanted) columns_.push_back({name, {}});
    for (CsvColumn& column : columns_) {
      const auto at = std::find(head.names.begin(), head.names.end(), column.name);
      if (at != head.names.end()) target_[static_cast<std::size_t>(at - head.names.begin())] = &column.values;
    }
  }

  void reserve(std::size_t rows) {
    for (CsvColumn& column : columns_) column.values.reserve(rows);
  }

  void read_row(std::string_view line, std::size_t row) {
    ++rows_;
    CsvFields fields(line, head_.divider);
    std::size_t i = 0;
    std::string_view field;
    for (; fields.next(field); ++i) {
      if (i >= target_.size() || target_[i] == nullptr) continue;
      auto value = number_in(field);
      if (!value && missing_ == CsvReader::Missing::as_nan && is_missing(field)) value = std::nan("");
      if (!value || std::abs(*value) > k_largest)
        findings_.add(row_place(row) + ", column " + head_.names[i], value ? "a number up to 1e152" : "a number",
                      shown_field(field));
      target_[i]->push_back(value.value_or(0.0));
    }
    const bool trailing = i == head_.names.size() + 1 && field.empty();  // a divider at the end divides nothing
    if (i != head_.names.size() && !trailing) {
      findings_.add(row_place(row), std::to_string(head_.names.size()) + " fields, as in the header",
                    std::to_string(i));
    }
  }

  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::vector<CsvColumn> take() { return std::move(columns_); }

 private:
  const CsvHead& head_;
  CsvReader::Missing missing_;
  Findings& findings_;
  std::vector<CsvColumn> columns_;
  std::vector<std::vector<double>*> target_;
  std::size_t rows_ = 0;
};

}  // namespace

CsvReader::CsvReader(std::istream& in, Findings& findings) : findings_(findings), lines_(in) {
  if (!lines_.other_content().empty()) {
    findings_.add("", "text in UTF-8 or ASCII", lines_.other_content());
    return;
  }
  bool any = false;
  const auto room = [&] { return first_lines_.size() < k_head_lines && lines_.consumed() < k_head_bytes; };
  for (std::string_view line; room() && lines_.next(line);) {
    const std::string_view content = trimmed(line);
    if (content.empty()) continue;
    const bool remark = is_remark(content);
    any = any || !remark;
    // A trailing divider is part of the row; only blanks that divide nothing are cut.
    first_lines_.push_back({std::string(remark ? without_mark(content) : line), lines_.number(), remark});
  }
  if (lines_.too_long()) {
    report_long_line();
  } else if (!any) {
    findings_.add("", "a header line that names the columns",
                  first_lines_.empty() ? "an empty file" : "only lines that are remarks");
  } else {
    head_ = find_csv_head(first_lines_, findings_);
    check_names();
  }
}

void CsvReader::report_long_line() {
  findings_.add(row_place(lines_.number()), "lines of at most " + std::to_string(CsvLines::k_piece >> 20) + " MB",
                "a longer one");
}

std::string CsvReader::place_of_names() const { return row_place(head_.row); }

void CsvReader::check_names() {
  const std::vector<std::string>& names = head_.names;
  if (names.size() > k_most_columns) {
    findings_.add(place_of_names(), "at most " + std::to_string(k_most_columns) + " columns",
                  std::to_string(names.size()));
    return;
  }
  if (number_in(names.front())) {
    findings_.add(place_of_names(), "names of columns, with units", "numbers");
    return;
  }
  for (auto name = names.begin(); name != names.end(); ++name) {
    if (name->empty()) {
      findings_.add(place_of_names() + ", column " + std::to_string(name - names.begin() + 1), "a column name",
                    "nothing");
    } else if (std::find(names.begin(), name, *name) != name) {
      findings_.add(place_of_names(), "each column name once", *name + " twice");
    }
  }
}

std::vector<CsvColumn> CsvReader::read(const std::vector<std::string>& wanted, Missing missing) {
  if (head_.names.empty()) return {};
  Table table(head_, wanted, missing, findings_);
  const std::size_t before = findings_.size();
  const auto read_row = [&](std::string_view line, std::size_t row) {
    table.read_row(line, row);
    const bool too_many = findings_.size() - before >= k_most_findings;
    if (too_many) findings_.add(row_place(row), "rows of numbers", "too many faults; the rest was not read");
    return !too_many;
  };
  bool go_on = true;
  for (std::size_t i = head_.first; i < first_lines_.size() && go_on; ++i) {
    if (!first_lines_[i].remark) go_on = read_row(first_lines_[i].text, first_lines_[i].row);
  }
  if (table.rows() > 0) {
    // Room for all rows at once, a little more than the first ones foretell: vectors that double would need half as
    // much memory again.
    const double foretold = 1.1 * static_cast<double>(table.rows()) * static_cast<double>(lines_.total()) /
                            static_cast<double>(lines_.consumed());
    constexpr double k_most_rows = 1 << 24;  // a file with holes claims any length
    table.reserve(static_cast<std::size_t>(std::min(foretold, k_most_rows)));
  }
  for (std::string_view line; go_on && lines_.next(line);) {
    const std::string_view content = trimmed(line);
    if (!content.empty() && !is_remark(content)) go_on = read_row(line, lines_.number());
  }
  if (lines_.too_long()) report_long_line();
  if (table.rows() == 0) findings_.add("", "rows of numbers below the header", "none");
  return table.take();
}

}  // namespace grouser
