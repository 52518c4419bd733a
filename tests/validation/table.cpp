#include "tests/validation/table.h"

#include <fmt/format.h>

#include <cmath>
#include <sstream>
#include <stdexcept>

namespace grouser::validation {
namespace {

/// A number with `digits` significant digits; exponents without leading zeros.
std::string number(double value, int digits) {
  std::string text = fmt::format("{:.{}g}", value, digits);
  const std::size_t e = text.find('e');
  if (e != std::string::npos && text[e + 2] == '0') text.erase(e + 2, 1);
  return text;
}

std::string with_unit(const std::string& number, const std::string& unit) {
  return unit.empty() ? number : number + " " + unit;
}

std::string error_text(double value, const Row& row) {
  if (row.limit.scale == 0.0) return with_unit(number(value, 2), row.unit);
  return std::abs(value) < 1e-5 ? number(value, 2) + " rel." : number(100.0 * value, 2) + " %";
}

std::string cell(const std::string& text) {
  std::string escaped;
  for (const char c : text) escaped += c == '|' ? std::string("\\|") : std::string(1, c);
  return escaped;
}

std::string limit_text(const Row& row) {
  return cell(fmt::format("{} ({})", error_text(row.limit.error, row), row.limit.because));
}

std::string line_of(const Row& row) {
  return fmt::format("| {} | {} | {} | {}{} | {} | {} |\n", cell(row.quantity),
                     with_unit(number(row.reference, 8), row.unit), with_unit(number(row.measured, 8), row.unit),
                     error_text(row.error(), row), row.passes() ? "" : " **out**", limit_text(row), cell(row.source));
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  for (std::size_t start = 2; start < line.size();) {
    const std::size_t end = std::min(line.find(" | ", start), line.size() - 2);
    cells.push_back(line.substr(start, end - start));
    start = end + 3;
  }
  return cells;
}

}  // namespace

Limit within(double error, std::string because) { return {error, 0.0, std::move(because)}; }

Limit fraction(double fraction, double of, std::string because) { return {fraction, std::abs(of), std::move(because)}; }

double Row::error() const { return std::abs(measured - reference) / (limit.scale > 0.0 ? limit.scale : 1.0); }

bool Row::passes() const { return error() <= limit.error; }

Worst worst_of(const Eigen::VectorXd& measured, const Eigen::VectorXd& reference) {
  if (measured.size() != reference.size()) throw std::logic_error("vectors of different length are compared");
  if (!measured.allFinite()) return {reference[0], std::nan("")};
  Eigen::Index at = 0;
  (measured - reference).cwiseAbs().maxCoeff(&at);
  return {reference[at], measured[at]};
}

Worst worse(const Worst& a, const Worst& b) {
  const double of_a = std::abs(a.measured - a.reference), of_b = std::abs(b.measured - b.reference);
  return std::isnan(of_a) || of_a > of_b ? a : b;  // a NaN on either side is what is left
}

void Chapter::section(std::string title, std::string scene) {
  sections_.push_back({std::move(title), std::move(scene), {}});
}

void Chapter::add(Row row) {
  if (sections_.empty()) throw std::logic_error(title_ + ": a row before the first section");
  sections_.back().rows.push_back(std::move(row));
}

int Chapter::num_rows() const {
  std::size_t sum = 0;
  for (const Section& section : sections_) sum += section.rows.size();
  return static_cast<int>(sum);
}

std::vector<std::string> Chapter::failures() const {
  std::vector<std::string> lines;
  for (const Section& section : sections_) {
    for (const Row& row : section.rows) {
      if (row.passes()) continue;
      lines.push_back(fmt::format("{}: {}: expected {:.10g}, found {:.10g} {}, error {}, limit {}", section.title,
                                  row.quantity, row.reference, row.measured, row.unit, error_text(row.error(), row),
                                  limit_text(row)));
    }
  }
  return lines;
}

std::string Chapter::text() const {
  const std::size_t num_out = failures().size();
  std::string text = fmt::format("## {}\n\n", title_);
  text += num_out == 0 ? fmt::format("{} rows, all within their limits.\n", num_rows())
                       : fmt::format("**{} of {} rows are out of their limits.**\n", num_out, num_rows());
  for (const Section& section : sections_) {
    text += fmt::format("\n### {}\n\n{}\n\n", section.title, section.scene);
    text += "| Quantity | Reference | Measured | Error | Limit | Source of the reference |\n";
    text += "| :-- | --: | --: | --: | :-- | :-- |\n";
    for (const Row& row : section.rows) text += line_of(row);
  }
  return text;
}

std::string chapter_in(const std::string& document, const std::string& title) {
  const std::string head = fmt::format("\n## {}\n", title);
  const std::size_t start = document.find(head);
  if (start == std::string::npos) return {};
  const std::size_t next = document.find("\n## ", start + head.size());
  return document.substr(start + 1, next == std::string::npos ? next : next - start - 1);
}

std::vector<std::string> rows_in(const std::string& document, const std::string& title) {
  std::vector<std::string> rows;
  std::istringstream lines(chapter_in(document, title));
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("| ") || line.starts_with("| Quantity |") || line.starts_with("| :--")) continue;
    const std::vector<std::string> cells = cells_of(line);
    if (cells.size() != 6) throw std::runtime_error("not a row of six cells: " + line);
    rows.push_back(cells[0] + "; limit " + cells[4]);
  }
  return rows;
}

}  // namespace grouser::validation
