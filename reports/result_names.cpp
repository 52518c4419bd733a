#include "reports/result_names.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <string_view>

#include "reports/pages.h"

namespace grouser {
namespace {

struct Name {
  std::string_view result, group, label;
};
constexpr std::array<Name, 41> k_names{{
    {"cruise_speed_m_per_s", "Drive", "Cruise speed"},
    {"distance_m", "Drive", "Distance"},
    {"lateral_drift_m", "Drive", "Lateral drift"},
    {"final_speed_m_per_s", "Drive", "Speed at the end"},
    {"yaw_rate_rad_per_s", "Drive", "Steady yaw rate"},
    {"no_slip_yaw_rate_rad_per_s", "Drive", "Yaw rate without slip"},
    {"yaw_turned_rad", "Drive", "Turned"},
    {"center_drift_m", "Drive", "Way of the centre"},
    {"parked_drift_m", "Drive", "Drift of the parked vehicle"},
    {"parked_speed_m_per_s", "Drive", "Speed of the parked vehicle"},
    {"link_passing_frequency_Hz", "Drive", "Link-passing frequency"},
    {"link_passing_torque_N_m", "Drive", "Torque at link passing"},
    {"link_passing_torque_background_N_m", "Drive", "Torque beside link passing"},
    {"rest_ground_force_N", "At rest", "Ground force"},
    {"weight_N", "At rest", "Weight"},
    {"left_rest_tension_N", "At rest", "Tension of the upper run, left"},
    {"right_rest_tension_N", "At rest", "Tension of the upper run, right"},
    {"ride_height_change_m", "At rest", "Ride height against design"},
    {"rest_pitch_rad", "At rest", "Pitch, nose down"},
    {"rest_largest_link_speed_m_per_s", "At rest", "Largest speed of a link"},
    {"largest_tension_N", "Track", "Largest tension in a bushing"},
    {"least_tension_N", "Track", "Least tension in a bushing"},
    {"largest_guide_offset_m", "Track", "Largest offset in the guide"},
    {"skipped_teeth", "Track", "Skipped teeth"},
    {"rest_mean_step_s", "Integration", "Mean step while the sprockets stand"},
    {"steady_mean_step_s", "Integration", "Mean step at steady speed"},
    {"mean_step_s", "Integration", "Mean step"},
    {"bushing_torsion_largest_rad", "Rubber", "Largest twist of one bushing"},
    {"bushing_torsion_rms_rad", "Rubber", "Twist of one bushing, rms"},
    {"bushing_torsion_moment_largest_N_m", "Rubber", "Largest hinge moment of one bushing"},
    {"bushing_torsion_moment_rms_N_m", "Rubber", "Hinge moment of one bushing, rms"},
    {"bushing_radial_force_largest_N", "Rubber", "Largest force across the pin in one bushing"},
    {"bushing_radial_force_rms_N", "Rubber", "Force across the pin in one bushing, rms"},
    {"bushing_axial_force_largest_N", "Rubber", "Largest force along the pin in one bushing"},
    {"bushing_axial_force_rms_N", "Rubber", "Force along the pin in one bushing, rms"},
    {"bushing_x_largest_over_identified", "Rubber", "Largest deflection along x over the identified one"},
    {"bushing_y_largest_over_identified", "Rubber", "Largest deflection along y over the identified one"},
    {"bushing_z_largest_over_identified", "Rubber", "Largest deflection along z over the identified one"},
    {"bushing_rx_largest_over_identified", "Rubber", "Largest angle about x over the identified one"},
    {"bushing_ry_largest_over_identified", "Rubber", "Largest hinge angle over the identified one"},
    {"bushing_rz_largest_over_identified", "Rubber", "Largest angle about z over the identified one"},
}};

struct Case {
  std::string_view name, partner, meaning;
};
constexpr std::array<Case, 15> k_cases{{
    {"one_disc_on_plate", "Wheel discs on links", "one disc on the plate"},
    {"two_discs_on_plate", "Wheel discs on links", "both discs on the plate"},
    {"one_disc_on_edge", "Wheel discs on links", "one disc, on the plate's edge"},
    {"two_discs_on_edge", "Wheel discs on links", "both discs, on the plate's edge"},
    {"guide_left_wall", "Centre guide", "left wall"},
    {"guide_right_wall", "Centre guide", "right wall"},
    {"guide_top", "Centre guide", "wheel on its top"},
    {"guide_none", "Centre guide", "free between the discs"},
    {"sprocket_top", "Sprocket", "top of a tooth"},
    {"sprocket_flank_driving", "Sprocket", "driving flank"},
    {"sprocket_flank_braking", "Sprocket", "braking flank"},
    {"sprocket_side_left", "Sprocket", "left side of a tooth"},
    {"sprocket_side_right", "Sprocket", "right side of a tooth"},
    {"sprocket_base", "Sprocket", "base circle"},
    {"ground_point", "Ground", "points of the shoes"},
}};

constexpr std::string_view k_contacts = "mean_contacts_";

const Name* known(const std::string& result) {
  const auto name = std::ranges::find(k_names, std::string_view(result), &Name::result);
  return name == k_names.end() ? nullptr : &*name;
}

std::string plain_words(const RunResult& result) {
  std::string suffix = "_";
  for (const char c : result.unit) suffix += c == '/' ? std::string("_per_") : c == ' ' ? "_" : std::string(1, c);
  std::string label = result.name;
  if (label.size() > suffix.size() && label.ends_with(suffix)) label.resize(label.size() - suffix.size());
  std::ranges::replace(label, '_', ' ');
  if (!label.empty()) label.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(label.front())));
  return label;
}

}  // namespace

bool is_contact_count(const RunResult& result) { return result.name.starts_with(k_contacts); }

ContactCase contact_case(const RunResult& result) {
  const std::string_view name = std::string_view(result.name).substr(k_contacts.size());
  const auto found = std::ranges::find(k_cases, name, &Case::name);
  if (found != k_cases.end()) return {std::string(found->partner), std::string(found->meaning)};
  std::string words(name);
  std::ranges::replace(words, '_', ' ');
  return {"Others", words};
}

nlohmann::json result_facts(double value, const std::string& unit, int digits) {
  constexpr double k_round_off = 1e-9;
  nlohmann::json facts = quantity_facts(value, unit, digits);
  if (std::abs(value) < k_round_off) facts["text"] = unit == "1" ? "0" : "0 " + unit;
  return facts;
}

std::string result_group(const RunResult& result) {
  if (is_contact_count(result)) return "Contacts, mean number at a time";
  const Name* name = known(result.name);
  if (name != nullptr) return std::string(name->group);
  return result.name.find("bushing") != std::string::npos ? "Rubber" : "Further";
}

std::string result_label(const RunResult& result) {
  if (is_contact_count(result)) {
    const ContactCase contact = contact_case(result);
    return contact.partner + ": " + contact.meaning;
  }
  const Name* name = known(result.name);
  return name != nullptr ? std::string(name->label) : plain_words(result);
}

}  // namespace grouser
