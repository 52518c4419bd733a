#include "model/fit.h"

#include <tuple>
#include <utility>

#include "model/file_json.h"
#include "model/fit_keys.h"

/// The record and its axes.
namespace grouser {
namespace {

Json band_json(const std::vector<BandPoint>& band, const FitKeys& keys, const std::string& quantity) {
  Json x = Json::array(), value = Json::array(), low = Json::array(), high = Json::array();
  for (const BandPoint& point : band) {
    x.push_back(point.x);
    value.push_back(point.value);
    low.push_back(point.low);
    high.push_back(point.high);
  }
  return Json{{"displacement_" + keys.displacement, x}, {quantity, value}, {"low_95", low}, {"high_95", high}};
}

std::vector<BandPoint> read_band(ObjectReader& r, const FitKeys& keys, const std::string& quantity) {
  const auto x = numbers_or_nulls(r, "displacement_" + keys.displacement), value = numbers_or_nulls(r, quantity);
  const auto low = numbers_or_nulls(r, "low_95"), high = numbers_or_nulls(r, "high_95");
  std::vector<BandPoint> band;
  if (value.size() != x.size() || low.size() != x.size() || high.size() != x.size()) {
    r.report("", "four arrays of one length", "different lengths");
    return band;
  }
  for (std::size_t i = 0; i < x.size(); ++i) band.push_back({x[i], value[i], low[i], high[i]});
  return band;
}

Json interval_json(const Interval& interval) {
  return Json{{"value", interval.value}, {"interval_95", Json::array({interval.low, interval.high})}};
}

/// The two ends of `interval_95`; the value itself where they are missing.
std::pair<double, double> read_ends(ObjectReader& r, double value) {
  const std::vector<double> ends = numbers_or_nulls(r, "interval_95");
  if (ends.size() == 2) return {ends.front(), ends.back()};
  if (!ends.empty()) r.report("interval_95", "two numbers", std::to_string(ends.size()));
  return {value, value};
}

Interval read_interval(ObjectReader& r, const std::string& key) {
  Interval interval;
  r.object(key, [&](ObjectReader& i) {
    interval.value = number_or_null(i, "value");
    std::tie(interval.low, interval.high) = read_ends(i, interval.value);
  });
  return interval;
}

Json response_json(const ResponsePoint& response, const FitKeys& keys) {
  Json json = Json::object();
  json["amplitude_" + keys.displacement] = response.amplitude;
  json["frequency_Hz"] = response.frequency;
  json["dissipated_energy_J"] = interval_json(response.energy);
  json["storage_stiffness_" + keys.stiffness] = interval_json(response.storage_stiffness);
  json["loss_stiffness_" + keys.stiffness] = interval_json(response.loss_stiffness);
  json["loss_factor"] = interval_json(response.loss_factor);
  return json;
}

ResponsePoint read_response(ObjectReader& r, const FitKeys& keys) {
  ResponsePoint response;
  response.amplitude = number_or_null(r, "amplitude_" + keys.displacement);
  response.frequency = number_or_null(r, "frequency_Hz");
  response.energy = read_interval(r, "dissipated_energy_J");
  response.storage_stiffness = read_interval(r, "storage_stiffness_" + keys.stiffness);
  response.loss_stiffness = read_interval(r, "loss_stiffness_" + keys.stiffness);
  response.loss_factor = read_interval(r, "loss_factor");
  return response;
}

Json candidate_json(const LawCandidate& candidate) {
  return Json{{"spring_intervals", candidate.spring_intervals},
              {"stops", candidate.stops},
              {"branches", candidate.branches},
              {"strain_dependent_yield", candidate.strain_dependent_yield},
              {"left_out_error", candidate.left_out_error},
              {"chosen", candidate.chosen}};
}

LawCandidate read_candidate(ObjectReader& r) {
  LawCandidate candidate;
  candidate.spring_intervals = r.count("spring_intervals", 0);
  candidate.stops = r.count("stops", 0);
  candidate.branches = r.count("branches", 0);
  candidate.strain_dependent_yield = r.boolean_or("strain_dependent_yield", false);
  candidate.left_out_error = number_or_null(r, "left_out_error");
  candidate.chosen = r.boolean_or("chosen", false);
  return candidate;
}

/// Clearance, hard stops and preset: what the data show of the joint beside its rubber.
void put_joint(Json& json, const AxisFit& axis, const FitKeys& keys) {
  const std::string& unit = keys.displacement;
  if (const auto& play = axis.clearance) {
    json["clearance"] =
        Json{{"low_" + unit, play->low}, {"high_" + unit, play->high}, {"stiffness_ratio", play->stiffness_ratio}};
  }
  json["hard_stops"] = Json::array();
  for (const HardStop& stop : axis.hard_stops) {
    json["hard_stops"].push_back(Json{{"at_" + unit, stop.at}, {"stiffness_ratio", stop.stiffness_ratio}});
  }
  json["preset_" + unit] = axis.preset;
}

void read_joint(ObjectReader& r, AxisFit& axis, const FitKeys& keys) {
  const std::string& unit = keys.displacement;
  r.optional_object("clearance", [&](ObjectReader& c) {
    axis.clearance = Clearance{number_or_null(c, "low_" + unit), number_or_null(c, "high_" + unit),
                               number_or_null(c, "stiffness_ratio")};
  });
  r.each("hard_stops", 0, [&](ObjectReader& s) {
    axis.hard_stops.push_back({number_or_null(s, "at_" + unit), number_or_null(s, "stiffness_ratio")});
  });
  axis.preset = number_or_null(r, "preset_" + unit);
}

Json parameter_json(const FitParameter& p) {
  return Json{{"name", p.name},
              {"unit", p.unit},
              {"value", p.value},
              {"standard_error", p.standard_error},
              {"interval_95", Json::array({p.low, p.high})},
              {"identified", p.identified}};
}

Json solver_json(const SolverSummary& solver) {
  return Json{{"termination", solver.termination},   {"iterations", solver.iterations},
              {"initial_cost", solver.initial_cost}, {"final_cost", solver.final_cost},
              {"kkt_residual", solver.kkt_residual}, {"starts", solver.starts}};
}

Json axis_json(const AxisFit& axis) {
  const FitKeys& keys = fit_keys_of(axis.axis);
  Json parameters = Json::array(), responses = Json::array(), selection = Json::array();
  for (const FitParameter& p : axis.parameters) parameters.push_back(parameter_json(p));
  for (const ResponsePoint& response : axis.responses) responses.push_back(response_json(response, keys));
  for (const LawCandidate& candidate : axis.selection) selection.push_back(candidate_json(candidate));
  Json json{{"parameters", parameters},
            {"covariance", axis.covariance},
            {"condition_number", axis.condition_number},
            {"not_identified", axis.not_identified},
            {"solver", solver_json(axis.solver)},
            {"selection", selection},
            {"backbone", band_json(axis.backbone, keys, "force_" + keys.force)},
            {"tangent", band_json(axis.tangent, keys, "stiffness_" + keys.stiffness)}};
  json["tangent_window_" + keys.displacement] = axis.tangent_window;
  json["responses"] = responses;
  put_joint(json, axis, keys);
  json["draws"] = axis.draws;
  return json;
}

FitParameter read_parameter(ObjectReader& r) {
  FitParameter p;
  p.name = r.text("name");
  p.unit = r.text("unit");
  p.value = number_or_null(r, "value");
  p.standard_error = number_or_null(r, "standard_error");
  std::tie(p.low, p.high) = read_ends(r, p.value);
  p.identified = r.boolean_or("identified", true);
  return p;
}

AxisFit read_axis(ObjectReader& r, Axis axis) {
  const FitKeys& keys = fit_keys_of(axis);
  AxisFit fit;
  fit.axis = axis;
  r.each("parameters", 0, [&](ObjectReader& p) { fit.parameters.push_back(read_parameter(p)); });
  if (const Json* covariance = r.raw("covariance"); covariance != nullptr && covariance->is_array()) {
    for (const Json& row : *covariance) fit.covariance.push_back(numbers(row));
  }
  fit.condition_number = number_or_null(r, "condition_number");
  fit.not_identified = r.texts_or_none("not_identified");
  r.object("solver", [&](ObjectReader& s) {
    fit.solver = {s.text("termination"),           s.count("iterations", 0),          number_or_null(s, "initial_cost"),
                  number_or_null(s, "final_cost"), number_or_null(s, "kkt_residual"), s.count("starts", 0)};
  });
  r.object("backbone", [&](ObjectReader& b) { fit.backbone = read_band(b, keys, "force_" + keys.force); });
  r.object("tangent", [&](ObjectReader& t) { fit.tangent = read_band(t, keys, "stiffness_" + keys.stiffness); });
  fit.tangent_window = number_or_null(r, "tangent_window_" + keys.displacement);
  r.each("responses", 0, [&](ObjectReader& p) { fit.responses.push_back(read_response(p, keys)); });
  r.each("selection", 0, [&](ObjectReader& c) { fit.selection.push_back(read_candidate(c)); });
  read_joint(r, fit, keys);
  fit.draws = r.count("draws", 0);
  return fit;
}

FitRecord read_record(ObjectReader& r) {
  FitRecord fit;
  fit.specimen = r.text("specimen");
  fit.synthetic = r.boolean_or("synthetic", false);
  fit.synthetic_note = r.text_or("synthetic_note", "");
  fit.calibration_residual = number_or_null(r, "calibration_residual");
  r.each("tests", 0, [&](ObjectReader& t) { fit.tests.push_back(read_test_fit(t)); });
  r.object("axes", [&](ObjectReader& axes) {
    for (int i = 0; i < k_num_axes; ++i) {
      const Axis axis = static_cast<Axis>(i);
      axes.optional_object(name_of(axis), [&](ObjectReader& a) { fit.axes.push_back(read_axis(a, axis)); });
    }
  });
  r.each("warnings", 0, [&](ObjectReader& w) {
    fit.warnings.push_back({w.text("code"), w.text_or("test", ""), w.text("text")});
  });
  r.each("corrections", 0, [&](ObjectReader& c) {
    fit.corrections.push_back({c.text("code"), c.text_or("test", ""), c.text("text")});
  });
  fit.provenance = read_provenance(r);
  return fit;
}

}  // namespace

FitRecord read_fit(const std::filesystem::path& file) {
  FitRecord fit;
  read_document(file, k_fit_format, [&](ObjectReader& reader) { fit = read_record(reader); });
  return fit;
}

void write_fit(const FitRecord& fit, const std::filesystem::path& file) {
  Json tests = Json::array(), axes = Json::object(), warnings = Json::array(), corrections = Json::array();
  for (const TestFit& test : fit.tests) tests.push_back(test_fit_json(test));
  for (const AxisFit& axis : fit.axes) axes[name_of(axis.axis)] = axis_json(axis);
  for (const FitWarning& w : fit.warnings) {
    warnings.push_back(Json{{"code", w.code}, {"test", w.test}, {"text", w.text}});
  }
  for (const AppliedCorrection& c : fit.corrections) {
    corrections.push_back(Json{{"code", c.code}, {"test", c.test}, {"text", c.text}});
  }
  write_whole(file, json_text(Json{{"format", k_fit_format},
                                   {"specimen", fit.specimen},
                                   {"synthetic", fit.synthetic},
                                   {"synthetic_note", fit.synthetic_note},
                                   {"calibration_residual", fit.calibration_residual},
                                   {"tests", tests},
                                   {"axes", axes},
                                   {"warnings", warnings},
                                   {"corrections", corrections},
                                   {"provenance", provenance_json(fit.provenance)}}));
}

}  // namespace grouser
