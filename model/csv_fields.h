#pragma once
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// A line of a table taken apart.
namespace grouser {

[[nodiscard]] inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

[[nodiscard]] inline std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

/// A line for people: it begins with `#`, `%` or `//`.
[[nodiscard]] inline bool is_remark(std::string_view content) {
  return !content.empty() && (content[0] == '#' || content[0] == '%' || content.substr(0, 2) == "//");
}

/// Takes fields off a line one by one; what stands in double quotes is one field.
class CsvFields {
 public:
  /// A blank as divider stands for any number of blanks.
  CsvFields(std::string_view line, char divider)
      : rest_(divider == ' ' ? trimmed(line) : line), divider_(divider), done_(divider == ' ' && rest_.empty()) {}

  bool next(std::string_view& field) {
    if (done_) return false;
    const std::size_t end = end_of_field();
    field = trimmed(rest_.substr(0, end));
    if (field.size() >= 2 && field.front() == '"' && field.back() == '"') field = field.substr(1, field.size() - 2);
    done_ = end == rest_.size();
    rest_.remove_prefix(end + (done_ ? 0 : 1));
    if (divider_ == ' ') rest_ = trimmed(rest_);
    return true;
  }

 private:
  [[nodiscard]] std::size_t end_of_field() const {
    std::size_t from = 0;
    while (from < rest_.size() && is_blank(rest_[from]) && rest_[from] != divider_) ++from;
    if (from < rest_.size() && rest_[from] == '"') {
      const std::size_t closing = rest_.find('"', from + 1);
      if (closing != std::string_view::npos) from = closing;
    }
    if (divider_ == ' ') {
      while (from < rest_.size() && !is_blank(rest_[from])) ++from;
      return from;
    }
    const auto* found = static_cast<const char*>(std::memchr(rest_.data() + from, divider_, rest_.size() - from));
    return found == nullptr ? rest_.size() : static_cast<std::size_t>(found - rest_.data());
  }

  std::string_view rest_;
  char divider_;
  bool done_;
};

/// All fields of a line.
[[nodiscard]] std::vector<std::string> fields_of(std::string_view line, char divider);

/// The finite number that a field is, with a decimal point or a decimal comma; empty when it is none, or when it has
/// both ("1.234,5": which of the two is it?).
[[nodiscard]] std::optional<double> number_in(std::string_view field);

}  // namespace grouser
