#pragma once
#include <array>
#include <compare>
#include <optional>
#include <string>
#include <string_view>

/// Units of measurement as they stand in keys and columns (`pitch_mm`, `slope_kN_per_mm`, `lvdt_a_V`).
namespace grouser {

/// Exponents of the base quantities. Angle and voltage are bases of their own: N m and N m/rad, or V and 1, must not be
/// taken for one another.
struct Dimension {
  int length = 0, mass = 0, time = 0, angle = 0, voltage = 0, temperature = 0;
  friend constexpr auto operator<=>(const Dimension&, const Dimension&) = default;
};
[[nodiscard]] constexpr Dimension operator*(const Dimension& a, const Dimension& b) {
  return {a.length + b.length, a.mass + b.mass,       a.time + b.time,
          a.angle + b.angle,   a.voltage + b.voltage, a.temperature + b.temperature};
}
[[nodiscard]] constexpr Dimension operator/(const Dimension& a, const Dimension& b) {
  return {a.length - b.length, a.mass - b.mass,       a.time - b.time,
          a.angle - b.angle,   a.voltage - b.voltage, a.temperature - b.temperature};
}

namespace dimension {
inline constexpr Dimension none{};
inline constexpr Dimension length{.length = 1};
inline constexpr Dimension mass{.mass = 1};
inline constexpr Dimension time{.time = 1};
inline constexpr Dimension angle{.angle = 1};
inline constexpr Dimension voltage{.voltage = 1};
inline constexpr Dimension temperature{.temperature = 1};
inline constexpr Dimension area = length * length;
inline constexpr Dimension volume = area * length;
inline constexpr Dimension speed = length / time;
inline constexpr Dimension angular_speed = angle / time;
inline constexpr Dimension acceleration = speed / time;
inline constexpr Dimension frequency = none / time;
inline constexpr Dimension force = mass * acceleration;
inline constexpr Dimension torque = force * length;  // and energy
inline constexpr Dimension power = torque / time;
inline constexpr Dimension pressure = force / area;  // and the stiffness of a disc foundation
inline constexpr Dimension density = mass / volume;
inline constexpr Dimension inertia = mass * area;
inline constexpr Dimension stiffness = force / length;
inline constexpr Dimension angular_stiffness = torque / angle;
inline constexpr Dimension damping = force / speed;
inline constexpr Dimension angular_damping = torque / angular_speed;
inline constexpr Dimension compliance = length / force;
inline constexpr Dimension angular_compliance = angle / torque;
inline constexpr Dimension area_per_pressure = area / pressure;
inline constexpr Dimension inverse_area = none / area;
inline constexpr Dimension inverse_angle_squared = none / (angle * angle);
inline constexpr Dimension inverse_temperature = none / temperature;
}  // namespace dimension

/// One unit: SI value = (value + offset) * numerator / denominator. Two factors, so that mm -> m divides by 1000
/// exactly.
struct Unit {
  Dimension dimension;
  double numerator = 1.0, denominator = 1.0, offset = 0.0;

  [[nodiscard]] double to_si(double value) const { return (value + offset) * numerator / denominator; }
  [[nodiscard]] double from_si(double value) const { return value * denominator / numerator - offset; }
};

/// The unit that a suffix spells: products by `_`, powers by a digit, quotient by `_per_` ("kg_m2", "N_m_s_per_rad",
/// "per_mm2"). Empty when a part of it is unknown.
[[nodiscard]] std::optional<Unit> parse_unit(std::string_view suffix);

/// Unit whose spelling is known to be right; std::logic_error otherwise.
[[nodiscard]] Unit unit(std::string_view suffix);

/// Name for messages: "length", "stiffness", else its base exponents.
[[nodiscard]] std::string name_of(const Dimension& dimension);
/// A usual unit of the dimension, for messages ("mm"); empty when none is listed.
[[nodiscard]] std::string usual_unit(const Dimension& dimension);

/// `name_unit` taken apart at the first place where the rest is a unit; empty when there is none.
struct NamedUnit {
  std::string name;
  std::string suffix;
  Unit unit;
};
[[nodiscard]] std::optional<NamedUnit> split_name_and_unit(std::string_view key);

}  // namespace grouser
