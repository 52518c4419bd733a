#pragma once
#include "model/ground_surface.h"
#include "render/camera.h"

namespace grouser {

/// The ground cut open along the picture plane through the camera's target: a wall from the surface down, as wide as a
/// parallel view. See Scene::section.
[[nodiscard]] Mesh ground_section(const GroundSurface& ground, const Camera& camera, float aspect);

}  // namespace grouser
