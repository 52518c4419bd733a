#pragma once
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "model/findings.h"
#include "model/rig.h"
#include "model/units.h"

/// From the columns of one test's CSV file to calibrated SI signals.
namespace grouser {

/// A sensor with what its numbers mean.
struct RigSensor {
  SensorCalibration calibration;
  Dimension quantity;  ///< what it measures: length, angle, force or torque
  Unit reading;        ///< of its column
};

struct RigSensors {
  std::vector<RigSensor> displacement;
  std::vector<RigSensor> force;
};

/// Columns of one test as rig.json names them; empty = found by name.
struct NamedColumns {
  std::string time, displacement, force, temperature;
};

/// One entry of `tests`.
struct RigTestEntry {
  RigTest test;
  NamedColumns named;
  std::optional<double> sample_rate;  ///< Hz
  std::string pointer;                ///< "/tests/3"
};

[[nodiscard]] inline Dimension displacement_of(Axis axis) {
  return is_rotation(axis) ? dimension::angle : dimension::length;
}
[[nodiscard]] inline Dimension force_of(Axis axis) { return is_rotation(axis) ? dimension::torque : dimension::force; }

/// Fills the signals of `entry.test` from its file, open as `stream`, and returns the SHA-256 of the file's bytes. What
/// is wrong with the file is noted in `findings`. With `thermal`, a temperature column must be there. Throws FileError
/// when a read fails.
std::string read_rig_columns(const std::filesystem::path& file, std::ifstream& stream, const RigSensors& sensors,
                             const std::optional<ThermalCorrection>& thermal, RigTestEntry& entry, Findings& findings);

}  // namespace grouser
