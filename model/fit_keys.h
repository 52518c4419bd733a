#pragma once
#include <string>
#include <vector>

#include "model/fit.h"
#include "model/json_reader.h"

/// What the parts of fit.json have in common.
namespace grouser {

/// fit.json is written in SI; the keys of an axis differ by its kind.
struct FitKeys {
  std::string displacement, force, stiffness, damping;
};
[[nodiscard]] const FitKeys& fit_keys_of(Axis axis);

/// What could not be computed stands as null, and is read as NaN.
[[nodiscard]] double number_or_null(ObjectReader& reader, const std::string& key);
[[nodiscard]] std::vector<double> numbers(const Json& array);
[[nodiscard]] std::vector<double> numbers_or_nulls(ObjectReader& reader, const std::string& key);

}  // namespace grouser
