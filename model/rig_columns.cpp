#include "model/rig_columns.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <utility>

#include "model/calibration.h"
#include "model/csv.h"
#include "model/input_file.h"

namespace grouser {
namespace {

namespace d = dimension;

/// Of the steps of a time column, so many may stand still or fall back: restarts of the logger and rounded stamps do
/// that now and then; a column that does it more often counts something else.
constexpr double k_time_faults = 0.01;

/// A quantity's columns and the sensors that calibrate them (empty: the columns hold the quantity itself).
struct Channel {
  std::vector<std::string> columns;
  std::vector<const RigSensor*> sensors;
};

struct Channels {
  Channel displacement, force;
  std::string time, temperature;  ///< empty: the file has none
};

std::string list_of(const std::vector<std::string>& names, const char* between = ", ", const char* after = "") {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : between) + name + after;
  return text.empty() ? "none" : text;
}

/// For messages; six digits say enough.
std::string short_number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

/// "force_*" holds force_kN, force_a_kN and Force_kN.
bool is_member(const std::string& name, const std::string& family) {
  std::string start = name.substr(0, family.size());
  for (char& c : start) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return start == family && (name.size() == family.size() || name[family.size()] == '_');
}

/// Finds the columns of one file by their names.
class ColumnFinder {
 public:
  ColumnFinder(const CsvReader& table, Findings& findings)
      : names_(table.names()), place_(table.place_of_names()), findings_(findings) {}

  [[nodiscard]] Channels find(const RigTestEntry& entry, const RigSensors& sensors, bool needs_temperature) {
    const Axis axis = entry.test.axis;
    Channels channels;
    channels.time = find_optional(entry.named.time, "time", d::time);
    channels.displacement =
        channel(entry.named.displacement, {"displacement", "angle"}, sensors.displacement, displacement_of(axis));
    channels.force = channel(entry.named.force, {"force", "torque"}, sensors.force, force_of(axis));
    channels.temperature = needs_temperature ? find_column(entry.named.temperature, {"temperature"}, d::temperature,
                                                           ", which \"thermal\" in rig.json needs")
                                             : find_temperature(entry.named.temperature);
    return channels;
  }

 private:
  [[nodiscard]] bool has(const std::string& column) const {
    return std::find(names_.begin(), names_.end(), column) != names_.end();
  }

  /// A column that rig.json names goes before the sensors, and they before columns found by name.
  Channel channel(const std::string& named, const std::vector<std::string>& families,
                  const std::vector<RigSensor>& sensors, const Dimension& quantity) {
    Channel found;
    if (named.empty()) found.sensors = sensors_for(sensors, quantity);
    for (const RigSensor* sensor : found.sensors) found.columns.push_back(sensor->calibration.column);
    if (found.sensors.empty()) found.columns.push_back(find_column(named, families, quantity));
    return found;
  }

  /// Sensors of that quantity whose columns the file has: all of them or none.
  std::vector<const RigSensor*> sensors_for(const std::vector<RigSensor>& sensors, const Dimension& quantity) {
    std::vector<const RigSensor*> found;
    std::string missing;
    for (const RigSensor& sensor : sensors) {
      if (sensor.quantity != quantity) continue;
      if (has(sensor.calibration.column)) {
        found.push_back(&sensor);
      } else {
        missing = sensor.calibration.column;
      }
    }
    if (!found.empty() && !missing.empty()) {
      findings_.add(place_, "the column " + missing + " of a sensor in rig.json", list_of(names_),
                    did_you_mean(nearest_word(missing, names_)));
    }
    return found;
  }

  /// Columns of a family ("displacement_*"), else all of that dimension.
  [[nodiscard]] std::vector<std::string> candidates_for(const std::vector<std::string>& families,
                                                        const Dimension& dimension) const {
    std::vector<std::string> of_family, of_dimension;
    for (const std::string& name : names_) {
      const auto split = split_name_and_unit(name);
      if (!split) continue;
      const auto is_of = [&](const std::string& family) { return is_member(split->name, family); };
      if (std::any_of(families.begin(), families.end(), is_of)) of_family.push_back(name);
      if (split->unit.dimension == dimension) of_dimension.push_back(name);
    }
    return of_family.empty() ? of_dimension : of_family;
  }

  /// "force [kp]": the column of a family whose unit stands there and is not known; empty when there is none.
  [[nodiscard]] std::string with_unknown_unit(const std::vector<std::string>& families) const {
    for (const std::string& name : names_) {
      const std::string bare = name.substr(0, name.find_first_of(" [("));
      const auto is_of = [&](const std::string& family) { return is_member(bare, family); };
      const bool bracketed = !name.empty() && (name.back() == ']' || name.back() == ')');
      if (bracketed && std::any_of(families.begin(), families.end(), is_of)) return name;
    }
    return {};
  }

  /// Empty where the file has no such column and rig.json names none.
  std::string find_optional(const std::string& named, const std::string& family, const Dimension& dimension) {
    if (named.empty() && candidates_for({family}, dimension).empty()) return {};
    return find_column(named, {family}, dimension);
  }

  /// A temperature that nothing needs is kept where it is plain which one it is.
  std::string find_temperature(const std::string& named) {
    if (named.empty() && candidates_for({"temperature"}, d::temperature).size() != 1) return {};
    return find_optional(named, "temperature", d::temperature);
  }

  /// The named column, else the only candidate.
  std::string find_column(const std::string& named, const std::vector<std::string>& families,
                          const Dimension& dimension, const char* reason = "") {
    if (!named.empty()) return checked(named, dimension);
    const std::vector<std::string> candidates = candidates_for(families, dimension);
    if (candidates.size() == 1) return checked(candidates.front(), dimension);
    if (const std::string strange = with_unknown_unit(families); !strange.empty()) {
      findings_.add(place_ + ", column " + strange,
                    "a unit of " + name_of(dimension) + ", as in _" + usual_unit(dimension), "one that nobody knows");
      return {};
    }
    const std::string expected =
        "a column " + list_of(families, " or ", "_*") + " with a unit of " + name_of(dimension) + reason;
    if (candidates.empty()) {
      findings_.add(place_, expected, list_of(names_), "rig.json may name it under \"columns\"");
    } else {
      findings_.add(place_, expected, list_of(candidates), "rig.json must name one of them under \"columns\"");
    }
    return {};
  }

  std::string checked(const std::string& name, const Dimension& dimension) {
    const auto split = split_name_and_unit(name);
    if (!has(name)) {
      findings_.add(place_, "the column " + name, list_of(names_), did_you_mean(nearest_word(name, names_)));
    } else if (!split || split->unit.dimension != dimension) {
      findings_.add(place_ + ", column " + name,
                    "a unit of " + name_of(dimension) + ", as in _" + usual_unit(dimension),
                    split ? "a unit of " + name_of(split->unit.dimension) : "no unit");
    }
    return name;
  }

  const std::vector<std::string>& names_;
  std::string place_;
  Findings& findings_;
};

/// In SI units. What leaves the range of numbers there is a finding, the first of the column, and becomes 0.
std::vector<double> converted(CsvColumn& column, Findings& findings, const RigSensor* sensor = nullptr) {
  constexpr double k_largest = 1e300;  // the sum of two is a number, too
  const Unit unit = split_name_and_unit(column.name)->unit;
  bool told = false;
  for (std::size_t i = 0; i < column.values.size(); ++i) {
    double& value = column.values[i];
    const double raw = value;
    value = unit.to_si(raw);
    if (sensor != nullptr) value = calibrated(sensor->calibration, value);
    if (std::abs(value) <= k_largest) continue;
    if (!std::exchange(told, true))
      findings.add("column " + column.name + ", sample " + std::to_string(i + 1),
                   "at most 1e300 in SI units, by unit and calibration", short_number(raw));
    value = 0.0;
  }
  return std::move(column.values);
}

const RigSensor* sensor_of(const Channel& channel, std::size_t column) {
  return channel.sensors.empty() ? nullptr : channel.sensors[column];
}

/// Two LVDTs, left and right of the specimen: the mean is the stretch, half the difference the tilt.
void average(RigTest& test, std::vector<double> second) {
  for (std::size_t i = 0; i < second.size(); ++i) {
    const double first = test.displacement[i];
    test.displacement[i] = 0.5 * (first + second[i]);
    second[i] = 0.5 * (first - second[i]);
  }
  test.tilt = std::move(second);
}

bool is_asked_for(const RigTest& test, CorrectionKind kind) {
  return std::find(test.corrections.begin(), test.corrections.end(), kind) != test.corrections.end();
}

/// Whoever mixed up the plugs gave each signal the other's name, unit and calibration: the raw numbers change places.
void swap_columns(const Channels& channels, std::vector<CsvColumn>& columns, Findings& findings) {
  if (channels.displacement.columns.size() > 1) {
    findings.add("", "one column of displacement, for swap_columns to put the force there",
                 list_of(channels.displacement.columns));
    return;
  }
  std::swap(columns[0].values, columns[1].values);
}

/// A jump back is a fact about the record that identification reports; a column that is no time is refused.
void check_time(const std::vector<double>& time, const std::string& column, Findings& findings) {
  std::size_t faults = 0, first = 0;
  for (std::size_t i = 1; i < time.size(); ++i) {
    if (time[i] > time[i - 1]) continue;
    if (faults++ == 0) first = i;
  }
  const double allowed = std::max(1.0, k_time_faults * static_cast<double>(time.size()));
  if (static_cast<double>(faults) <= allowed) return;
  findings.add("column " + column + ", sample " + std::to_string(first + 1),
               "a time that goes on from sample to sample",
               short_number(time[first]) + " s after " + short_number(time[first - 1]) + " s; " +
                   std::to_string(faults) + " of " + std::to_string(time.size() - 1) + " steps do not go on");
}

/// Times of a file without any: from the sample rate, else of a ramp from its rate, else the sample's number.
void build_time(RigTestEntry& entry) {
  RigTest& test = entry.test;
  const std::vector<double>& x = test.displacement;
  test.time.resize(x.size());
  const bool ramp = test.kind == TestKind::static_ramp && test.rate.has_value();
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (entry.sample_rate) {
      test.time[i] = static_cast<double>(i) / *entry.sample_rate;
    } else if (ramp) {
      test.time[i] = i == 0 ? 0.0 : test.time[i - 1] + std::abs(x[i] - x[i - 1]) / *test.rate;
    } else {
      test.time[i] = static_cast<double>(i);
    }
  }
}

/// The correction divides by the stiffness left at a temperature, relative to that at the reference.
void check_temperature(const std::vector<double>& temperature, const std::string& column,
                       const std::optional<ThermalCorrection>& thermal, Findings& findings) {
  for (std::size_t i = 0; i < temperature.size(); ++i) {
    const std::string place = "column " + column + ", sample " + std::to_string(i + 1);
    if (!(temperature[i] > 0.0)) {
      findings.add(place, "a temperature above absolute zero", short_number(temperature[i]) + " K");
      return;
    }
    if (!thermal) continue;
    const double stiffness = 1.0 + thermal->stiffness_change * (temperature[i] - thermal->reference_temperature);
    if (!(stiffness > 0.0)) {
      findings.add(place, "a temperature at which \"thermal\" of rig.json leaves some stiffness",
                   short_number(temperature[i]) + " K, where it leaves " + short_number(stiffness));
      return;
    }
  }
}

}  // namespace

std::string read_rig_columns(const std::filesystem::path& file, std::ifstream& stream, const RigSensors& sensors,
                             const std::optional<ThermalCorrection>& thermal, RigTestEntry& entry, Findings& findings) {
  CsvReader table(stream, findings);
  require_sound(stream, file);
  if (!findings.empty()) return {};
  const Channels channels = ColumnFinder(table, findings).find(entry, sensors, thermal.has_value());
  if (!findings.empty()) return {};

  std::vector<std::string> wanted{channels.displacement.columns.front(), channels.force.columns.front()};
  if (!channels.time.empty()) wanted.push_back(channels.time);
  if (!channels.temperature.empty()) wanted.push_back(channels.temperature);
  const bool two = channels.displacement.columns.size() > 1;
  if (two) wanted.push_back(channels.displacement.columns[1]);
  std::vector<CsvColumn> columns = table.read(wanted);
  require_sound(stream, file);
  RigTest& test = entry.test;
  if (findings.empty() && is_asked_for(test, CorrectionKind::swap_columns)) swap_columns(channels, columns, findings);
  if (!findings.empty()) return {};

  test.displacement = converted(columns[0], findings, sensor_of(channels.displacement, 0));
  test.force = converted(columns[1], findings, sensor_of(channels.force, 0));
  if (two) average(test, converted(columns.back(), findings, sensor_of(channels.displacement, 1)));
  test.time_measured = !channels.time.empty();
  if (test.time_measured) {
    test.time = converted(columns[2], findings);
    check_time(test.time, channels.time, findings);
  } else {
    build_time(entry);
  }
  if (!channels.temperature.empty()) {
    test.temperature = converted(columns[test.time_measured ? 3 : 2], findings);
    check_temperature(test.temperature, channels.temperature, thermal, findings);
  }
  return table.sha256();
}

}  // namespace grouser
