#include "tests/support/mock_inputs.h"

#include <nlohmann/json.hpp>

#include "model/geometry.h"
#include "model/provenance.h"

namespace grouser::mock {
namespace {

using nlohmann::json;

json body(double mass) {
  return {{"mass_kg", mass}, {"center_of_mass_m", {0, 0, 0}}, {"inertia_kg_m2", {mass, mass, mass}}};
}

json discs(double x, double z, double radius) {
  return {{"mass_kg", 100.0},
          {"inertia_kg_m2", {5, 8, 5}},
          {"center_m", {x, 1.4, z}},
          {"radius_m", radius},
          {"disc_width_m", 0.14},
          {"gap_m", 0.1},
          {"contact", {{"stiffness_N_per_m2", 2.2e8}, {"friction", 0.4}}}};
}

json station(double x) {
  return {{"pivot_m", {x + 0.4, 1.4, 0.62}},
          {"arm", body(70.0)},
          {"wheel", discs(x, 0.40, 0.32)},
          {"suspension",
           {{"kind", "torsion_bar"},
            {"stiffness_N_m_per_rad", 5e4},
            {"free_angle_deg", 40},
            {"damping_N_m_s_per_rad", 300}}}};
}

json track() {
  json points = json::array();
  for (const double x : {-0.06, 0.06})
    for (const double y : {-0.2, 0.0, 0.2}) points.push_back({x, y, -0.055});
  const json link{{"mass_kg", 30.0},
                  {"inertia_kg_m2", {0.9, 0.2, 0.9}},
                  {"shoe_width_m", 0.5},
                  {"ground_depth_m", 0.055},
                  {"wheel_path_height_m", 0.025},
                  {"ground_points_m", points},
                  {"guide", {{"height_m", 0.1}, {"base_width_m", 0.07}, {"top_width_m", 0.04}}},
                  {"ground_contact", {{"stiffness_N_per_m", 5e6}}}};
  return {{"links", k_num_links},  {"pitch_m", 0.194},     {"connection", "single_pin"},
          {"pin_radius_m", 0.022}, {"pre_tension_kN", 50}, {"link", link}};
}

json vehicle(const RunOptions& options) {
  json stations = json::array();
  for (int i = 0; i < k_num_stations; ++i) stations.push_back(station(1.9 - 0.76 * i));
  json left{{"track_center_y_m", 1.4},
            {"sprocket",
             {{"mass_kg", 250.0},
              {"inertia_kg_m2", {10, 18, 10}},
              {"center_m", {-2.75, 1.4, 0.82}},
              {"teeth", 10},
              {"tip_radius_m", 0.335},
              {"base_radius_m", 0.28},
              {"flank_angle_deg", 20},
              {"seat_clearance_mm", 3},
              {"ring_offset_m", 0.18},
              {"side_clearance_m", 0.015},
              {"contact", {{"stiffness_N_per_m", 5e7}}}}},
            {"idler",
             {{"pivot_m", {2.5, 1.4, 0.8}},
              {"arm", body(60.0)},
              {"wheel", discs(2.75, 0.75, 0.31)},
              {"tensioner", {{"stiffness_N_per_m", 1e7}, {"damping_N_s_per_m", 3e4}}}}},
            {"support_rollers", {discs(1.4, 0.98, 0.1), discs(0.0, 1.0, 0.1), discs(-1.4, 1.0, 0.1)}},
            {"stations", stations},
            {"track", track()}};
  if (options.double_pin) left["track"].update({{"connection", "double_pin"}, {"connector_length_mm", 60}});
  return {{"format", "grouser.vehicle/1"},
          {"name", options.vehicle_name},
          {"chassis", body(4e4)},
          {"left", left},
          {"right", {{"mirror", "left"}}}};
}

json drive_table(const RunOptions& options, double speed) {
  const double d = options.duration;
  json table{{"time_s", {0.0, d / 3.0, 2.0 * d / 3.0, d}}};
  const json shape{0.0, 1.0, 1.0, 0.0};
  const auto values = [&](double top) {
    json list = json::array();
    for (const json& part : shape) list.push_back(top * part.get<double>());
    return list;
  };
  switch (options.drive) {
    case Drive::speed:
      table["speed_rad_per_s"] = values(speed);
      break;
    case Drive::torque:
      table["torque_kN_m"] = values(8.0);
      break;
    case Drive::cruise:
      table.update({{"target_speed_m_per_s", values(1.94 / (2.0 * k_pi) * speed)},
                    {"power_kW", 500},
                    {"largest_torque_kN_m", 20},
                    {"brake_torque_kN_m", 20}});
      break;
  }
  return table;
}

json scenario(const RunOptions& options) {
  const double w = options.top_speed;
  json scenario{{"format", "grouser.scenario/1"},
                {"name", options.name},
                {"vehicle", "vehicle.json"},
                {"bushing", "bushing.json"},
                {"drive", {{"left", drive_table(options, w)}, {"right", drive_table(options, options.turn ? -w : w)}}},
                {"bushing_scale", options.bushing_scale},
                {"duration_s", options.duration}};
  if (options.rough)
    scenario["terrain"]["obstacles"] = {{{"kind", "half_round"}, {"radius_mm", 200}, {"position_m", 5}}};
  return scenario;
}

}  // namespace

Bushing straight_bushing() {
  Bushing bushing;
  bushing.name = "mock bushing";
  bushing.synthetic = true;
  bushing.provenance.synthetic = {"Mock data, made up for a test, seed 1."};
  for (int i = 0; i < k_num_axes; ++i) {
    AxisLaw& law = bushing.axes[static_cast<std::size_t>(i)];
    law.spring.displacement = {-0.002, 0.0, 0.002};
    law.spring.force = {-2e5, 0.0, 2e5};
    law.spring.slope = {1e8, 1e8, 1e8};
    law.valid = ValidRange{0.002, 0.1, 50.0, 0.1};
  }
  return bushing;
}

void write_inputs(const std::filesystem::path& folder, const RunOptions& options) {
  std::filesystem::create_directories(folder / "inputs");
  write_whole(folder / "inputs/vehicle.json", vehicle(options).dump(1));
  write_whole(folder / "inputs/scenario.json", scenario(options).dump(1));
  write_bushing(straight_bushing(), folder / "inputs/bushing.json");
}

}  // namespace grouser::mock
