#include "render/terrain_mesh.h"

#include <algorithm>
#include <cmath>

#include "model/ground_surface.h"

namespace grouser {
namespace {

constexpr double k_reach = 1000.0;  // m, beyond the haze
constexpr double k_spacing = 0.05;  // m between rows where the ground is uneven
constexpr int k_round_steps = 32;   // over a half round

/// Places along x: the far ends, rows where a course is, and the outline of every half round.
std::vector<double> rows(const GroundSurface& ground) {
  const auto [begin, end] = ground.extent();
  std::vector<double> x{-k_reach, k_reach};
  for (double at = begin; at < end; at += k_spacing) x.push_back(at);
  x.push_back(end);
  for (const GroundSurface::HalfRound& round : ground.half_rounds()) {
    for (int i = 0; i <= k_round_steps; ++i) x.push_back(round.x - round.radius * std::cos(k_pi * i / k_round_steps));
  }
  std::sort(x.begin(), x.end());
  const auto same = [](double a, double b) { return b - a < 1e-4; };
  x.erase(std::unique(x.begin(), x.end(), same), x.end());
  return x;
}

/// Places along y: straight on each side, bent over the median; half rounds of one side end at 0.
std::vector<double> columns(const Terrain& terrain) {
  std::vector<double> y{-k_reach};
  constexpr int k_steps = 6;
  for (int i = 0; i <= k_steps; ++i) {
    const double at = terrain.median * (static_cast<double>(i) / k_steps - 0.5);
    if (i == k_steps / 2) y.push_back(-1e-3);
    y.push_back(at);
  }
  y.push_back(k_reach);
  return y;
}

}  // namespace

TerrainGrid terrain_grid(const Terrain& terrain, double tread) {
  const GroundSurface ground(terrain, tread);
  TerrainGrid grid{rows(ground), columns(terrain), {}};
  for (const double x : grid.x)
    for (const double y : grid.y) grid.height.push_back(ground.top(x, y));
  return grid;
}

Mesh terrain_mesh(const Terrain& terrain, double tread) {
  const TerrainGrid grid = terrain_grid(terrain, tread);
  const auto at = [&](std::size_t i, std::size_t j) {
    return Vector3d(grid.x[i], grid.y[j], grid.height[i * grid.y.size() + j]).cast<float>().eval();
  };
  Mesh mesh;
  for (std::size_t j = 0; j + 1 < grid.y.size(); ++j) {
    for (std::size_t i = 0; i + 1 < grid.x.size(); ++i) {
      mesh.add_quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1), {});
    }
  }
  return mesh;
}

}  // namespace grouser
