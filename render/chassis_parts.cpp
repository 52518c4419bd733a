#include <algorithm>
#include <cmath>
#include <numeric>

#include "render/parts.h"

namespace grouser {
namespace {

constexpr float k_bevel = 0.018f;  ///< m, light catches the edges

float cross(const Vector2f& a, const Vector2f& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Outline (x, z) in the sense from +x to +z.
std::vector<Vector2f> outline_of(const VisualPart& part) {
  std::vector<Vector2f> points;
  for (const Vector3d& p : part.outline) points.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.z()));
  float area = 0.0f;
  for (std::size_t i = 0; i < points.size(); ++i) area += cross(points[i], points[(i + 1) % points.size()]);
  if (area < 0.0f) std::reverse(points.begin(), points.end());
  return points;
}

/// The outline with every edge moved inwards by `distance`.
std::vector<Vector2f> inset(const std::vector<Vector2f>& outline, float distance) {
  std::vector<Vector2f> moved;
  const std::size_t n = outline.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vector2f before = (outline[i] - outline[(i + n - 1) % n]).normalized();
    const Vector2f after = (outline[(i + 1) % n] - outline[i]).normalized();
    const Vector2f in_before(-before.y(), before.x()), in_after(-after.y(), after.x());
    // Intersection of the two moved edges; very sharp corners are held back.
    const Vector2f bisector = in_before + in_after;
    moved.push_back(outline[i] + distance * bisector / std::max(0.5f, 1.0f + in_before.dot(in_after)));
  }
  return moved;
}

/// Ear clipping of a simple polygon in the sense from +x to +z.
std::vector<std::array<std::size_t, 3>> triangulate(const std::vector<Vector2f>& points) {
  std::vector<std::size_t> left(points.size());
  std::iota(left.begin(), left.end(), std::size_t{0});
  std::vector<std::array<std::size_t, 3>> triangles;
  const auto is_ear = [&](std::size_t k) {
    const std::size_t a = left[(k + left.size() - 1) % left.size()], b = left[k], c = left[(k + 1) % left.size()];
    if (cross(points[b] - points[a], points[c] - points[b]) <= 0.0f) return false;
    return std::none_of(left.begin(), left.end(), [&](std::size_t p) {
      if (p == a || p == b || p == c) return false;
      return cross(points[b] - points[a], points[p] - points[a]) >= 0.0f &&
             cross(points[c] - points[b], points[p] - points[b]) >= 0.0f &&
             cross(points[a] - points[c], points[p] - points[c]) >= 0.0f;
    });
  };
  while (left.size() >= 3) {
    std::size_t k = 0;
    while (k < left.size() && !is_ear(k)) ++k;
    if (k == left.size()) k = 0;  // a degenerate outline: any triangle will do for a picture
    triangles.push_back({left[(k + left.size() - 1) % left.size()], left[k], left[(k + 1) % left.size()]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(k));
  }
  return triangles;
}

/// The outline extruded over y, drawn in by the taper towards its top, edges cut.
void add_part(const VisualPart& part, Mesh& mesh) {
  const Material paint{parse_color(part.color), 0.28f};
  const std::vector<Vector2f> outline = outline_of(part);
  if (outline.size() < 3) return;
  const auto [low, high] =
      std::minmax_element(outline.begin(), outline.end(), [](const auto& a, const auto& b) { return a.y() < b.y(); });
  const float bottom = low->y(), rise = std::max(high->y() - low->y(), 1e-6f);
  const float bevel = std::min(k_bevel, 0.2f * rise);
  const std::vector<Vector2f> cap = inset(outline, bevel);
  const auto half_width = [&](float z) {
    return static_cast<float>(part.half_width) - static_cast<float>(part.taper) * (z - bottom) / rise;
  };
  const auto rim_at = [&](std::size_t i, float side) {
    return Vector3f(outline[i].x(), side * (half_width(outline[i].y()) - bevel), outline[i].y());
  };
  const auto cap_at = [&](std::size_t i, float side) {
    return Vector3f(cap[i].x(), side * half_width(cap[i].y()), cap[i].y());
  };
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const std::size_t k = (i + 1) % outline.size();
    mesh.add_quad(rim_at(i, -1), rim_at(i, 1), rim_at(k, 1), rim_at(k, -1), paint);
    mesh.add_quad(rim_at(i, 1), cap_at(i, 1), cap_at(k, 1), rim_at(k, 1), paint);
    mesh.add_quad(rim_at(k, -1), cap_at(k, -1), cap_at(i, -1), rim_at(i, -1), paint);
  }
  for (const auto& [a, b, c] : triangulate(cap)) {  // x towards z is a right-handed turn about -y
    mesh.add_triangle(cap_at(a, 1), cap_at(c, 1), cap_at(b, 1), paint);
    mesh.add_triangle(cap_at(a, -1), cap_at(b, -1), cap_at(c, -1), paint);
  }
}

void add_tube(const VisualTube& tube, const Detail& detail, Mesh& mesh) {
  const Vector3f from = tube.from.cast<float>(), along = (tube.to - tube.from).cast<float>();
  const auto r = static_cast<float>(tube.radius);
  const float length = along.norm(), lip = std::min(0.15f * r, 0.1f * length), bore = 0.55f * r;
  const Material paint{parse_color(tube.color), 0.35f}, dark{{0.05f, 0.05f, 0.05f}, 0.05f};
  Mesh body;
  body.add_lathe({{0, 0}, {r - lip, 0}, {r, lip}, {r, length - lip}, {r - lip, length}, {bore, length}},
                 detail.segments(r), Vector3f::Zero(), paint);
  body.add_lathe({{bore, length}, {0, length}}, detail.segments(r), Vector3f::Zero(), dark);
  const Eigen::Quaternionf turn = Eigen::Quaternionf::FromTwoVectors(Vector3f::UnitY(), along);
  mesh.append(body, Eigen::Affine3f(Eigen::Translation3f(from) * turn));
}

/// A hull that any vehicle file has room for: between the tracks, from the wheels' axles to above the upper run.
VisualPart plain_hull(const Vehicle& vehicle) {
  double front = -1e9, rear = 1e9, top = 0.0, low = 1e9, half_width = 1e9;
  for (const RunningGear& gear : vehicle.sides) {
    for (const Vector3d& end : {gear.sprocket.center, gear.idler.wheel.center}) {
      front = std::max(front, end.x());
      rear = std::min(rear, end.x());
      top = std::max(top, end.z());
    }
    for (const DiscPair& roller : gear.support_rollers) top = std::max(top, roller.center.z());
    for (const Station& station : gear.stations) low = std::min(low, station.pivot.z());
    half_width = std::min(half_width, std::abs(gear.track_center_y) - 0.5 * gear.track.shoe_width);
  }
  const double roof = top + 0.45;
  const auto at = [](double x, double z) { return Vector3d(x, 0.0, z); };
  return {"hull",
          "#66784a",
          {at(rear - 0.2, low - 0.1), at(front - 0.5, low - 0.1), at(front + 0.3, top), at(front - 0.6, roof),
           at(rear - 0.2, roof)},
          half_width - 0.06,
          0.0};
}

}  // namespace

Mesh chassis_mesh(const Vehicle& vehicle, const Detail& detail) {
  Mesh mesh;
  if (vehicle.visual_parts.empty()) add_part(plain_hull(vehicle), mesh);
  for (const VisualPart& part : vehicle.visual_parts) add_part(part, mesh);
  for (const VisualTube& tube : vehicle.visual_tubes) add_tube(tube, detail, mesh);
  return mesh;
}

}  // namespace grouser
