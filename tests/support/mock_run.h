#pragma once
#include <filesystem>
#include <string>

#include "model/fit.h"

/// Test only: a run folder of the right shape with made-up motion and forces, no physics behind it.
namespace grouser::mock {

/// What turns the sprockets, in the scenario; the motion is the same.
enum class Drive { speed, torque, cruise };

struct RunOptions {
  std::string name = "Mock run";
  std::string vehicle_name = "Mock vehicle";
  double duration = 2.0;        ///< s: a third speeding up, a third steady, a third slowing down
  double rate = 200.0;          ///< Hz
  double top_speed = 45.0;      ///< rad/s of both sprockets
  bool turn = false;            ///< the right sprocket runs backwards
  bool contact_forces = false;  ///< of all links, in /tracks/
  bool probes = true;           ///< false: a run without probe links
  bool failing_check = false;
  double bushing_scale = 1.0;  ///< the mean step goes with its power -1/2, the largest tension with +1/4
  Drive drive = Drive::speed;
  bool rough = false;        ///< a half round on the way
  bool double_pin = false;   ///< half the twist of a single pin in each bushing
  std::string failure = "";  ///< message of a run that failed
};

/// Writes run.json, run.h5 and inputs/ with every dataset of a real run.
void write_run(const std::filesystem::path& folder, const RunOptions& options = {});

/// A fit of two axes, x and ry, with made-up loops and every field of the record filled.
[[nodiscard]] FitRecord fit_record(const std::string& specimen = "Mock specimen");
/// Writes fit.json and bushing.json of that fit.
void write_fit_folder(const std::filesystem::path& folder, const std::string& specimen = "Mock specimen");

}  // namespace grouser::mock
