#include "model/bushing.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "model/file_json.h"

namespace grouser {
namespace {

/// What differs between a translational and a rotational axis: dimensions to read, units to write.
struct AxisUnits {
  Dimension displacement, force, stiffness, damping, rate, growth;
  std::string displacement_key, force_key, slope_key, stiffness_key, yield_key, growth_key, viscous_key, amplitude_key,
      rate_key;
};

const AxisUnits& units_of(Axis axis) {
  static const AxisUnits translation{dimension::length,     dimension::force, dimension::stiffness,
                                     dimension::damping,    dimension::speed, dimension::inverse_area,
                                     "displacement_mm",     "force_kN",       "slope_kN_per_mm",
                                     "stiffness_kN_per_mm", "yield_mm",       "friction_yield_growth_per_mm2",
                                     "viscous_N_s_per_m",   "amplitude_mm",   "rate_mm_per_s"};
  static const AxisUnits rotation{dimension::angle,
                                  dimension::torque,
                                  dimension::angular_stiffness,
                                  dimension::angular_damping,
                                  dimension::angular_speed,
                                  dimension::inverse_angle_squared,
                                  "angle_deg",
                                  "torque_N_m",
                                  "slope_N_m_per_rad",
                                  "stiffness_N_m_per_rad",
                                  "yield_deg",
                                  "friction_yield_growth_per_rad2",
                                  "viscous_N_m_s_per_rad",
                                  "amplitude_deg",
                                  "rate_deg_per_s"};
  return is_rotation(axis) ? rotation : translation;
}

bool is_strictly_increasing(const std::vector<double>& values) {
  return std::adjacent_find(values.begin(), values.end(), std::greater_equal<>()) == values.end();
}

/// Least slope of the Hermite pieces; negative = not monotone.
double least_slope(const SpringSpline& spring) {
  SpringSpline reversed = spring;
  for (double& force : reversed.force) force = -force;
  for (double& slope : reversed.slope) slope = -slope;
  return -largest_slope(reversed, spring.displacement.front(), spring.displacement.back());
}

SpringSpline read_spring(ObjectReader& r, const AxisUnits& units) {
  // A rotational axis may call its quantities angle and torque, or displacement and force like the others.
  const std::string displacement = r.has_quantity("angle") ? "angle" : "displacement";
  const std::string force = r.has_quantity("torque") ? "torque" : "force";
  SpringSpline spring;
  spring.displacement = r.quantities(displacement, units.displacement);
  spring.force = r.quantities(force, units.force);
  const auto slope = r.optional_quantities("slope", units.stiffness);
  const std::size_t size = spring.displacement.size();
  const auto wrong_length = [&](const std::string& name, std::size_t found) {
    r.report(r.key_of(name), std::to_string(size) + " values, one for each " + displacement, std::to_string(found));
  };
  if (spring.displacement.empty() || spring.force.empty() || (slope && slope->empty())) return {};
  if (size < 2) {
    r.report(r.key_of(displacement), "at least 2 values", std::to_string(size));
    return {};
  }
  if (!is_strictly_increasing(spring.displacement)) {
    r.report(r.key_of(displacement), "strictly increasing values", "a value not above the one before it");
    return {};
  }
  if (spring.force.size() != size) {
    wrong_length(force, spring.force.size());
    return {};
  }
  if (slope && slope->size() != size) {
    wrong_length("slope", slope->size());
    return {};
  }
  spring.slope = slope ? *slope : fritsch_carlson_slopes(spring.displacement, spring.force);
  const double least = least_slope(spring);
  // A falling spring gives energy away; round-off of the conversion is not a fault.
  if (least < -1e-9 * largest_slope(spring, spring.displacement.front(), spring.displacement.back())) {
    r.report("", "a spring that never falls", "a slope of " + Json(least).dump() + " (SI)");
  }
  return spring;
}

/// Stops that follow the Berg element's virgin curve F = F_max x / (x_2 + x): its chords between six points
/// whose spacing makes all chords equally good, within 2 % of F_max up to 35 x_2, where 97 % of F_max is reached.
std::vector<FrictionStop> expand_berg(double force_max, double half_displacement) {
  constexpr int num_stops = 6;
  constexpr double last = 1.0 / 6.0;  // of 1 / sqrt(1 + x / x_2)
  std::array<double, num_stops + 1> x{}, slope{};
  const auto force = [&](double at) { return force_max * at / (half_displacement + at); };
  for (int i = 1; i <= num_stops; ++i) {
    const double g = 1.0 - (1.0 - last) * i / num_stops;
    x[i] = half_displacement * (1.0 / (g * g) - 1.0);
    slope[i - 1] = (force(x[i]) - force(x[i - 1])) / (x[i] - x[i - 1]);
  }
  std::vector<FrictionStop> stops;
  for (int i = 1; i <= num_stops; ++i) stops.push_back({slope[i - 1] - slope[i], x[i]});
  return stops;
}

void read_friction(ObjectReader& r, const AxisUnits& units, std::vector<FrictionStop>& stops) {
  if (!r.has("law")) {
    stops.push_back({r.quantity("stiffness", units.stiffness, Range::non_negative),
                     r.quantity("yield", units.displacement, Range::positive)});
    return;
  }
  static_cast<void>(r.choice<int>("law", {{"berg", 0}}));
  const double force_max = r.quantity("force_max", units.force, Range::non_negative);
  const double half_displacement = r.quantity("half_displacement", units.displacement, Range::positive);
  for (const FrictionStop& stop : expand_berg(force_max, half_displacement)) stops.push_back(stop);
}

AxisLaw read_axis(ObjectReader& r, const AxisUnits& units) {
  AxisLaw law;
  r.object("stiffness", [&](ObjectReader& s) { law.spring = read_spring(s, units); });
  r.each_optional("friction", [&](ObjectReader& f) { read_friction(f, units, law.stops); });
  law.yield_growth = r.quantity_or("friction_yield_growth", units.growth, 0.0, Range::non_negative);
  r.each_optional("maxwell", [&](ObjectReader& m) {
    law.branches.push_back({m.quantity("stiffness", units.stiffness, Range::non_negative),
                            m.quantity("relaxation_time", dimension::time, Range::positive)});
  });
  law.viscous = r.quantity_or("viscous", units.damping, 0.0, Range::non_negative);
  r.optional_object("valid", [&](ObjectReader& v) {
    ValidRange& valid = law.valid.emplace();
    valid.amplitude = v.quantity("amplitude", units.displacement, Range::non_negative);
    valid.frequency_low = v.quantity_or("frequency_low", dimension::frequency, 0.0, Range::non_negative);
    valid.frequency_high = v.quantity_or("frequency_high", dimension::frequency, 0.0, Range::non_negative);
    valid.rate = v.quantity_or("rate", units.rate, 0.0, Range::non_negative);
  });
  return law;
}

double in_unit_of(const std::string& key, double value) {
  if (!std::isfinite(value))
    throw NumericalError("a bushing with a " + key + " that is no finite number cannot be written");
  return split_name_and_unit(key)->unit.from_si(value);
}

void put(Json& object, const std::string& key, double value) { object[key] = in_unit_of(key, value); }

void put(Json& object, const std::string& key, const std::vector<double>& values) {
  Json& array = object[key] = Json::array();
  for (const double value : values) array.push_back(in_unit_of(key, value));
}

Json axis_json(const AxisLaw& law, const AxisUnits& units) {
  Json axis, spring;
  put(spring, units.displacement_key, law.spring.displacement);
  put(spring, units.force_key, law.spring.force);
  put(spring, units.slope_key, law.spring.slope);
  axis["stiffness"] = spring;
  axis["friction"] = Json::array();
  for (const FrictionStop& stop : law.stops) {
    Json& item = axis["friction"].emplace_back(Json::object());
    put(item, units.stiffness_key, stop.stiffness);
    put(item, units.yield_key, stop.yield);
  }
  if (law.yield_growth != 0.0) put(axis, units.growth_key, law.yield_growth);
  axis["maxwell"] = Json::array();
  for (const MaxwellBranch& branch : law.branches) {
    Json& item = axis["maxwell"].emplace_back(Json::object());
    put(item, units.stiffness_key, branch.stiffness);
    put(item, "relaxation_time_s", branch.relaxation_time);
  }
  put(axis, units.viscous_key, law.viscous);
  if (law.valid) {
    Json valid;
    put(valid, units.amplitude_key, law.valid->amplitude);
    put(valid, "frequency_low_Hz", law.valid->frequency_low);
    put(valid, "frequency_high_Hz", law.valid->frequency_high);
    put(valid, units.rate_key, law.valid->rate);
    axis["valid"] = valid;
  }
  return axis;
}

}  // namespace

Bushing scaled(const Bushing& bushing, const AxisScale& scale) {
  Bushing result = bushing;
  for (std::size_t a = 0; a < scale.size(); ++a) {
    AxisLaw& law = result.axes[a];
    for (double& force : law.spring.force) force *= scale[a];
    for (double& slope : law.spring.slope) slope *= scale[a];
    for (FrictionStop& stop : law.stops) stop.stiffness *= scale[a];
    for (MaxwellBranch& branch : law.branches) branch.stiffness *= scale[a];
    law.viscous *= scale[a];
  }
  return result;
}

Bushing read_bushing(ObjectReader& reader) {
  Bushing bushing;
  bushing.name = reader.text("name");
  bushing.synthetic = reader.boolean_or("synthetic", false);
  reader.object("axes", [&](ObjectReader& axes) {
    for (int i = 0; i < k_num_axes; ++i) {
      const Axis axis = static_cast<Axis>(i);
      axes.optional_object(name_of(axis), [&](ObjectReader& r) { bushing.axis(axis) = read_axis(r, units_of(axis)); });
    }
  });
  bushing.provenance = read_provenance(reader);
  return bushing;
}

Bushing read_bushing(const std::filesystem::path& file) {
  Bushing bushing;
  read_document(file, k_bushing_format, [&](ObjectReader& reader) { bushing = read_bushing(reader); });
  return bushing;
}

void write_bushing(const Bushing& bushing, const std::filesystem::path& file) {
  Json axes = Json::object();
  for (int i = 0; i < k_num_axes; ++i) {
    const Axis axis = static_cast<Axis>(i);
    const AxisLaw& law = bushing.axis(axis);
    if (!law.spring.displacement.empty()) axes[name_of(axis)] = axis_json(law, units_of(axis));
  }
  write_whole(file, json_text(Json{{"format", k_bushing_format},
                                   {"name", bushing.name},
                                   {"synthetic", bushing.synthetic},
                                   {"axes", axes},
                                   {"provenance", provenance_json(bushing.provenance)}}));
}

}  // namespace grouser
