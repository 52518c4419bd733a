#include "model/rig.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "model/calibration.h"
#include "model/csv.h"
#include "model/file_json.h"

namespace grouser {
namespace {

namespace d = dimension;
namespace fs = std::filesystem;

/// A sensor with what its numbers mean.
struct Sensor {
  SensorCalibration calibration;
  Dimension quantity;  ///< what it measures: length, angle, force or torque
  Unit reading;        ///< of its column
};

/// Columns of one test as rig.json names them; empty = found by name.
struct NamedColumns {
  std::string time, displacement, force;
};

struct TestEntry {
  RigTest test;
  NamedColumns named;
  std::optional<double> sample_rate;
  std::string pointer;  ///< "/tests/3"
};

Dimension displacement_of(Axis axis) { return is_rotation(axis) ? d::angle : d::length; }
Dimension force_of(Axis axis) { return is_rotation(axis) ? d::torque : d::force; }

std::string list_of(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "none" : text;
}

/// Unit in a column's name; a finding when it has none.
std::optional<Unit> unit_of_column(ObjectReader& r, const std::string& key, const std::string& column) {
  const auto split = split_name_and_unit(column);
  if (split) return split->unit;
  if (!column.empty()) r.report(key, "a column whose name ends in a unit, as lvdt_a_V", column);
  return std::nullopt;
}

/// `sensitivity_*` says what the sensor measures: one of two dimensions per volt (or per whatever the column holds).
void read_sensitivity(ObjectReader& r, Sensor& sensor, const Dimension& straight, const Dimension& turning) {
  const auto key = split_name_and_unit(r.key_of("sensitivity"));
  const bool turns = key && key->unit.dimension == turning / sensor.reading.dimension;
  sensor.quantity = turns ? turning : straight;
  sensor.calibration.sensitivity = r.quantity("sensitivity", sensor.quantity / sensor.reading.dimension);
  const bool readable = key && key->unit.dimension == sensor.quantity / sensor.reading.dimension;
  if (readable && sensor.calibration.sensitivity == 0.0) {
    r.report(r.key_of("sensitivity"), "a sensitivity other than 0", "0");
  }
}

void read_calibration_record(ObjectReader& r, const std::vector<std::string>& names, Sensor& sensor) {
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

Sensor read_sensor(ObjectReader& r, bool measures_force) {
  Sensor sensor;
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

/// Geometry is for people: any quantity, count or text.
void check_geometry(ObjectReader& r) {
  r.each_member([&](const std::string& key, const Json& value) {
    const bool right =
        value.is_string() || value.is_number_integer() || (value.is_number() && split_name_and_unit(key).has_value());
    if (!right) r.report(key, "a number with its unit in the key, a count or a text", shown(value));
  });
}

TestEntry read_test(ObjectReader& r) {
  TestEntry entry;
  RigTest& test = entry.test;
  entry.pointer = r.pointer();
  test.name = r.text("name");
  test.axis = r.choice<Axis>(
      "axis", {{"x", Axis::x}, {"y", Axis::y}, {"z", Axis::z}, {"rx", Axis::rx}, {"ry", Axis::ry}, {"rz", Axis::rz}});
  test.kind = r.choice<TestKind>("kind", {{"static", TestKind::static_ramp}, {"cyclic", TestKind::cyclic}});
  test.file = r.text("file");
  const Dimension displacement = displacement_of(test.axis);
  test.rate = r.optional_quantity("rate", displacement / d::time, Range::positive);
  test.frequency = r.optional_quantity("frequency", d::frequency, Range::positive);
  test.amplitude = r.optional_quantity("amplitude", displacement, Range::positive);
  test.preset = r.optional_quantity("preset", displacement);
  entry.sample_rate = r.optional_quantity("sample_rate", d::frequency, Range::positive);
  if (r.has("discard_cycles")) test.discard_cycles = static_cast<int>(r.integer("discard_cycles", 0));
  r.optional_object("columns", [&](ObjectReader& c) {
    entry.named.time = c.text_or("time", "");
    entry.named.displacement = c.text_or("displacement", c.text_or("angle", ""));
    entry.named.force = c.text_or("force", c.text_or("torque", ""));
  });
  return entry;
}

/// Finds, reads and converts the columns of one test's CSV file.
class TestFile {
 public:
  TestFile(const std::string& bytes, const std::vector<Sensor>& displacement_sensors,
           const std::optional<Sensor>& force_sensor, Findings& findings)
      : bytes_(bytes),
        names_(csv_header(bytes)),
        displacement_sensors_(displacement_sensors),
        force_sensor_(force_sensor),
        findings_(findings) {}

  void read(TestEntry& entry) {
    RigTest& test = entry.test;
    const std::vector<Sensor> lvdts = sensors_for(displacement_of(test.axis));
    const bool load_cell = force_sensor_ && applies(*force_sensor_, force_of(test.axis));
    const std::string time = find_time(entry.named.time);
    std::vector<std::string> displacement, force;
    if (lvdts.empty() || !entry.named.displacement.empty()) {
      displacement = {find(entry.named.displacement, {"displacement", "angle"}, displacement_of(test.axis))};
    } else {
      for (const Sensor& lvdt : lvdts) displacement.push_back(lvdt.calibration.column);
    }
    const bool calibrated_force = load_cell && entry.named.force.empty();
    force = {calibrated_force ? force_sensor_->calibration.column
                              : find(entry.named.force, {"force", "torque"}, force_of(test.axis))};
    if (!findings_.empty()) return;

    std::vector<std::string> wanted = displacement;
    wanted.push_back(force.front());
    if (!time.empty()) wanted.push_back(time);
    std::vector<CsvColumn> columns = read_csv(bytes_, wanted, findings_);
    if (!findings_.empty()) return;
    const bool from_sensors = !lvdts.empty() && entry.named.displacement.empty();
    set_displacement(test, columns, from_sensors ? lvdts : std::vector<Sensor>{});
    CsvColumn& forces = columns[displacement.size()];
    test.force = converted(forces, calibrated_force ? &*force_sensor_ : nullptr);
    set_time(entry, time.empty() ? nullptr : &columns.back());
  }

 private:
  [[nodiscard]] bool has(const std::string& column) const {
    return std::find(names_.begin(), names_.end(), column) != names_.end();
  }
  [[nodiscard]] bool applies(const Sensor& sensor, const Dimension& quantity) const {
    return sensor.quantity == quantity && has(sensor.calibration.column);
  }

  /// Sensors of that quantity whose columns the file has: all of them or none.
  std::vector<Sensor> sensors_for(const Dimension& quantity) {
    std::vector<Sensor> found;
    std::string missing;
    for (const Sensor& sensor : displacement_sensors_) {
      if (sensor.quantity != quantity) continue;
      if (applies(sensor, quantity)) {
        found.push_back(sensor);
      } else {
        missing = sensor.calibration.column;
      }
    }
    if (!found.empty() && !missing.empty()) {
      findings_.add("row 1", "the column " + missing + " of a sensor in rig.json", list_of(names_),
                    did_you_mean(nearest_word(missing, names_)));
    }
    return found;
  }

  std::string find_time(const std::string& named) {
    if (!named.empty()) return find(named, {"time"}, d::time);
    const bool any = std::any_of(names_.begin(), names_.end(), [](const std::string& name) {
      const auto split = split_name_and_unit(name);
      return split && (split->name == "time" || split->name.rfind("time_", 0) == 0);
    });
    return any ? find("", {"time"}, d::time) : "";
  }

  /// The named column; else the one of a family ("displacement_*"); else the only one of that dimension.
  std::string find(const std::string& named, const std::vector<std::string>& families, const Dimension& dimension) {
    if (!named.empty()) return named_column(named, dimension);
    std::vector<std::string> of_family, of_dimension;
    for (const std::string& name : names_) {
      const auto split = split_name_and_unit(name);
      if (!split) continue;
      const bool member = std::any_of(families.begin(), families.end(), [&](const std::string& family) {
        return split->name == family || split->name.rfind(family + "_", 0) == 0;
      });
      if (member) of_family.push_back(name);
      if (split->unit.dimension == dimension) of_dimension.push_back(name);
    }
    std::string expected = "a column " + list_of_families(families) + " with a unit of " + name_of(dimension);
    const std::vector<std::string>& candidates = of_family.empty() ? of_dimension : of_family;
    if (candidates.size() == 1) return named_column(candidates.front(), dimension);
    if (candidates.empty()) {
      findings_.add("row 1", expected, list_of(names_), "rig.json may name it under \"columns\"");
    } else {
      findings_.add("row 1", expected, list_of(candidates), "rig.json must name one of them under \"columns\"");
    }
    return {};
  }

  static std::string list_of_families(const std::vector<std::string>& families) {
    std::string text;
    for (const std::string& family : families) text += (text.empty() ? "" : " or ") + family + "_*";
    return text;
  }

  std::string named_column(const std::string& name, const Dimension& dimension) {
    const auto split = split_name_and_unit(name);
    if (!has(name)) {
      findings_.add("row 1", "the column " + name, list_of(names_), did_you_mean(nearest_word(name, names_)));
    } else if (!split || split->unit.dimension != dimension) {
      findings_.add("row 1, column " + name, "a unit of " + name_of(dimension) + ", as in _" + usual_unit(dimension),
                    split ? "a unit of " + name_of(split->unit.dimension) : "no unit");
    }
    return name;
  }

  static std::vector<double> converted(CsvColumn& column, const Sensor* sensor) {
    const Unit unit = split_name_and_unit(column.name)->unit;
    for (double& value : column.values) {
      value = unit.to_si(value);
      if (sensor != nullptr) value = calibrated(sensor->calibration, value);
    }
    return std::move(column.values);
  }

  static void set_displacement(RigTest& test, std::vector<CsvColumn>& columns, const std::vector<Sensor>& lvdts) {
    test.displacement = converted(columns[0], lvdts.empty() ? nullptr : &lvdts[0]);
    if (lvdts.size() < 2) return;
    // Two LVDTs, left and right of the specimen: the mean is the stretch, half the difference the tilt (D 6.2).
    const std::vector<double> second = converted(columns[1], &lvdts[1]);
    test.tilt.resize(second.size());
    for (std::size_t i = 0; i < second.size(); ++i) {
      test.tilt[i] = 0.5 * (test.displacement[i] - second[i]);
      test.displacement[i] = 0.5 * (test.displacement[i] + second[i]);
    }
  }

  void set_time(TestEntry& entry, CsvColumn* column) {
    RigTest& test = entry.test;
    if (column != nullptr) {
      test.time = converted(*column, nullptr);
      test.time_measured = true;
      const auto stop = std::adjacent_find(test.time.begin(), test.time.end(), std::greater_equal<>());
      if (stop != test.time.end()) {
        findings_.add("column " + column->name + ", sample " + std::to_string(stop - test.time.begin() + 2),
                      "a time after the one before it",
                      Json(*(stop + 1)).dump() + " s after " + Json(*stop).dump() + " s");
      }
      return;
    }
    test.time.resize(test.displacement.size());
    for (std::size_t i = 0; i < test.time.size(); ++i) {
      const auto index = static_cast<double>(i);
      const bool ramp = test.kind == TestKind::static_ramp && test.rate.has_value();
      if (entry.sample_rate) {
        test.time[i] = index / *entry.sample_rate;
      } else if (ramp) {
        test.time[i] =
            i == 0 ? 0.0 : test.time[i - 1] + std::abs(test.displacement[i] - test.displacement[i - 1]) / *test.rate;
      } else {
        test.time[i] = index;
      }
    }
  }

  const std::string& bytes_;
  std::vector<std::string> names_;
  const std::vector<Sensor>& displacement_sensors_;
  const std::optional<Sensor>& force_sensor_;
  Findings& findings_;
};

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
    for (TestEntry& entry : entries_) read_file(entry);
    findings_.throw_if_any();
    for (TestEntry& entry : entries_) rig_.tests.push_back(std::move(entry.test));
    for (Sensor& sensor : displacement_sensors_) rig_.displacement_sensors.push_back(std::move(sensor.calibration));
    if (force_sensor_) rig_.force_sensor = std::move(force_sensor_->calibration);
    if (rig_.synthetic) rig_.provenance.synthetic.push_back(rig_.synthetic_note);
    return std::move(rig_);
  }

 private:
  void read_own(ObjectReader& reader) {
    reader.object("specimen", [this](ObjectReader& r) {
      rig_.specimen = r.text("name");
      rig_.bushings_in_series = static_cast<int>(r.integer_or("bushings_in_series", 1, 1));
      r.optional_object("geometry", check_geometry);
    });
    rig_.rig_compliance = reader.quantity_or("rig_compliance", d::compliance, 0.0, Range::non_negative);
    rig_.synthetic = reader.optional_object("synthetic", [this](ObjectReader& r) { read_synthetic(r); });
    reader.optional_object("sensors", [this](ObjectReader& r) { read_sensors(r); });
    reader.each("tests", 1, [this](ObjectReader& r) { entries_.push_back(read_test(r)); });
    check_names(reader);
  }

  void read_synthetic(ObjectReader& r) {
    rig_.synthetic_note = r.text("note");
    if (r.has("seed")) rig_.synthetic_note += ", seed " + std::to_string(r.integer("seed", 0));
    static_cast<void>(r.raw("truth"));  // what the generator started from; for people and for tests of the fit
  }

  void read_sensors(ObjectReader& reader) {
    reader.each_optional("displacement",
                         [this](ObjectReader& r) { displacement_sensors_.push_back(read_sensor(r, false)); });
    reader.optional_object("force", [this](ObjectReader& r) { force_sensor_ = read_sensor(r, true); });
    const auto lvdts = std::count_if(displacement_sensors_.begin(), displacement_sensors_.end(),
                                     [](const Sensor& s) { return s.quantity == d::length; });
    if (lvdts > 2) reader.report("displacement", "one or two LVDTs", std::to_string(lvdts));
  }

  void check_names(ObjectReader& reader) {
    std::map<std::string, std::string> seen;
    for (const TestEntry& entry : entries_) {
      const auto [first, is_new] = seen.emplace(entry.test.name, entry.pointer);
      if (!is_new) {
        reader.findings().add(entry.pointer + "/name", "a name of its own", entry.test.name,
                              "also in " + first->second);
      }
    }
  }

  void read_file(TestEntry& entry) {
    if (entry.test.file.empty()) return;
    const fs::path path = (file_.parent_path() / entry.test.file).lexically_normal();
    std::string bytes;
    try {
      bytes = read_whole(path);
    } catch (const FileError& error) {
      findings_.add(entry.pointer + "/file", "a file that can be read", entry.test.file, error.what());
      return;
    }
    rig_.provenance.inputs.push_back(provenance_input("rig data " + entry.test.name, entry.test.file, bytes));
    Findings of_file(path.string());
    TestFile(bytes, displacement_sensors_, force_sensor_, of_file).read(entry);
    findings_.add(of_file);
  }

  fs::path file_;
  Findings findings_;
  RigRecord rig_;
  std::vector<Sensor> displacement_sensors_;
  std::optional<Sensor> force_sensor_;
  std::vector<TestEntry> entries_;
};

}  // namespace

RigRecord read_rig(const std::filesystem::path& file) { return RigReader(file).read(); }

}  // namespace grouser
