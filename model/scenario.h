#pragma once
#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "model/bushing.h"
#include "model/geometry.h"
#include "model/terrain.h"
#include "model/vehicle.h"

namespace grouser {

/// What turns a sprocket: a motion that is given, a torque that is given, or a driver who holds a speed.
enum class DriveKind { speed, torque, cruise };

/// One value over time for one sprocket, linear between the points, constant outside; forward > 0. Which of the three
/// columns is filled follows the kind.
struct DriveTable {
  std::vector<double> time;   ///< s, strictly increasing
  std::vector<double> speed;  ///< rad/s, of the sprocket (DriveKind::speed)
  DriveKind kind = DriveKind::speed;
  std::vector<double> torque{};        ///< N m, between chassis and sprocket (torque); 0 lets the vehicle coast
  double drag = 0.0;                   ///< N m s/rad, of the final drive, against the sprocket's rate (torque)
  std::vector<double> target_speed{};  ///< m/s, of the track through its teeth (cruise)
  double power = 0.0;                  ///< W, the engine's share for this side (cruise)
  double largest_torque = 0.0;         ///< N m, of the engine at low speed (cruise)
  double brake_torque = 0.0;           ///< N m, against the motion (cruise)
  double response_time = 0.5;          ///< s, of the driver's correction (cruise)

  /// The column that the kind uses.
  [[nodiscard]] const std::vector<double>& value() const {
    return kind == DriveKind::speed ? speed : kind == DriveKind::torque ? torque : target_speed;
  }
};

/// Linear between the points of a table, constant outside.
[[nodiscard]] double table_value(const std::vector<double>& time, const std::vector<double>& value, double at);

struct ProbeLink {
  Side side = Side::right;
  int link = 0;  ///< 0-based
};

struct OutputOptions {
  double rate = 200.0;         ///< Hz, all channels
  double probe_rate = 2000.0;  ///< Hz, probe links
  std::vector<ProbeLink> probes;
};

/// Chung-Lee explicit, variable-step slope form (D 1).
struct IntegratorOptions {
  double beta = 28.0 / 27.0;             ///< 1 .. 28/27
  double velocity_tolerance = 3e-2;      ///< m/s, local error of a link's point at half a pitch, maximum norm
  double displacement_tolerance = 3e-5;  ///< m
  double max_step = 2e-4;                ///< s
  double min_step = 1e-6;                ///< s; a smaller one asked for ends the run
  double stability_fraction = 1.0;       ///< of the largest step that is stable for certain
  double growth_limit = 1.1;
  double fixed_step = 0.0;  ///< s; > 0 switches error control and bound off
};

struct AssemblyOptions {
  double settle_time = 8.0;  ///< s simulated before t = 0
  double step = 8e-5;        ///< s
};

/// The documents behind a scenario, with --set applied.
struct ScenarioDocuments {
  std::string scenario, vehicle, bushing;
  std::string profile;                                ///< bytes of the terrain's profile file; empty when there is none
  std::array<std::string, k_num_sides> side_bushing;  ///< empty unless the track names its own bushing
};

struct Scenario {
  std::filesystem::path path;
  std::vector<std::filesystem::path> files;  ///< it and those that it was read from, as they were opened
  std::string name;
  std::string vehicle_file, bushing_file;  ///< relative to the scenario file
  std::string profile_file;                ///< of the terrain, relative to the scenario file; empty when none
  Vehicle vehicle;
  Bushing bushing;
  Terrain terrain;
  std::array<DriveTable, k_num_sides> drive;
  double duration = 0.0;  ///< s
  double gravity = 9.81;  ///< m/s^2
  OutputOptions output;
  IntegratorOptions integrator;
  AssemblyOptions assembly;
  AxisScale bushing_scale{1.0, 1.0, 1.0, 1.0, 1.0, 1.0};  ///< in `bushing` and `side_bushing` already
  Provenance provenance;                                  ///< scenario, vehicle and bushing files
  ScenarioDocuments documents;
  std::array<std::optional<Bushing>, k_num_sides> side_bushing;  ///< of a track that names its own

  /// The bushing in the joints of one track.
  [[nodiscard]] const Bushing& bushing_of(Side side) const {
    const auto& own = side_bushing[static_cast<std::size_t>(index_of(side))];
    return own ? *own : bushing;
  }
};

/// What the command line may replace.
struct ScenarioOverrides {
  std::string vehicle_file, bushing_file;  ///< empty = as the scenario says
  std::map<std::string, std::string>
      set;  ///< "integrator.max_step_ms" -> "0.1"; "vehicle./left/track/pre_tension_kN" -> "60"
};

/// Reads `grouser.scenario/1` and the files it names; throws InputError with the findings of all of them.
[[nodiscard]] Scenario read_scenario(const std::filesystem::path& file, const ScenarioOverrides& overrides = {});

/// Names of the files that write_inputs() may write.
[[nodiscard]] std::vector<std::string> input_names();
/// Writes the documents of a run into run_folder/inputs/ (scenario.json, vehicle.json, bushing.json, and profile.csv of
/// a terrain that has one), which then name one another: read_scenario(run_folder / "inputs/scenario.json") gives the
/// same scenario again.
void write_inputs(const Scenario& scenario, const std::filesystem::path& run_folder);

}  // namespace grouser
