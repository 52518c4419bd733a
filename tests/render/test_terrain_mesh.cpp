#include <gtest/gtest.h>

#include <cmath>

#include "model/ground_surface.h"
#include "render/terrain_mesh.h"

namespace grouser {
namespace {

Terrain rough_ground() {
  Terrain terrain;
  terrain.slope = 0.1;
  terrain.road = RandomRoad{'E', 1, 5.0, 20.0};
  terrain.obstacles = {{ObstacleKind::half_round, Side::left, 3.0, 0.2}};
  return terrain;
}

TEST(TerrainMesh, LiesOnTheGroundThatIsDrivenOn) {
  const Terrain terrain = rough_ground();
  const GroundSurface ground(terrain, 2.79);
  const Mesh mesh = terrain_mesh(terrain, 2.79);
  EXPECT_GT(mesh.num_triangles(), 2u * 400u);  // a row every 50 mm of the road
  for (const Vertex& v : mesh.vertices) {
    const double x = static_cast<double>(v.position.x()), y = static_cast<double>(v.position.y());
    // Single precision of 0.1 mm at 1 km; a half round's side is upright, so its foot may be a step of its outline off.
    const double tolerance = std::abs(std::abs(x - 3.0) - 0.2) < 1e-3 ? 0.02 : 2e-4;
    EXPECT_NEAR(static_cast<double>(v.position.z()), ground.top(x, y), tolerance) << x << " " << y;
    EXPECT_GT(v.normal.z(), 0.0f);  // seen from above
  }
}

TEST(TerrainMesh, ShowsAHalfRoundOnItsSideAlone) {
  const Mesh mesh = terrain_mesh(rough_ground(), 2.79);
  double left = 0.0, right = 0.0;
  for (const Vertex& v : mesh.vertices) {
    if (std::abs(v.position.x() - 3.0f) > 1e-3f) continue;
    double& highest = v.position.y() >= 0.0f ? left : right;
    highest = std::max(highest, static_cast<double>(v.position.z()));
  }
  EXPECT_NEAR(left, 0.3 + 0.2, 1e-4);
  EXPECT_NEAR(right, 0.3, 1e-4);
}

}  // namespace
}  // namespace grouser
