#include "reports/number_text.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <string_view>

namespace grouser {
namespace {

constexpr std::string_view k_minus = "\u2212";
constexpr std::string_view k_thin_space = "\u202f";  // narrow, no break

std::string superscript(int exponent) {
  static constexpr std::array<std::string_view, 10> k_digits{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = exponent < 0 ? "⁻" : "";
  for (const char c : std::to_string(std::abs(exponent))) text += k_digits[static_cast<std::size_t>(c - '0')];
  return text;
}

/// Thin spaces between groups of three from five digits on, as ISO 80000-1 recommends.
std::string grouped(std::string_view digits) {
  const std::size_t whole = std::min(digits.find('.'), digits.size());
  if (whole < 5) return std::string(digits);
  std::string text;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && i < whole && (whole - i) % 3 == 0) text += k_thin_space;
    text += digits[i];
  }
  return text;
}

struct Scaled {
  double factor;
  const char* unit;
};

/// Units that take prefixes, from large to small; the first whose scaled value reaches 1 is taken, else the last.
struct Ladder {
  std::string_view unit;
  std::array<Scaled, 4> steps;
};
constexpr std::array<Ladder, 9> k_ladders{{
    {"N", {{{1e-6, "MN"}, {1e-3, "kN"}, {1.0, "N"}, {1.0, "N"}}}},
    {"N m", {{{1e-6, "MN m"}, {1e-3, "kN m"}, {1.0, "N m"}, {1.0, "N m"}}}},
    {"J", {{{1e-6, "MJ"}, {1e-3, "kJ"}, {1.0, "J"}, {1e3, "mJ"}}}},
    {"W", {{{1e-6, "MW"}, {1e-3, "kW"}, {1.0, "W"}, {1.0, "W"}}}},
    {"m", {{{1.0, "m"}, {1e3, "mm"}, {1e6, "µm"}, {1e6, "µm"}}}},
    {"m/s", {{{1.0, "m/s"}, {1e3, "mm/s"}, {1e6, "µm/s"}, {1e6, "µm/s"}}}},
    {"s", {{{1.0, "s"}, {1e3, "ms"}, {1e6, "µs"}, {1e6, "µs"}}}},
    {"N/m", {{{1e-6, "kN/mm"}, {1e-3, "kN/m"}, {1.0, "N/m"}, {1.0, "N/m"}}}},
    {"N m/rad", {{{1e-6, "MN m/rad"}, {1e-3, "kN m/rad"}, {1.0, "N m/rad"}, {1.0, "N m/rad"}}}},
}};

/// Of a quantity with a unit, in that unit: what is smaller is round-off of a computation, not a measure.
constexpr double k_round_off = 1e-9;

}  // namespace

std::string number_text(double value, int digits) {
  if (!std::isfinite(value)) return "–";
  if (value == 0.0) return "0";
  const double magnitude = std::abs(value);
  const std::string sign(value < 0.0 ? k_minus : "");
  if (magnitude < 1e-3 || magnitude >= 1e7) {
    const std::string scientific = fmt::format("{:.{}e}", magnitude, std::max(digits - 2, 1));
    const std::size_t e = scientific.find('e');
    return sign + scientific.substr(0, e) + " × 10" + superscript(std::atoi(scientific.c_str() + e + 1));
  }
  // The exponent after rounding: 0.99997 to four digits is 1.000.
  const std::string rounded = fmt::format("{:.{}e}", magnitude, digits - 1);
  const int decimals = std::max(0, digits - 1 - std::atoi(rounded.c_str() + rounded.find('e') + 1));
  std::string text = fmt::format("{:.{}f}", magnitude, decimals);
  // Zeros of a rounded number are digits (13.98 is 14.0 to three); those of an exact one are padding.
  if (text.find('.') != std::string::npos && std::strtod(text.c_str(), nullptr) == magnitude) {
    while (text.back() == '0') text.pop_back();
    if (text.back() == '.') text.pop_back();
  }
  return sign + grouped(text);
}

std::string count_text(long value) {
  return (value < 0 ? std::string(k_minus) : "") + grouped(std::to_string(std::labs(value)));
}

std::string quantity_text(double value, const std::string& unit, int digits) {
  if (unit.empty() || unit == "1" || unit == "-") return number_text(value, digits);
  if (unit == "%") return number_text(value, digits) + " %";
  for (const Ladder& ladder : k_ladders) {
    if (ladder.unit != unit || !std::isfinite(value)) continue;
    if (std::abs(value) < k_round_off) return "0 " + unit;
    for (const Scaled& step : ladder.steps)
      if (std::abs(value) * step.factor >= 0.9995 || &step == &ladder.steps.back())
        return number_text(value * step.factor, digits) + " " + step.unit;
  }
  return number_text(value, digits) + " " + unit;
}

std::string percent_text(double fraction, int digits) { return number_text(100.0 * fraction, digits) + " %"; }

std::string fixed_percent_text(double fraction, int decimals) {
  if (!std::isfinite(fraction)) return "–";
  return fmt::format("{}{:.{}f} %", fraction < 0.0 ? k_minus : "", 100.0 * std::abs(fraction), decimals);
}

std::string signed_percent_text(double fraction, int decimals) {
  const std::string size = fixed_percent_text(std::abs(fraction), decimals);
  const bool zero = size.find_first_of("123456789") == std::string::npos;
  return std::string(zero ? "" : fraction > 0.0 ? "+" : k_minus) + size;
}

}  // namespace grouser
