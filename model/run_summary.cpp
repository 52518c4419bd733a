#include <limits>

#include "model/file_json.h"
#include "model/run.h"
#include "model/run_layout.h"

namespace grouser {
namespace {

namespace d = dimension;
constexpr double k_unknown = std::numeric_limits<double>::quiet_NaN();

Json counts_json(const RunSummary& s) {
  return Json{{"bodies", s.counts.bodies},
              {"revolute_joints", s.counts.revolute_joints},
              {"bushings", s.counts.bushings},
              {"degrees_of_freedom", s.counts.degrees_of_freedom},
              {"prescribed", s.counts.prescribed}};
}

Json steps_json(const RunSummary& s) {
  return Json{
      {"accepted", s.steps.accepted}, {"rejected", s.steps.rejected}, {"force_evaluations", s.steps.force_evaluations},
      {"min_s", s.steps.min},         {"mean_s", s.steps.mean},       {"max_s", s.steps.max}};
}

Json energy_json(const RunSummary& s) {
  return Json{{"input_J", s.energy.input},
              {"dissipated_J", s.energy.dissipated},
              {"residual_J", s.energy.residual},
              {"residual_fraction", s.energy.residual_fraction}};
}

/// A result that could not be computed stands as null.
double number_or_null(ObjectReader& r, const std::string& key) {
  const Json* value = r.raw(key);
  return value != nullptr && value->is_null() ? k_unknown : r.number(key);
}

void read_numbers(ObjectReader& reader, RunSummary& s) {
  reader.object("counts", [&](ObjectReader& r) {
    s.counts.bodies = r.count("bodies", 0);
    s.counts.revolute_joints = r.count("revolute_joints", 0);
    s.counts.bushings = r.count("bushings", 0);
    s.counts.degrees_of_freedom = r.count("degrees_of_freedom", 0);
    s.counts.prescribed = r.count("prescribed", 0);
  });
  reader.object("steps", [&](ObjectReader& r) {
    s.steps.accepted = r.integer("accepted", 0);
    s.steps.rejected = r.integer("rejected", 0);
    s.steps.force_evaluations = r.integer("force_evaluations", 0);
    s.steps.min = r.quantity("min", d::time);
    s.steps.mean = r.quantity("mean", d::time);
    s.steps.max = r.quantity("max", d::time);
  });
  reader.object("energy", [&](ObjectReader& r) {
    s.energy.input = number_or_null(r, "input_J");
    s.energy.dissipated = number_or_null(r, "dissipated_J");
    s.energy.residual = number_or_null(r, "residual_J");
    s.energy.residual_fraction = number_or_null(r, "residual_fraction");
  });
}

void read_results(ObjectReader& reader, RunSummary& s) {
  reader.object("results", [&](ObjectReader& results) {
    results.each_member([&](const std::string& name, const Json& value) {
      if (value.is_number() || value.is_null()) {
        s.results.push_back({name, value.is_null() ? k_unknown : value.get<double>(), "", ""});
      } else {
        results.report(name, "a number or null", shown(value));
      }
    });
  });
  reader.object("result_notes", [&](ObjectReader& notes) {
    for (RunResult& result : s.results) {
      notes.object(result.name, [&](ObjectReader& r) {
        result.unit = r.text("unit");
        result.meaning = r.text("meaning");
      });
    }
  });
  reader.each_optional("checks", [&](ObjectReader& r) {
    s.checks.push_back(
        {r.text("name"), number_or_null(r, "value"), r.text("unit"), r.text("limit"), r.boolean_or("pass", false)});
  });
}

RunSummary read_summary(ObjectReader& r) {
  RunSummary s;
  s.name = r.text("name");
  s.vehicle_name = r.text("vehicle");
  s.bushing_name = r.text("bushing");
  s.status = r.choice<RunStatus>(
      "status", {{"completed", RunStatus::completed}, {"stopped", RunStatus::stopped}, {"failed", RunStatus::failed}});
  s.message = r.text("message");
  s.simulated_time = r.quantity("simulated_time", d::time, Range::non_negative);
  s.wall_time = r.quantity("wall_time", d::time, Range::non_negative);
  s.assembly_wall_time = r.quantity("assembly_wall_time", d::time, Range::non_negative);
  static_cast<void>(number_or_null(r, "real_time_factor"));  // follows from the two times
  read_numbers(r, s);
  read_results(r, s);
  s.provenance = read_provenance(r);
  return s;
}

}  // namespace

const char* name_of(RunStatus status) {
  switch (status) {
    case RunStatus::completed:
      return "completed";
    case RunStatus::stopped:
      return "stopped";
    case RunStatus::failed:
      return "failed";
  }
  return "";
}

RunSummary read_run_summary(const std::filesystem::path& file) {
  RunSummary summary;
  read_document(file, k_run_format, [&](ObjectReader& reader) { summary = read_summary(reader); });
  return summary;
}

void write_run_summary(const RunSummary& s, const std::filesystem::path& file) {
  Json results = Json::object(), notes = Json::object();
  for (const RunResult& r : s.results) {
    results[r.name] = r.value;
    notes[r.name] = Json{{"unit", r.unit}, {"meaning", r.meaning}};
  }
  Json checks = Json::array();
  for (const RunCheck& c : s.checks) {
    checks.push_back(
        Json{{"name", c.name}, {"value", c.value}, {"unit", c.unit}, {"limit", c.limit}, {"pass", c.pass}});
  }
  const Json factor = s.simulated_time > 0.0 ? Json(s.wall_time / s.simulated_time) : Json(nullptr);
  write_whole(file, json_text(Json{{"format", k_run_format},
                                   {"name", s.name},
                                   {"vehicle", s.vehicle_name},
                                   {"bushing", s.bushing_name},
                                   {"status", name_of(s.status)},
                                   {"message", s.message},
                                   {"simulated_time_s", s.simulated_time},
                                   {"wall_time_s", s.wall_time},
                                   {"assembly_wall_time_s", s.assembly_wall_time},
                                   {"real_time_factor", factor},
                                   {"counts", counts_json(s)},
                                   {"steps", steps_json(s)},
                                   {"energy", energy_json(s)},
                                   {"results", results},
                                   {"result_notes", notes},
                                   {"checks", checks},
                                   {"provenance", provenance_json(s.provenance)}}));
}

RunFolder open_run(const std::filesystem::path& folder) {
  Scenario scenario = read_scenario(folder / "inputs" / "scenario.json");
  Vehicle vehicle = scenario.vehicle;
  RunFolder run{folder, read_run_summary(folder / "run.json"), std::move(vehicle), std::move(scenario),
                RunReader(folder / "run.h5")};
  check_layout(run);
  return run;
}

}  // namespace grouser
