#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>

#include "model/check.h"
#include "model/errors.h"
#include "model/fit.h"
#include "model/provenance.h"
#include "model/replay.h"
#include "model/run.h"
#include "tests/support/test_data.h"

/// The published schemas against the readers: what one accepts the other accepts, what one refuses the other refuses.
namespace grouser {
namespace {

using Json = nlohmann::ordered_json;

struct Mutation {
  const char* kind;
  const char* name;
  std::function<void(Json&)> apply;
};

void rename(Json& object, const char* from, const char* to) {
  object[to] = object.at(from);
  object.erase(from);
}

/// Every one of them is a mistake that people make.
const std::vector<Mutation>& mutations() {
  static const std::vector<Mutation> list{
      {"bushing", "unknown_key", [](Json& j) { j["color"] = "red"; }},
      {"bushing", "wrong_unit", [](Json& j) { rename(j["axes"]["x"]["stiffness"], "force_kN", "force_mm"); }},
      {"bushing", "no_unit", [](Json& j) { rename(j["axes"]["x"]["stiffness"], "displacement_mm", "displacement"); }},
      {"bushing", "missing_force", [](Json& j) { j["axes"]["x"]["stiffness"].erase("force_kN"); }},
      {"bushing", "text_for_number", [](Json& j) { j["axes"]["x"]["stiffness"]["force_kN"][0] = "1"; }},
      {"bushing", "one_point",
       [](Json& j) {
         j["axes"]["x"]["stiffness"] = {{"displacement_mm", {1}}, {"force_kN", {1}}};
       }},
      {"bushing", "negative_viscous", [](Json& j) { j["axes"]["x"]["viscous_N_s_per_m"] = -1; }},
      {"bushing", "shrinking_yield", [](Json& j) { j["axes"]["x"]["friction_yield_growth_per_mm2"] = -1; }},
      {"bushing", "yield_grows_with_the_angle", [](Json& j) { j["axes"]["x"]["friction_yield_growth_per_rad2"] = 1; }},
      {"bushing", "unknown_axis", [](Json& j) { j["axes"]["rw"] = j["axes"]["rx"]; }},
      {"bushing", "other_format", [](Json& j) { j["format"] = "grouser.bushing/2"; }},
      {"vehicle", "negative_pitch", [](Json& j) { j["left"]["track"]["pitch_mm"] = -194; }},
      {"vehicle", "half_a_link", [](Json& j) { j["left"]["track"]["links"] = 76.5; }},
      {"vehicle", "five_points", [](Json& j) { j["left"]["track"]["link"]["ground_points_mm"].erase(0); }},
      {"vehicle", "flat_point", [](Json& j) { j["left"]["idler"]["pivot_m"].erase(0); }},
      {"vehicle", "unknown_suspension",
       [](Json& j) { j["left"]["stations"][0]["suspension"]["kind"] = "leaf_spring"; }},
      {"vehicle", "bouncing_ball", [](Json& j) { j["left"]["sprocket"]["contact"]["restitution"] = 1.2; }},
      {"vehicle", "negative_play", [](Json& j) { j["left"]["track"]["clearance_mm"] = -1; }},
      {"vehicle", "stop_at_a_length", [](Json& j) { j["left"]["track"]["stop_angle_mm"] = 20; }},
      {"vehicle", "connector_without_inertia",
       [](Json& j) {
         j["left"]["track"]["connection"] = "double_pin";
         j["left"]["track"]["connector_length_mm"] = 63;
         j["left"]["track"]["connector"] = {{"mass_kg", 4}};
       }},
      {"vehicle", "no_right_side", [](Json& j) { j.erase("right"); }},
      {"vehicle", "colour_by_name", [](Json& j) { j["visual"]["parts"][0]["color"] = "green"; }},
      {"scenario", "no_duration", [](Json& j) { j.erase("duration_s"); }},
      {"scenario", "duration_in_metres", [](Json& j) { rename(j, "duration_s", "duration_m"); }},
      {"scenario", "beta_too_large", [](Json& j) { j["integrator"]["beta"] = 1.1; }},
      {"scenario", "bushing_of_no_stiffness", [](Json& j) { j["bushing_scale"] = 0; }},
      {"scenario", "bushing_scale_of_an_unknown_axis",
       [](Json& j) {
         j["bushing_scale"] = {{"radial", 2}};
       }},
      {"scenario", "probe_of_the_middle", [](Json& j) { j["output"]["probes"][0]["side"] = "middle"; }},
      {"scenario", "one_sided_drive", [](Json& j) { j["drive"].erase("left"); }},
      {"scenario", "slope_in_percent", [](Json& j) { j["terrain"]["slope_percent"] = 30; }},
      {"scenario", "zone_without_an_end",
       [](Json& j) {
         j["terrain"]["friction_zones"] = {{{"from_m", 1}, {"friction", 0.2}}};
       }},
      {"scenario", "road_of_class_z",
       [](Json& j) {
         j["terrain"]["iso_8608"] = {{"class", "Z"}, {"seed", 1}, {"length_m", 100}};
       }},
      {"scenario", "half_round_without_radius",
       [](Json& j) {
         j["terrain"]["obstacles"] = {{{"kind", "half_round"}, {"position_m", 5}, {"height_mm", 200}}};
       }},
      {"scenario", "torque_in_newtons", [](Json& j) { rename(j["drive"]["left"], "speed_rad_per_s", "torque_N"); }},
      {"scenario", "driver_without_an_engine",
       [](Json& j) { rename(j["drive"]["left"], "speed_rad_per_s", "target_speed_m_per_s"); }},
      {"rig", "no_tests", [](Json& j) { j["tests"] = Json::array(); }},
      {"rig", "unknown_axis", [](Json& j) { j["tests"][0]["axis"] = "w"; }},
      {"rig", "rate_is_a_length", [](Json& j) { j["tests"][0]["rate_mm"] = 2; }},
      {"rig", "no_bushing", [](Json& j) { j["specimen"]["bushings_in_series"] = 0; }},
      {"rig", "blind_sensor",
       [](Json& j) {
         j["sensors"]["force"] = {{"column", "force_kN"}};
       }},
      {"rig", "unknown_correction", [](Json& j) { j["tests"][0]["corrections"][0] = "make_it_good"; }},
      {"rig", "correction_without_array", [](Json& j) { j["corrections"] = "reverse_force"; }},
      {"rig", "floating_mass", [](Json& j) { j["moving_mass_kg"] = -4; }},
      {"rig", "frame_in_millimetres",
       [](Json& j) { rename(j, "rig_angular_compliance_deg_per_N_m", "rig_angular_compliance_mm_per_N"); }},
      {"rig", "softening_of_nothing", [](Json& j) { j["thermal"].erase("reference_temperature_degC"); }},
      {"rig", "softening_per_second",
       [](Json& j) { rename(j["thermal"], "stiffness_change_per_K", "stiffness_change_per_s"); }},
      {"rig", "file_and_protocol", [](Json& j) { j["tests"][1]["file"] = "loop.csv"; }},
      {"rig", "neither_file_nor_protocol", [](Json& j) { j["tests"][1].erase("protocol"); }},
      {"rig", "ramp_without_rate", [](Json& j) { j["tests"][1].erase("rate_mm_per_min"); }},
      {"rig", "ramp_to_nothing", [](Json& j) { j["tests"][1]["protocol"]["to_force_kN"] = 0; }},
      {"rig", "ramp_to_a_torque", [](Json& j) { rename(j["tests"][1]["protocol"], "to_force_kN", "to_torque_kN_m"); }},
      {"rig", "two_sample_rates", [](Json& j) { j["tests"][1]["protocol"]["sample_rate_Hz"] = 10; }},
      {"rig", "loop_without_amplitude", [](Json& j) { j["tests"][2].erase("amplitude_deg"); }},
      {"rig", "loop_to_a_force", [](Json& j) { j["tests"][2]["protocol"]["to_force_kN"] = 98; }},
      {"fit", "negative_count", [](Json& j) { j["tests"][0]["cycles"] = -1; }},
      {"fit", "measure_of_another_axis",
       [](Json& j) { rename(j["tests"][0], "effective_stiffness_N_per_m", "effective_stiffness_N_m_per_rad"); }},
      {"fit", "one_sided_interval",
       [](Json& j) { j["axes"]["x"]["responses"][0]["loss_factor"]["interval_95"] = {1.0}; }},
      {"fit", "response_without_energy", [](Json& j) { j["axes"]["x"]["responses"][0].erase("dissipated_energy_J"); }},
      {"fit", "correction_without_words", [](Json& j) { j["corrections"][0].erase("text"); }},
      {"fit", "half_a_stop", [](Json& j) { j["axes"]["x"]["selection"][0]["stops"] = 0.5; }},
      {"fit", "no_solver", [](Json& j) { j["axes"]["x"].erase("solver"); }},
      {"replay", "error_of_a_prediction", [](Json& j) { j["tests"][1]["nrmse"] = 0.01; }},
      {"replay", "nothing_measured", [](Json& j) { j["tests"][0].erase("loss_factor"); }},
      {"replay", "no_law", [](Json& j) { j.erase("bushing"); }},
      {"replay", "wordless_warning", [](Json& j) { j["warnings"][0].erase("text"); }},
      {"camera", "no_angle_and_no_height", [](Json& j) { j.erase("field_of_view_deg"); }},
      {"camera", "angle_and_height", [](Json& j) { j["height_m"] = 3; }},
      {"camera", "unknown_mount", [](Json& j) { j["mount"] = "turret"; }},
      {"camera", "flat_eye",
       [](Json& j) {
         j["eye_m"] = {1, 2};
       }},
      {"run", "unknown_status", [](Json& j) { j["status"] = "finished"; }},
      {"run", "no_energy", [](Json& j) { j.erase("energy"); }},
      {"run", "worded_result", [](Json& j) { j["results"]["cruise_speed_m_per_s"] = "fast"; }},
  };
  return list;
}

FitRecord small_fit() {
  FitRecord fit;
  fit.specimen = "s";
  fit.tests.resize(1);
  fit.tests[0].name = "t";
  fit.tests[0].per_cycle.resize(1);
  fit.axes.resize(1);
  AxisFit& axis = fit.axes[0];
  axis.parameters.resize(1);
  axis.responses.resize(1);
  axis.selection.resize(1);
  axis.clearance.emplace();
  axis.hard_stops.resize(1);
  fit.corrections.push_back({"reverse_force", "t", "x"});
  return fit;
}

RunSummary small_run() {
  RunSummary run;
  run.results.push_back({"cruise_speed_m_per_s", 13.9, "m/s", "mean"});
  run.checks.push_back({"c", 1.0, "", "", true});
  return run;
}

/// Documents that are right, one of each kind.
std::map<std::string, Json> valid_documents(const TemporaryFolder& folder) {
  std::map<std::string, Json> documents;
  const auto parsed = [](const std::filesystem::path& file) { return Json::parse(read_whole(file)); };
  documents["bushing"] = parsed(test_data("broken/good_bushing.json"));
  documents["vehicle"] = parsed(test_data("vehicles/reference.json"));
  documents["scenario"] = parsed(test_data("scenarios/run_a.json"));
  documents["scenario"]["vehicle"] = test_data("vehicles/reference.json").string();
  documents["scenario"]["bushing"] = test_data("broken/good_bushing.json").string();
  documents["scenario"]["bushing_scale"] = {{"ry", 0.5}};
  folder.write("loop.csv", "time_s,displacement_mm,force_kN,temperature_degC\n0,0,0,23\n1,1,1,24\n");
  documents["rig"] = Json::parse(R"({"format": "grouser.rig/1", "specimen": {"name": "s", "bushings_in_series": 2},
      "rig_compliance_mm_per_kN": 0.001, "rig_angular_compliance_deg_per_N_m": 1e-6, "moving_mass_kg": 4,
      "moving_inertia_kg_m2": 0.1, "corrections": ["reverse_force"],
      "thermal": {"stiffness_change_per_K": -0.003, "reference_temperature_degC": 23},
      "sensors": {"displacement": [{"column": "lvdt_a_mV_per_V", "sensitivity_mm_V_per_mV": 0.02}],
                  "torque": {"column": "cell_V", "sensitivity_N_m_per_V": 50, "offset_mV": 3}}, "synthetic": {"note": "n", "seed": 1, "truth": {}},
      "tests": [{"name": "t", "axis": "x", "kind": "cyclic", "file": "loop.csv", "frequency_Hz": 1, "amplitude_mm": 1, "corrections": ["segment_at_jumps", "remove_creep"]},
        {"name": "ramp", "axis": "x", "kind": "static", "rate_mm_per_min": 2, "protocol": {"to_force_kN": 98, "ramps": 2, "samples": 40}},
        {"name": "loop", "axis": "ry", "kind": "cyclic", "amplitude_deg": 10, "frequency_Hz": 1, "protocol": {"cycles": 4}}]})");
  write_fit(small_fit(), folder.path() / "written");
  documents["fit"] = parsed(folder.path() / "written");
  std::vector<TestFit> driven(2, small_fit().tests[0]);
  driven[1].prediction = true;
  write_replay({"s", "b", driven, {{"rate_unknown", "t", "x"}}, {}, {}}, folder.path() / "written");
  documents["replay"] = parsed(folder.path() / "written");
  documents["camera"] = Json::parse(R"({"format": "grouser.camera/1", "name": "c", "mount": "heading",
      "eye_m": [6, -8, 3], "target_mm": [0, 0, 900], "field_of_view_deg": 36})");
  write_run_summary(small_run(), folder.path() / "written");
  documents["run"] = parsed(folder.path() / "written");
  return documents;
}

bool reader_accepts(const std::filesystem::path& file) {
  try {
    static_cast<void>(check_file(file));
    return true;
  } catch (const InputError&) {
    return false;
  }
}

/// Names that the schemas accept; nullopt without a Python that knows jsonschema.
std::optional<std::set<std::string>> accepted_by_schemas(const std::filesystem::path& folder) {
  const std::filesystem::path source = GROUSER_SOURCE_DIR;
  for (const std::string python : {GROUSER_PYTHON, "/usr/bin/python3"}) {
    if (std::system((python + " -c 'import jsonschema' 2>/dev/null").c_str()) != 0) continue;
    const std::string command = python + " " + (source / "tests/model/validate.py").string() + " " +
                                (source / "docs/schema").string() + " " + folder.string();
    FILE* pipe = ::popen(command.c_str(), "r");
    std::set<std::string> names;
    std::array<char, 256> line{};
    while (pipe != nullptr && std::fgets(line.data(), line.size(), pipe) != nullptr) {
      const std::string name = line.data();
      names.insert(name.substr(0, name.find('\n')));
    }
    if (pipe != nullptr) ::pclose(pipe);
    return names;
  }
  return std::nullopt;
}

TEST(Schemas, JudgeLikeTheReaders) {
  const TemporaryFolder folder;
  auto documents = valid_documents(folder);
  std::set<std::string> right, wrong;
  for (const auto& [kind, document] : documents) {
    right.insert(kind + ".right.json");
    folder.write(kind + ".right.json", document.dump());
  }
  for (const Mutation& mutation : mutations()) {
    Json document = documents.at(mutation.kind);
    mutation.apply(document);
    const std::string name = std::string(mutation.kind) + "." + mutation.name + ".json";
    wrong.insert(name);
    folder.write(name, document.dump());
  }
  EXPECT_GE(wrong.size(), 20u);
  for (const std::string& name : right) EXPECT_TRUE(reader_accepts(folder.path() / name)) << name;
  for (const std::string& name : wrong) EXPECT_FALSE(reader_accepts(folder.path() / name)) << name;
  const auto accepted = accepted_by_schemas(folder.path());
  if (!accepted) GTEST_SKIP() << "no Python with jsonschema (Debian package python3-jsonschema)";
  EXPECT_EQ(*accepted, right);
}

}  // namespace
}  // namespace grouser
