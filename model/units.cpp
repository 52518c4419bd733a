#include "model/units.h"

#include <algorithm>
#include <stdexcept>

#include "model/geometry.h"

namespace grouser {
namespace {

struct Atom {
  std::string_view name;
  Unit unit;
};

constexpr Unit scaled(const Dimension& dimension, double numerator, double denominator = 1.0) {
  return {dimension, numerator, denominator, 0.0};
}

namespace d = dimension;
constexpr std::array k_atoms{
    Atom{"m", scaled(d::length, 1.0)},
    Atom{"mm", scaled(d::length, 1.0, 1e3)},
    Atom{"um", scaled(d::length, 1.0, 1e6)},
    Atom{"cm", scaled(d::length, 1.0, 1e2)},
    Atom{"km", scaled(d::length, 1e3)},
    Atom{"in", scaled(d::length, 254.0, 1e4)},
    Atom{"ft", scaled(d::length, 3048.0, 1e4)},
    Atom{"rad", scaled(d::angle, 1.0)},
    Atom{"mrad", scaled(d::angle, 1.0, 1e3)},
    Atom{"deg", scaled(d::angle, k_pi, 180.0)},
    Atom{"N", scaled(d::force, 1.0)},
    Atom{"daN", scaled(d::force, 10.0)},
    Atom{"kN", scaled(d::force, 1e3)},
    Atom{"MN", scaled(d::force, 1e6)},
    Atom{"kgf", scaled(d::force, k_standard_gravity)},
    Atom{"tonf", scaled(d::force, 1e3 * k_standard_gravity)},
    Atom{"lbf", scaled(d::force, 4.4482216152605)},
    Atom{"kg", scaled(d::mass, 1.0)},
    Atom{"g", scaled(d::mass, 1.0, 1e3)},
    Atom{"t", scaled(d::mass, 1e3)},
    Atom{"lb", scaled(d::mass, 0.45359237)},
    Atom{"s", scaled(d::time, 1.0)},
    Atom{"ms", scaled(d::time, 1.0, 1e3)},
    Atom{"us", scaled(d::time, 1.0, 1e6)},
    Atom{"min", scaled(d::time, 60.0)},
    Atom{"h", scaled(d::time, 3600.0)},
    Atom{"Hz", scaled(d::frequency, 1.0)},
    Atom{"kHz", scaled(d::frequency, 1e3)},
    Atom{"rpm", scaled(d::angular_speed, k_pi, 30.0)},
    Atom{"Pa", scaled(d::pressure, 1.0)},
    Atom{"kPa", scaled(d::pressure, 1e3)},
    Atom{"MPa", scaled(d::pressure, 1e6)},
    Atom{"GPa", scaled(d::pressure, 1e9)},
    Atom{"bar", scaled(d::pressure, 1e5)},
    Atom{"l", scaled(d::volume, 1.0, 1e3)},
    Atom{"V", scaled(d::voltage, 1.0)},
    Atom{"mV", scaled(d::voltage, 1.0, 1e3)},
    Atom{"J", scaled(d::torque, 1.0)},
    Atom{"kJ", scaled(d::torque, 1e3)},
    Atom{"MJ", scaled(d::torque, 1e6)},
    Atom{"W", scaled(d::power, 1.0)},
    Atom{"kW", scaled(d::power, 1e3)},
    Atom{"K", scaled(d::temperature, 1.0)},
    Atom{"degC", Unit{d::temperature, 1.0, 1.0, 273.15}},
    Atom{"degF", Unit{d::temperature, 5.0, 9.0, 459.67}},
};

struct Named {
  Dimension dimension;
  std::string_view name, usual;
};
constexpr std::array k_names{
    Named{d::length, "length", "mm"},
    Named{d::mass, "mass", "kg"},
    Named{d::time, "time", "s"},
    Named{d::angle, "angle", "deg"},
    Named{d::voltage, "voltage", "V"},
    Named{d::temperature, "temperature", "degC"},
    Named{d::area, "area", "mm2"},
    Named{d::volume, "volume", "cm3"},
    Named{d::speed, "speed", "m_per_s"},
    Named{d::angular_speed, "angular speed", "rad_per_s"},
    Named{d::acceleration, "acceleration", "m_per_s2"},
    Named{d::frequency, "frequency", "Hz"},
    Named{d::force, "force", "kN"},
    Named{d::torque, "torque", "N_m"},
    Named{d::power, "power", "kW"},
    Named{d::pressure, "pressure", "MPa"},
    Named{d::density, "density", "kg_per_m3"},
    Named{d::inertia, "moment of inertia", "kg_m2"},
    Named{d::stiffness, "stiffness", "kN_per_mm"},
    Named{d::angular_stiffness, "angular stiffness", "N_m_per_rad"},
    Named{d::damping, "damping", "N_s_per_m"},
    Named{d::angular_damping, "angular damping", "N_m_s_per_rad"},
    Named{d::compliance, "compliance", "m_per_N"},
    Named{d::length / d::voltage, "length per volt", "mm_per_V"},
    Named{d::angle / d::voltage, "angle per volt", "deg_per_V"},
    Named{d::force / d::voltage, "force per volt", "kN_per_V"},
    Named{d::torque / d::voltage, "torque per volt", "N_m_per_V"},
    Named{d::area_per_pressure, "area per pressure", "m2_per_Pa"},
    Named{d::angular_compliance, "angular compliance", "rad_per_N_m"},
    Named{d::inverse_area, "inverse area", "per_mm2"},
    Named{d::inverse_angle_squared, "inverse squared angle", "per_rad2"},
    Named{d::inverse_temperature, "inverse temperature", "per_K"},
};

void multiply(Unit& product, const Unit& factor, bool divide) {
  product.dimension = divide ? product.dimension / factor.dimension : product.dimension * factor.dimension;
  product.numerator *= divide ? factor.denominator : factor.numerator;
  product.denominator *= divide ? factor.numerator : factor.denominator;
}

/// "mm2": the atom mm, squared.
std::optional<std::pair<Unit, int>> parse_power(std::string_view text) {
  int power = 1;
  if (text.size() > 1 && text.back() >= '2' && text.back() <= '9') {
    power = text.back() - '0';
    text.remove_suffix(1);
  }
  const auto atom = std::find_if(k_atoms.begin(), k_atoms.end(), [&](const Atom& a) { return a.name == text; });
  if (atom == k_atoms.end()) return std::nullopt;
  return std::pair(atom->unit, power);
}

}  // namespace

std::optional<Unit> parse_unit(std::string_view suffix) {
  Unit product;
  bool divide = false, after_per = false;
  for (std::size_t begin = 0; begin <= suffix.size();) {
    const std::size_t end = std::min(suffix.find('_', begin), suffix.size());
    const std::string_view part = suffix.substr(begin, end - begin);
    begin = end + 1;
    if (part == "per") {
      if (after_per) return std::nullopt;
      divide = after_per = true;
      continue;
    }
    const auto factor = parse_power(part);
    if (!factor) return std::nullopt;
    if (factor->first.offset != 0.0) {  // a temperature on the Celsius scale can be neither multiplied nor divided by
      return part == suffix && factor->second == 1 ? std::optional(factor->first) : std::nullopt;
    }
    for (int i = 0; i < factor->second; ++i) multiply(product, factor->first, divide);
    after_per = false;
  }
  return after_per ? std::nullopt : std::optional(product);
}

Unit unit(std::string_view suffix) {
  const auto parsed = parse_unit(suffix);
  if (!parsed) throw std::logic_error("not a unit: " + std::string(suffix));
  return *parsed;
}

std::string name_of(const Dimension& dimension) {
  for (const Named& named : k_names) {
    if (named.dimension == dimension) return std::string(named.name);
  }
  std::string text = "quantity of dimension";
  const auto add = [&text](const char* base, int exponent) {
    if (exponent != 0) text.append(" ").append(base).append("^").append(std::to_string(exponent));
  };
  add("length", dimension.length);
  add("mass", dimension.mass);
  add("time", dimension.time);
  add("angle", dimension.angle);
  add("voltage", dimension.voltage);
  add("temperature", dimension.temperature);
  return dimension == dimension::none ? "plain number" : text;
}

std::string usual_unit(const Dimension& dimension) {
  for (const Named& named : k_names) {
    if (named.dimension == dimension) return std::string(named.usual);
  }
  return {};
}

std::optional<NamedUnit> split_name_and_unit(std::string_view key) {
  for (std::size_t at = key.find('_'); at != std::string_view::npos; at = key.find('_', at + 1)) {
    if (at == 0) continue;
    if (const auto parsed = parse_unit(key.substr(at + 1))) {
      return NamedUnit{std::string(key.substr(0, at)), std::string(key.substr(at + 1)), *parsed};
    }
  }
  return std::nullopt;
}

}  // namespace grouser
