#pragma once
#include <filesystem>
#include <string>

#include "model/fit.h"

/// Test only: a run folder of the right shape with made-up motion and forces, no physics behind it.
namespace grouser::mock {

struct RunOptions {
  std::string name = "Mock run";
  std::string vehicle_name = "Mock vehicle";
  double duration = 2.0;    ///< s: a third speeding up, a third steady, a third slowing down
  double rate = 200.0;      ///< Hz
  double top_speed = 45.0;  ///< rad/s of both sprockets
  bool turn = false;        ///< the right sprocket runs backwards
  bool probes = true;       ///< false: a run without probe links
  bool failing_check = false;
};

/// Writes run.json, run.h5 and inputs/ with every dataset of a real run.
void write_run(const std::filesystem::path& folder, const RunOptions& options = {});

/// A fit of two axes, x and ry, with made-up loops and every field of the record filled.
[[nodiscard]] FitRecord fit_record(const std::string& specimen = "Mock specimen");
/// Writes fit.json and bushing.json of that fit.
void write_fit_folder(const std::filesystem::path& folder, const std::string& specimen = "Mock specimen");

}  // namespace grouser::mock
