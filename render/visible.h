#pragma once
#include <vector>

#include "render/detail.h"
#include "render/scene.h"

/// Which parts of a scene a picture needs.
namespace grouser {

struct Ball {
  Vector3f center = Vector3f::Zero();
  float radius = 0.0f;  ///< m
};
/// Round the box that the mesh fills.
[[nodiscard]] Ball ball_round(const Mesh& mesh);

/// Instances of one mesh that are drawn in one detail, the nearest first.
struct PartGroup {
  std::size_t mesh = 0;
  Detail::Level level = Detail::middle;
  float distance = 0.0f;  ///< m, of the nearest point of the nearest
  std::size_t first = 0;  ///< place of its first instance among all of VisibleParts::instances()
  std::vector<const Instance*> instances;
};

/// Each list from near to far, so that what is hidden is not shaded.
struct VisibleParts {
  std::vector<PartGroup> solids, see_through, annotations;
  std::vector<PartGroup> casters;  ///< whose shadows may fall into the picture

  /// All of them, group by group.
  [[nodiscard]] std::vector<const Instance*> instances() const;
};

/// `balls`: of the scene's meshes. What a ball does not show to be outside of the picture is kept. The scene must
/// outlive the result.
[[nodiscard]] VisibleParts visible_parts(const Scene& scene, const std::vector<Ball>& balls, int width, int height);

}  // namespace grouser
