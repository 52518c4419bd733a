#pragma once
#include <string>

#include "model/json_reader.h"
#include "model/terrain.h"

namespace grouser {

/// The `terrain` object of a scenario. A profile's own file is read apart, by read_ground_profile.
struct TerrainEntry {
  Terrain terrain;
  std::string profile_file;    ///< relative to the scenario file; empty when none
  double profile_start = 0.0;  ///< m along x, where the file's distance 0 stands
};
[[nodiscard]] TerrainEntry read_terrain(ObjectReader& r);

/// A table of distance_* and height_* (both sides alike), or left_height_* and right_height_*; its distances are moved
/// by `start`. What is wrong goes to `findings`.
[[nodiscard]] GroundProfile read_ground_profile(const std::string& bytes, double start, Findings& findings);

}  // namespace grouser
