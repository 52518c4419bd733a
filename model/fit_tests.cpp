#include <limits>

#include "model/file_json.h"
#include "model/fit_keys.h"

/// Entries of `tests[]`.
namespace grouser {

const FitKeys& fit_keys_of(Axis axis) {
  static const FitKeys translation{"m", "N", "N_per_m", "N_s_per_m"};
  static const FitKeys rotation{"rad", "N_m", "N_m_per_rad", "N_m_s_per_rad"};
  return is_rotation(axis) ? rotation : translation;
}

double number_or_null(ObjectReader& r, const std::string& key) {
  const Json* value = r.raw(key);
  return value != nullptr && value->is_null() ? std::numeric_limits<double>::quiet_NaN() : r.number(key);
}

std::vector<double> numbers(const Json& array) {
  std::vector<double> values;
  for (const Json& item : array) {
    values.push_back(item.is_number() ? item.get<double>() : std::numeric_limits<double>::quiet_NaN());
  }
  return values;
}

std::vector<double> numbers_or_nulls(ObjectReader& r, const std::string& key) {
  const Json* value = r.raw(key);
  if (value != nullptr && value->is_array()) return numbers(*value);
  r.report(key, "an array of numbers", value == nullptr ? "no such key" : shown(*value));
  return {};
}

namespace {

void put_measures(Json& object, const LoopMeasures& measures, const FitKeys& keys) {
  object["effective_stiffness_" + keys.stiffness] = measures.effective_stiffness;
  object["dissipated_energy_J"] = measures.dissipated_energy;
  object["equivalent_damping_" + keys.damping] = measures.equivalent_damping;
  object["loss_factor"] = measures.loss_factor;
  object["secant_stiffness_" + keys.stiffness] = measures.secant_stiffness;
  object["storage_stiffness_" + keys.stiffness] = measures.storage_stiffness;
  object["loss_stiffness_" + keys.stiffness] = measures.loss_stiffness;
}

Json measures_json(const LoopMeasures& measures, const FitKeys& keys) {
  Json object = Json::object();
  put_measures(object, measures, keys);
  return object;
}

LoopMeasures read_measures(ObjectReader& r, const FitKeys& keys) {
  return {number_or_null(r, "effective_stiffness_" + keys.stiffness),
          number_or_null(r, "dissipated_energy_J"),
          number_or_null(r, "equivalent_damping_" + keys.damping),
          number_or_null(r, "loss_factor"),
          number_or_null(r, "secant_stiffness_" + keys.stiffness),
          number_or_null(r, "storage_stiffness_" + keys.stiffness),
          number_or_null(r, "loss_stiffness_" + keys.stiffness)};
}

Json cycle_json(const CycleFit& cycle, const FitKeys& keys, bool prediction) {
  Json json{{"index", cycle.index}, {"used", cycle.used}, {"note", cycle.note}};
  json["amplitude_" + keys.displacement] = cycle.amplitude;
  if (!prediction) {
    put_measures(json, cycle.measured, keys);
    json["nrmse"] = cycle.nrmse;
  }
  json["fitted"] = measures_json(cycle.fitted, keys);
  return json;
}

CycleFit read_cycle(ObjectReader& r, const FitKeys& keys, bool prediction) {
  CycleFit cycle;
  cycle.index = r.count("index", 0);
  cycle.used = r.boolean_or("used", false);
  cycle.note = r.text_or("note", "");
  cycle.amplitude = number_or_null(r, "amplitude_" + keys.displacement);
  if (!prediction) {
    cycle.measured = read_measures(r, keys);
    cycle.nrmse = number_or_null(r, "nrmse");
  }
  r.object("fitted", [&](ObjectReader& f) { cycle.fitted = read_measures(f, keys); });
  return cycle;
}

/// What a test says of the measurement and of the law's distance from it.
void put_comparison(Json& json, const TestFit& test, const FitKeys& keys) {
  put_measures(json, test.measured, keys);
  json["nrmse"] = test.nrmse;
  json["r_squared"] = test.r_squared;
  json["gain"] = test.gain;
  json["weight"] = test.weight;
  json["force_zero_" + keys.force] = test.force_zero;
  json["force_drift_" + keys.force] = test.force_drift;
  json["left_out_nrmse"] = test.left_out_nrmse;
}

void read_comparison(ObjectReader& r, TestFit& test, const FitKeys& keys) {
  test.measured = read_measures(r, keys);
  test.nrmse = number_or_null(r, "nrmse");
  test.r_squared = number_or_null(r, "r_squared");
  test.gain = number_or_null(r, "gain");
  test.weight = number_or_null(r, "weight");
  test.force_zero = number_or_null(r, "force_zero_" + keys.force);
  test.force_drift = number_or_null(r, "force_drift_" + keys.force);
  test.left_out_nrmse = number_or_null(r, "left_out_nrmse");
}

}  // namespace

Json test_fit_json(const TestFit& test) {
  const FitKeys& keys = fit_keys_of(test.axis);
  Json json{{"name", test.name},
            {"axis", name_of(test.axis)},
            {"kind", test.kind == TestKind::cyclic ? "cyclic" : "static"},
            {"samples", test.samples},
            {"cycles", test.cycles},
            {"cycles_used", test.cycles_used},
            {"frequency_Hz", test.frequency}};
  json["amplitude_" + keys.displacement] = test.amplitude;
  if (test.prediction) {
    json["prediction"] = true;
  } else {
    put_comparison(json, test, keys);
  }
  json["fitted"] = measures_json(test.fitted, keys);
  json["per_cycle"] = Json::array();
  for (const CycleFit& cycle : test.per_cycle) json["per_cycle"].push_back(cycle_json(cycle, keys, test.prediction));
  Json& curve = json["curve"] = Json{{"displacement_" + keys.displacement, test.curve.displacement}};
  if (!test.prediction) curve["force_" + keys.force] = test.curve.force;
  curve["fitted_" + keys.force] = test.curve.fitted;
  return json;
}

namespace {

Axis read_axis_name(ObjectReader& r) {
  return r.choice<Axis>(
      "axis", {{"x", Axis::x}, {"y", Axis::y}, {"z", Axis::z}, {"rx", Axis::rx}, {"ry", Axis::ry}, {"rz", Axis::rz}});
}

}  // namespace

TestFit read_test_fit(ObjectReader& r) {
  TestFit test;
  test.name = r.text("name");
  test.axis = read_axis_name(r);
  const FitKeys& keys = fit_keys_of(test.axis);
  test.kind = r.choice<TestKind>("kind", {{"static", TestKind::static_ramp}, {"cyclic", TestKind::cyclic}});
  test.samples = r.integer("samples", 0);
  test.cycles = r.count("cycles", 0);
  test.cycles_used = r.count("cycles_used", 0);
  test.frequency = number_or_null(r, "frequency_Hz");
  test.amplitude = number_or_null(r, "amplitude_" + keys.displacement);
  test.prediction = r.boolean_or("prediction", false);
  if (!test.prediction) read_comparison(r, test, keys);
  r.object("fitted", [&](ObjectReader& f) { test.fitted = read_measures(f, keys); });
  r.each("per_cycle", 0, [&](ObjectReader& c) { test.per_cycle.push_back(read_cycle(c, keys, test.prediction)); });
  r.optional_object("curve", [&](ObjectReader& c) {
    test.curve.displacement = numbers_or_nulls(c, "displacement_" + keys.displacement);
    if (!test.prediction) test.curve.force = numbers_or_nulls(c, "force_" + keys.force);
    test.curve.fitted = numbers_or_nulls(c, "fitted_" + keys.force);
    const std::size_t size = test.curve.displacement.size();
    if (test.curve.fitted.size() != size || (!test.prediction && test.curve.force.size() != size)) {
      c.report("", "arrays of one length", "different lengths");
    }
  });
  return test;
}

}  // namespace grouser
