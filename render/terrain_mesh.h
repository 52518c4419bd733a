#pragma once
#include "model/terrain.h"
#include "render/mesh.h"

namespace grouser {

/// The ground of a terrain that is not level, out to 1 km, finer where something stands on it: the surface that the
/// simulation drives on, half rounds included.
[[nodiscard]] Mesh terrain_mesh(const Terrain& terrain, double tread);

}  // namespace grouser
