#pragma once
#include <vector>

#include "model/terrain.h"
#include "render/mesh.h"

namespace grouser {

/// Heights of a terrain in W over a grid of its own spacing, out to 1 km, finer where something stands on it.
struct TerrainGrid {
  std::vector<double> x, y;    ///< m, strictly increasing
  std::vector<double> height;  ///< m, at (x[i], y[j]) in [i * y.size() + j]
};
/// The surface that the simulation drives on, half rounds included.
[[nodiscard]] TerrainGrid terrain_grid(const Terrain& terrain, double tread);

/// The same as triangles.
[[nodiscard]] Mesh terrain_mesh(const Terrain& terrain, double tread);

}  // namespace grouser
