#include "test_data/generator/campaign_files.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numbers>

namespace grouser {
namespace {

using Json = nlohmann::ordered_json;

constexpr double k_degree = std::numbers::pi / 180.0;
constexpr double k_converter_step = 20.0 / 65536.0;  // V; 16 bits over +-10 V

// Sensors as they truly are; rig.json states the same values, so what is left is noise and the converter's steps.
struct Lvdt {
  const char* column;
  double sensitivity, offset, square, cube;  // mm/V, V, m/V^2, m/V^3
};
constexpr Lvdt k_lvdt_a{"lvdt_a_V", 0.25, 0.0312, 4.0e-7, -2.0e-8};
constexpr Lvdt k_lvdt_b{"lvdt_b_V", 0.248, -0.0184, -3.0e-7, 1.5e-8};
constexpr double k_load_cell = 12.0, k_load_cell_offset = -0.0123;  // kN/V, V

double displacement_of(const Lvdt& lvdt, double reading) {
  const double v = reading - lvdt.offset;
  return v * (lvdt.sensitivity * 1e-3 + v * (lvdt.square + v * lvdt.cube));
}

// Reading that belongs to a displacement: Newton from the straight line; the curve bends by 0.3 % only.
double reading_of(const Lvdt& lvdt, double displacement) {
  double v = displacement / (lvdt.sensitivity * 1e-3);
  for (int i = 0; i < 4; ++i) {
    const double slope = lvdt.sensitivity * 1e-3 + v * (2.0 * lvdt.square + 3.0 * v * lvdt.cube);
    v -= (displacement_of(lvdt, v + lvdt.offset) - displacement) / slope;
  }
  return v + lvdt.offset;
}

double converted(double volts) { return std::round(volts / k_converter_step) * k_converter_step; }

// Eight digits say all there is and hide the last bits, in which processors differ.
double shown(double value) { return std::stod(fmt::format("{:.8g}", value)); }
Json shown(const std::vector<double>& values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(shown(value));
  return list;
}

std::string csv_in_volts(const GeneratedTest& test, double displacement_noise, std::uint64_t seed) {
  PortableRandom random(seed);
  std::string text = "time_s,lvdt_a_V,lvdt_b_V,load_cell_V\n";
  for (std::size_t i = 0; i < test.time.size(); ++i) {
    const double tilt = test.tilt_per_force * test.force[i] + displacement_noise * random.normal();
    fmt::format_to(std::back_inserter(text), "{:.7g},{:.5f},{:.5f},{:.5f}\n", test.time[i],
                   converted(reading_of(k_lvdt_a, test.displacement[i] + tilt)),
                   converted(reading_of(k_lvdt_b, test.displacement[i] - tilt)),
                   converted(test.force[i] / (k_load_cell * 1e3) + k_load_cell_offset));
  }
  return text;
}

std::string csv_in_degrees(const GeneratedTest& test) {
  std::string text = "time_s,angle_deg,torque_N_m\n";
  for (std::size_t i = 0; i < test.time.size(); ++i) {
    fmt::format_to(std::back_inserter(text), "{:.7g},{:.5f},{:.2f}\n", test.time[i], test.displacement[i] / k_degree,
                   test.force[i]);
  }
  return text;
}

Json test_entry(const PlannedTest& plan) {
  const bool turns = is_rotation(plan.axis);
  const char* unit = turns ? "deg" : "mm";
  const double size = turns ? k_degree : 1e-3;
  Json entry;
  entry["name"] = plan.name;
  entry["axis"] = name_of(plan.axis);
  entry["kind"] = plan.kind == TestKind::static_ramp ? "static" : "cyclic";
  entry["file"] = plan.name + ".csv";
  if (plan.kind == TestKind::static_ramp) {
    entry[fmt::format("rate_{}_per_min", unit)] = shown(plan.rate * 60.0 / size);
  } else {
    entry["frequency_Hz"] = plan.frequency;
    entry[fmt::format("amplitude_{}", unit)] = shown(plan.amplitude / size);
    if (plan.preset != 0.0) entry[fmt::format("preset_{}", unit)] = shown(plan.preset / size);
  }
  return entry;
}

// Eleven stations of a micrometer, read with its error.
Json lvdt_entry(const Lvdt& lvdt, PortableRandom& random) {
  Json readings = Json::array(), displacements = Json::array();
  for (int i = -5; i <= 5; ++i) {
    const double displacement = 0.4e-3 * i;
    readings.push_back(shown(std::round(1e5 * reading_of(lvdt, displacement + 0.5e-6 * random.normal())) / 1e5));
    displacements.push_back(shown(displacement * 1e3));
  }
  return {{"column", lvdt.column},
          {"sensitivity_mm_per_V", lvdt.sensitivity},
          {"offset_V", lvdt.offset},
          {"linearity", {lvdt.square, lvdt.cube}},
          {"record", {{"reading_V", readings}, {"displacement_mm", displacements}}}};
}

Json load_cell_entry(PortableRandom& random) {
  Json readings = Json::array(), forces = Json::array();
  for (int i = 0; i <= 10; ++i) {
    const double force = 10.0 * i + 0.02 * random.normal();
    readings.push_back(shown(std::round(1e5 * (force / k_load_cell + k_load_cell_offset)) / 1e5));
    forces.push_back(10.0 * i);
  }
  return {{"column", "load_cell_V"},
          {"sensitivity_kN_per_V", k_load_cell},
          {"offset_V", k_load_cell_offset},
          {"record", {{"reading_V", readings}, {"force_kN", forces}}}};
}

Json rig_document(const std::vector<AxisCampaign>& campaign, std::uint64_t seed) {
  PortableRandom random(seed);
  Json document;
  document["format"] = "grouser.rig/1";
  document["specimen"] = {
      {"name", "reference track bushing (synthetic)"},
      {"bushings_in_series", 1},
      {"geometry", {{"description", "one link joint: the pin's bushings taken as one compound bushing"}}}};
  document["synthetic"] = {
      {"note", "generated by make_rig_campaign, not measured"}, {"seed", seed}, {"truth", "truth.json"}};
  document["rig_compliance_m_per_N"] = campaign.front().errors.compliance;
  document["sensors"]["displacement"] = {lvdt_entry(k_lvdt_a, random), lvdt_entry(k_lvdt_b, random)};
  document["sensors"]["force"] = load_cell_entry(random);
  document["tests"] = Json::array();
  for (const AxisCampaign& axis : campaign) {
    for (const PlannedTest& plan : axis.tests) document["tests"].push_back(test_entry(plan));
  }
  return document;
}

Json true_elements(const TrueRubber& rubber) {
  Json stops = Json::array(), branches = Json::array();
  for (const FrictionStop& stop : rubber.stops) {
    stops.push_back({{"stiffness", shown(stop.stiffness)}, {"yield", shown(stop.yield)}});
  }
  for (const MaxwellBranch& branch : rubber.branches) {
    branches.push_back({{"stiffness", shown(branch.stiffness)}, {"relaxation_time", shown(branch.relaxation_time)}});
  }
  return {{"k1", shown(rubber.k1)},
          {"k3", shown(rubber.k3)},
          {"stops", stops},
          {"maxwell", branches},
          {"springpot", {{"coefficient", shown(rubber.springpot)}, {"order", rubber.springpot_order}}}};
}

Json true_errors(const RigErrors& errors) {
  return {{"displacement_noise", shown(errors.displacement_noise)},
          {"displacement_zero", shown(errors.displacement_zero)},
          {"force_noise", shown(errors.force_noise)},
          {"force_offset", shown(errors.force_offset)},
          {"force_drift", shown(errors.force_drift)},
          {"remounting_gain", errors.remounting_gain},
          {"conditioning", errors.conditioning},
          {"conditioning_cycles", errors.conditioning_cycles},
          {"compliance", errors.compliance}};
}

Json true_response(const GeneratedTest& test) {
  return {{"name", test.plan.name},
          {"dissipated_energy", shown(test.truth.dissipated_energy)},
          {"effective_stiffness", shown(test.truth.effective_stiffness)},
          {"storage_stiffness", shown(test.storage_stiffness)},
          {"loss_factor", shown(test.truth.loss_factor)}};
}

Json true_axis(const AxisCampaign& axis) {
  Json entry;
  entry["axis"] = name_of(axis.axis);
  entry["rubber"] = true_elements(axis.rubber);
  entry["errors"] = true_errors(axis.errors);
  const Backbone backbone = true_backbone(axis);
  entry["backbone"] = {{"displacement", shown(backbone.displacement)}, {"force", shown(backbone.force)}};
  entry["tests"] = Json::array();
  return entry;
}

}  // namespace

std::map<std::string, std::string> campaign_files(std::uint64_t seed) {
  const std::vector<AxisCampaign> campaign = reference_campaign(seed);
  std::map<std::string, std::string> files;
  files["rig.json"] = rig_document(campaign, seed).dump(2) + "\n";
  Json truth;
  truth["note"] =
      "What the synthetic campaign was made from. SI units: N, m, s; on rx, ry, rz N m, rad, s. "
      "tests: response of the settled rubber in the last cycle, without any error of rig or sensor.";
  truth["seed"] = seed;
  truth["axes"] = Json::array();
  std::uint64_t number = 0;
  for (const AxisCampaign& axis : campaign) {
    Json entry = true_axis(axis);
    for (const PlannedTest& plan : axis.tests) {
      const GeneratedTest test = run_test(axis, plan, seed);
      entry["tests"].push_back(true_response(test));
      files[plan.name + ".csv"] = is_rotation(plan.axis)
                                      ? csv_in_degrees(test)
                                      : csv_in_volts(test, axis.errors.displacement_noise, seed + ++number);
    }
    truth["axes"].push_back(entry);
  }
  files["truth.json"] = truth.dump(1) + "\n";
  return files;
}

}  // namespace grouser
