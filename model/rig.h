#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "model/bushing.h"

namespace grouser {

enum class TestKind { static_ramp, cyclic };  // "static" | "cyclic" in files

/// LVDT or load cell: quantity = sensitivity * (reading - offset) + sum_k linearity[k] * (reading - offset)^(k+2).
struct SensorCalibration {
  std::string column;             ///< CSV column with the raw reading, unit suffix included ("lvdt_a_V")
  double sensitivity = 1.0;       ///< SI quantity per SI reading (m/V, N/V, N m/V, rad/V)
  double offset = 0.0;            ///< reading at zero quantity (V)
  std::vector<double> linearity;  ///< coefficients of reading^2, ^3, ... in SI
  /// The record behind it, when given: readings against reference values; the reader reports the largest residual.
  std::vector<double> record_reading;
  std::vector<double> record_quantity;
};

/// Largest |calibrated - reference| of the calibration record over the reference's full scale; 0 without a record.
[[nodiscard]] double calibration_residual(const SensorCalibration& calibration);

/// What a rig file may ask to be put right (`corrections` of the file or of one test). Nothing of it is done unasked.
enum class CorrectionKind {
  swap_columns,         ///< "swap_columns": the two columns carry each other's quantity (same unit only by chance)
  reverse_force,        ///< "reverse_force": the load cell counts the other way
  remove_backlash,      ///< "remove_backlash": play of the fixture, estimated from the loops, is taken out
  remove_creep,         ///< "remove_creep": wandering of the cycles' middle (log-time) is taken out of displacement
  remove_conditioning,  ///< "remove_conditioning": decay of the force range over cycles (Mullins, self-heating) is
                        ///< undone
  segment_at_jumps      ///< "segment_at_jumps": the record is cut at jumps of time or phase, and its parts are used
};
inline constexpr std::array<const char*, 6> k_correction_names{
    "swap_columns", "reverse_force", "remove_backlash", "remove_creep", "remove_conditioning", "segment_at_jumps"};
[[nodiscard]] inline const char* name_of(CorrectionKind kind) {
  return k_correction_names[static_cast<std::size_t>(kind)];
}

/// Softening of the specimen with temperature: force at the reference = force / (1 + stiffness_change (T - T_ref)).
struct ThermalCorrection {
  double stiffness_change = 0.0;       ///< 1/K, usually < 0
  double reference_temperature = 0.0;  ///< K
};

/// What the virtual rig is to drive in a test that nobody measured (`protocol`). Displacement and force are those of
/// one bushing, without a frame. Every test starts at rest at its preset, 0 if it states none.
///   static: ramps at RigTest::rate until the force is `to_force`, and back to the start at the same rate.
///   cyclic: preset + amplitude sin(2 pi frequency t).
struct TestProtocol {
  double to_force = 0.0;              ///< N or N m, not 0; static only
  int turns = 0;                      ///< ramps, out and back, or cycles; >= 1
  int samples_per_turn = 0;           ///< >= 2, half of a ramp's on its way out; 0 where sample_rate is given
  std::optional<double> sample_rate;  ///< Hz, of ramps: every way out and back has equal steps, no longer than 1 / this
};

/// One test of a campaign as read: SI units, calibrated, in file order, nothing corrected yet.
struct RigTest {
  std::string name;
  Axis axis = Axis::x;
  TestKind kind = TestKind::cyclic;
  std::string file;                      ///< relative to rig.json; empty with a protocol
  std::optional<TestProtocol> protocol;  ///< in place of a file: the test holds no measurement and no samples
  std::optional<double> rate;            ///< m/s or rad/s (static)
  std::optional<double> frequency;       ///< Hz (cyclic, as stated)
  std::optional<double> amplitude;       ///< m or rad (cyclic, as stated)
  std::optional<double> preset;          ///< m or rad: mean the loop runs about (14 degree preset of the torsion loops)
  std::optional<int> discard_cycles;     ///< asked for by the file; absent = decided from the data
  std::vector<double> time;              ///< s; built from rate or frequency when the file has none (see time_measured)
  bool time_measured = false;
  std::vector<double> displacement;         ///< m or rad; mean of the LVDTs when there are two
  std::vector<double> force;                ///< N or N m
  std::vector<double> tilt;                 ///< half difference of two LVDTs [m] or angle sensors [rad]; empty with one
  std::vector<double> temperature;          ///< K of the specimen; empty without a temperature_* column
  std::vector<CorrectionKind> corrections;  ///< asked for by the file for all tests or for this one
};

/// A measurement campaign on one specimen (rig.json + CSV files).
struct RigRecord {
  std::filesystem::path path;  ///< of rig.json
  std::string specimen;
  bool synthetic = false;  ///< generated data; `synthetic_note` says seed and generator
  std::string synthetic_note;
  int bushings_in_series = 1;           ///< displacement measured across this many bushings
  double rig_compliance = 0.0;          ///< m/N, in series with the specimen (x, y, z)
  double rig_angular_compliance = 0.0;  ///< rad/(N m), in series with the specimen (rx, ry, rz)
  double moving_mass = 0.0;             ///< kg between specimen and load cell, moving with the displacement (x, y, z)
  double moving_inertia = 0.0;  ///< kg m^2 between specimen and torque cell, turning with the angle (rx, ry, rz)
  std::optional<ThermalCorrection> thermal;             ///< needs a temperature column in every test
  std::vector<SensorCalibration> displacement_sensors;  ///< empty = columns found by name
  std::optional<SensorCalibration> force_sensor;        ///< of tests on x, y, z
  std::optional<SensorCalibration> torque_sensor;       ///< of tests on rx, ry, rz
  std::vector<RigTest> tests;
  Provenance provenance;  ///< inputs = rig.json and every CSV
};

/// Reads `grouser.rig/1` and every CSV it names; throws InputError with all findings of all files.
[[nodiscard]] RigRecord read_rig(const std::filesystem::path& file);

}  // namespace grouser
