#include "model/rig.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <set>

#include "model/file_json.h"
#include "model/input_file.h"
#include "model/rig_columns.h"

namespace grouser {
namespace {

namespace d = dimension;
namespace fs = std::filesystem;

/// Unit in a column's name; a finding when it has none.
std::optional<Unit> unit_of_column(ObjectReader& r, const std::string& key, const std::string& column) {
  const auto split = split_name_and_unit(column);
  if (split) return split->unit;
  if (!column.empty()) r.report(key, "a column whose name ends in a unit, as lvdt_a_V", column);
  return std::nullopt;
}

/// `sensitivity_*` says what the sensor measures: one of two dimensions per volt (or per whatever the column holds).
void read_sensitivity(ObjectReader& r, RigSensor& sensor, const Dimension& straight, const Dimension& turning) {
  const auto key = split_name_and_unit(r.key_of("sensitivity"));
  const bool turns = key && key->unit.dimension == turning / sensor.reading.dimension;
  sensor.quantity = turns ? turning : straight;
  sensor.calibration.sensitivity = r.quantity("sensitivity", sensor.quantity / sensor.reading.dimension);
  const bool readable = key && key->unit.dimension == sensor.quantity / sensor.reading.dimension;
  if (readable && sensor.calibration.sensitivity == 0.0) {
    r.report(r.key_of("sensitivity"), "a sensitivity other than 0", "0");
  }
}

void read_calibration_record(ObjectReader& r, const std::vector<std::string>& names, RigSensor& sensor) {
  SensorCalibration& c = sensor.calibration;
  c.record_reading = r.quantities("reading", sensor.reading.dimension);
  std::string name = names.front();
  for (const std::string& candidate : names) {
    if (r.has_quantity(candidate)) name = candidate;
  }
  c.record_quantity = r.quantities(name, sensor.quantity);
  const bool readable = !c.record_quantity.empty() && !c.record_reading.empty();
  if (readable && c.record_quantity.size() != c.record_reading.size()) {
    r.report(r.key_of(name), std::to_string(c.record_reading.size()) + " values, one for each reading",
             std::to_string(c.record_quantity.size()));
  }
}

RigSensor read_sensor(ObjectReader& r, bool measures_force) {
  RigSensor sensor;
  SensorCalibration& c = sensor.calibration;
  c.column = r.text("column");
  sensor.reading = unit_of_column(r, "column", c.column).value_or(unit("V"));
  read_sensitivity(r, sensor, measures_force ? d::force : d::length, measures_force ? d::torque : d::angle);
  c.offset = r.quantity_or("offset", sensor.reading.dimension, 0.0);
  c.linearity = r.numbers_or_none("linearity");
  const std::vector<std::string> names =
      measures_force ? std::vector<std::string>{"force", "torque"} : std::vector<std::string>{"displacement", "angle"};
  r.optional_object("record", [&](ObjectReader& record) { read_calibration_record(record, names, sensor); });
  return sensor;
}

/// What the rig itself adds; beyond `most`, in SI units, it is no rig.
double read_of_rig(ObjectReader& r, const std::string& name, const Dimension& dimension, double most) {
  const double value = r.quantity_or(name, dimension, 0.0, Range::non_negative);
  if (value <= most) return value;
  r.report(r.key_of(name), "at most " + shown(Json(most)) + " " + usual_unit(dimension),
           shown(Json(value)) + " " + usual_unit(dimension));
  return 0.0;
}

/// Geometry is for people: any quantity, count or text.
void check_geometry(ObjectReader& r) {
  r.each_member([&](const std::string& key, const Json& value) {
    const bool right =
        value.is_string() || value.is_number_integer() || (value.is_number() && split_name_and_unit(key).has_value());
    if (!right) r.report(key, "a number with its unit in the key, a count or a text", shown(value));
  });
}

std::vector<CorrectionKind> read_corrections(ObjectReader& r) {
  std::vector<CorrectionKind> corrections;
  const std::vector<std::string> names(k_correction_names.begin(), k_correction_names.end());
  for (const std::size_t i : r.choices_or_none("corrections", names)) {
    corrections.push_back(static_cast<CorrectionKind>(i));
  }
  return corrections;
}

ThermalCorrection read_thermal(ObjectReader& r) {
  ThermalCorrection thermal;
  thermal.stiffness_change = r.quantity("stiffness_change", d::inverse_temperature);
  thermal.reference_temperature = r.quantity("reference_temperature", d::temperature);
  if (thermal.reference_temperature < 0.0) {
    const std::string key = r.key_of("reference_temperature");
    r.report(key, "a temperature above absolute zero", shown(*r.raw(key)));
  }
  return thermal;
}

/// `samples`: number a ramp, if the file says none.
constexpr int k_ramp_samples = 400;
/// Turns and samples a turn of a protocol: together 10 million samples, 10 h at 250 Hz.
constexpr long k_most_turns = 10'000, k_most_samples = 10'000'000;

/// Samples of all turns have a limit, too.
void check_amount(ObjectReader& r, const TestProtocol& protocol) {
  const long samples = static_cast<long>(protocol.turns) * protocol.samples_per_turn;
  if (samples > k_most_samples)
    r.report("", "at most " + std::to_string(k_most_samples) + " samples a test", std::to_string(samples));
}

TestProtocol read_static_protocol(ObjectReader& r, Axis axis) {
  TestProtocol protocol;
  const std::string name = is_rotation(axis) ? "to_torque" : "to_force";
  protocol.to_force = r.quantity(name, force_of(axis));
  if (r.has_quantity(name) && protocol.to_force == 0.0) r.report(r.key_of(name), "a load other than 0", "0");
  protocol.turns = r.count_or("ramps", 5, 1, k_most_turns);
  protocol.sample_rate = r.optional_quantity("sample_rate", d::frequency, Range::positive);
  if (protocol.sample_rate && r.has("samples")) {
    r.report("", "samples or sample_rate_Hz", "both");
  }
  const int samples = r.count_or("samples", k_ramp_samples, 2, k_most_samples);
  protocol.samples_per_turn = protocol.sample_rate ? 0 : samples;
  check_amount(r, protocol);
  return protocol;
}

TestProtocol read_cyclic_protocol(ObjectReader& r) {
  TestProtocol protocol;
  protocol.turns = r.count_or("cycles", 10, 1, k_most_turns);
  protocol.samples_per_turn = r.count_or("samples_per_cycle", 200, 2, k_most_samples);
  check_amount(r, protocol);
  return protocol;
}

/// What a protocol is driven at stands in the test itself, where it is optional for one that was measured.
void require_drive(ObjectReader& r, const RigTest& test) {
  const Dimension displacement = displacement_of(test.axis);
  const auto require = [&](const std::string& name, const Dimension& dimension) {
    if (!r.has_quantity(name)) {
      r.report("", "the key " + name + "_" + usual_unit(dimension) + ", which the protocol is driven at",
               "no such key");
    }
  };
  if (test.kind == TestKind::static_ramp) {
    require("rate", displacement / d::time);
  } else {
    require("amplitude", displacement);
    require("frequency", d::frequency);
  }
}

/// What was measured, or how it is to be driven: exactly one of `file` and `protocol`.
void read_source(ObjectReader& r, RigTest& test) {
  const bool driven = r.optional_object("protocol", [&](ObjectReader& p) {
    test.protocol = test.kind == TestKind::cyclic ? read_cyclic_protocol(p) : read_static_protocol(p, test.axis);
  });
  test.file = r.file_name_or_none("file");
  if (driven) require_drive(r, test);
  if (driven == r.has("file")) r.report("", "file or protocol", driven ? "both" : "neither");
}

void read_columns(ObjectReader& r, RigTestEntry& entry) {
  entry.sample_rate = r.optional_quantity("sample_rate", d::frequency, Range::positive);
  r.optional_object("columns", [&](ObjectReader& c) {
    entry.named.time = c.text_or("time", "");
    entry.named.displacement = c.text_or("displacement", c.text_or("angle", ""));
    entry.named.force = c.text_or("force", c.text_or("torque", ""));
    entry.named.temperature = c.text_or("temperature", "");
  });
  entry.test.corrections = read_corrections(r);
}

RigTestEntry read_test(ObjectReader& r) {
  RigTestEntry entry;
  RigTest& test = entry.test;
  entry.pointer = r.pointer();
  test.name = r.text("name");
  test.axis = r.choice<Axis>(
      "axis", {{"x", Axis::x}, {"y", Axis::y}, {"z", Axis::z}, {"rx", Axis::rx}, {"ry", Axis::ry}, {"rz", Axis::rz}});
  test.kind = r.choice<TestKind>("kind", {{"static", TestKind::static_ramp}, {"cyclic", TestKind::cyclic}});
  const Dimension displacement = displacement_of(test.axis);
  test.rate = r.optional_quantity("rate", displacement / d::time, Range::positive);
  test.frequency = r.optional_quantity("frequency", d::frequency, Range::positive);
  test.amplitude = r.optional_quantity("amplitude", displacement, Range::positive);
  test.preset = r.optional_quantity("preset", displacement);
  if (r.has("discard_cycles")) test.discard_cycles = r.count("discard_cycles", 0);
  read_source(r, test);
  if (!test.protocol) read_columns(r, entry);
  return entry;
}

/// Reads rig.json, then every CSV; collects the findings of all of them.
class RigReader {
 public:
  explicit RigReader(const fs::path& file) : file_(file), findings_(file.string()) { rig_.path = file; }

  RigRecord read() {
    const std::string bytes = read_whole(file_);
    rig_.provenance.version = program_version();
    rig_.provenance.inputs.push_back(provenance_input("rig", file_.string(), bytes));
    const Json document = parse_json(bytes, findings_);
    if (findings_.empty() || !document.is_null()) {
      read_document(document, k_rig_format, findings_, [this](ObjectReader& r) { read_own(r); });
    }
    for (RigTestEntry& entry : entries_) read_file(entry);
    findings_.throw_if_any();
    for (RigTestEntry& entry : entries_) rig_.tests.push_back(std::move(entry.test));
    for (RigSensor& s : sensors_.displacement) rig_.displacement_sensors.push_back(std::move(s.calibration));
    for (RigSensor& s : sensors_.force) {
      (s.quantity == d::torque ? rig_.torque_sensor : rig_.force_sensor) = std::move(s.calibration);
    }
    if (rig_.synthetic) rig_.provenance.synthetic.push_back(rig_.synthetic_note);
    return std::move(rig_);
  }

 private:
  void read_own(ObjectReader& reader) {
    reader.object("specimen", [this](ObjectReader& r) {
      rig_.specimen = r.text("name");
      rig_.bushings_in_series = r.count_or("bushings_in_series", 1, 1, 1000);
      r.optional_object("geometry", check_geometry);
    });
    rig_.rig_compliance = read_of_rig(reader, "rig_compliance", d::compliance, 1.0);
    rig_.rig_angular_compliance = read_of_rig(reader, "rig_angular_compliance", d::angular_compliance, 1.0);
    rig_.moving_mass = read_of_rig(reader, "moving_mass", d::mass, 1e6);
    rig_.moving_inertia = read_of_rig(reader, "moving_inertia", d::inertia, 1e6);
    reader.optional_object("thermal", [this](ObjectReader& r) { rig_.thermal = read_thermal(r); });
    rig_.synthetic = reader.optional_object("synthetic", [this](ObjectReader& r) { read_synthetic(r); });
    reader.optional_object("sensors", [this](ObjectReader& r) { read_sensors(r); });
    const std::vector<CorrectionKind> of_all = read_corrections(reader);
    reader.each("tests", 1, [this](ObjectReader& r) { entries_.push_back(read_test(r)); });
    for (RigTestEntry& entry : entries_) {
      std::set<CorrectionKind> asked(of_all.begin(), of_all.end());
      asked.insert(entry.test.corrections.begin(), entry.test.corrections.end());
      entry.test.corrections.assign(asked.begin(), asked.end());
    }
    check_names(reader);
  }

  void read_synthetic(ObjectReader& r) {
    rig_.synthetic_note = r.text("note");
    if (r.has("seed")) rig_.synthetic_note += ", seed " + std::to_string(r.integer("seed", 0));
    static_cast<void>(r.raw("truth"));  // what the generator started from; for people and for tests of the fit
  }

  void read_sensors(ObjectReader& reader) {
    reader.each_optional("displacement",
                         [this](ObjectReader& r) { sensors_.displacement.push_back(read_sensor(r, false)); });
    for (const char* const cell : {"force", "torque"}) {
      reader.optional_object(cell, [this](ObjectReader& r) { sensors_.force.push_back(read_sensor(r, true)); });
    }
    check_count(reader, sensors_.displacement, "displacement", d::length, 2);
    check_count(reader, sensors_.displacement, "displacement", d::angle, 2);
    check_count(reader, sensors_.force, "torque", d::force, 1);
    check_count(reader, sensors_.force, "torque", d::torque, 1);
  }

  static void check_count(ObjectReader& reader, const std::vector<RigSensor>& sensors, const char* key,
                          const Dimension& quantity, long most) {
    const auto found =
        std::count_if(sensors.begin(), sensors.end(), [&](const RigSensor& s) { return s.quantity == quantity; });
    if (found <= most) return;
    reader.report(key,
                  "at most " + std::to_string(most) + " that measure" + (most == 1 ? "s " : " ") + name_of(quantity),
                  std::to_string(found));
  }

  void check_names(ObjectReader& reader) {
    std::map<std::string, std::string> seen;
    for (const RigTestEntry& entry : entries_) {
      const auto [first, is_new] = seen.emplace(entry.test.name, entry.pointer);
      if (!is_new) {
        reader.findings().add(entry.pointer + "/name", "a name of its own", entry.test.name,
                              "also in " + first->second);
      }
    }
  }

  void read_file(RigTestEntry& entry) {
    if (entry.test.file.empty()) return;
    const fs::path named = fs::path(entry.test.file).lexically_normal();
    if (named.is_absolute() || *named.begin() == "..") {
      findings_.add(entry.pointer + "/file", "a file in the folder of the rig file, or below it", entry.test.file,
                    "a campaign is carried from machine to machine as one folder");
      return;
    }
    const fs::path path = (file_.parent_path() / named).lexically_normal();
    std::ifstream stream;
    try {
      stream = open_input(path);
    } catch (const FileError& error) {  // a name that is wrong; a read that fails later is the machine's fault
      findings_.add(entry.pointer + "/file", "a file that can be read", entry.test.file, error.what());
      return;
    }
    Findings of_file(path.string());
    const std::string digest = read_rig_columns(path, stream, sensors_, rig_.thermal, entry, of_file);
    rig_.provenance.inputs.push_back({"rig data " + entry.test.name, entry.test.file, digest});
    findings_.add(of_file);
  }

  fs::path file_;
  Findings findings_;
  RigRecord rig_;
  RigSensors sensors_;
  std::vector<RigTestEntry> entries_;
};

}  // namespace

RigRecord read_rig(const std::filesystem::path& file) { return RigReader(file).read(); }

}  // namespace grouser
