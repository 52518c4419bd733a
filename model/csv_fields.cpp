#include "model/csv_fields.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace grouser {

std::vector<std::string> fields_of(std::string_view line, char divider) {
  std::vector<std::string> fields;
  CsvFields rest(line, divider);
  for (std::string_view field; rest.next(field);) fields.emplace_back(field);
  return fields;
}

std::optional<double> number_in(std::string_view field) {
  std::string with_point;
  if (field.find(',') != std::string_view::npos) {
    if (field.find('.') != std::string_view::npos) return std::nullopt;
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

}  // namespace grouser
