#pragma once
#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string>

#include "model/bushing.h"

namespace grouser {

/// Rounded for a text; a small negative number is 0 and not -0.
[[nodiscard]] inline double whole(double value) { return std::round(value) + 0.0; }

/// Quantities of an axis as people read them: mm, N or kN and N/m along it, degrees, N m and N m/rad about it.
struct Shown {
  bool turns;
  explicit Shown(Axis axis) : turns(is_rotation(axis)) {}

  [[nodiscard]] std::string displacement(double value) const {
    return turns ? fmt::format("{:.4g} deg", value * 180.0 / std::numbers::pi) : fmt::format("{:.4g} mm", 1e3 * value);
  }
  [[nodiscard]] std::string force(double value) const {
    if (turns) return fmt::format("{:.4g} N m", value);
    return std::abs(value) < 1e3 ? fmt::format("{:.4g} N", value) : fmt::format("{:.4g} kN", 1e-3 * value);
  }
  [[nodiscard]] std::string stiffness(double value) const {
    return fmt::format("{:.4g} {}", value, turns ? "N m/rad" : "N/m");
  }
};

}  // namespace grouser
