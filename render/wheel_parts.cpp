#include <cmath>

#include "model/geometry.h"
#include "render/parts.h"

namespace grouser {
namespace {

constexpr float k_two_pi = static_cast<float>(2.0 * k_pi);
const Material k_painted{{0.38f, 0.43f, 0.29f}, 0.25f};
const Material k_painted_dark{{0.29f, 0.33f, 0.23f}, 0.2f};
const Material k_tyre{{0.17f, 0.17f, 0.175f}, 0.1f};
const Material k_steel{{0.45f, 0.45f, 0.44f}, 0.7f};
const Material k_tooth_steel{{0.42f, 0.40f, 0.37f}, 0.6f};

/// A part that looks outward on the +y side and again on the -y side.
void append_both_sides(const Mesh& outward, Mesh& mesh) {
  mesh.append(outward, Eigen::Affine3f::Identity());
  mesh.append(outward, Eigen::Affine3f(Eigen::AngleAxisf(static_cast<float>(k_pi), Vector3f::UnitZ())));
}

/// From afar their heads alone.
void add_bolts(int count, float circle, float y, float size, const Material& material, const Detail& detail,
               Mesh& mesh) {
  constexpr float k_height = 0.014f;
  const Vector2f foot(size, y), rim(size, y + k_height), middle(0.0f, y + k_height);
  const auto profile =
      detail.shows(k_height) ? std::vector<Vector2f>{foot, rim, middle} : std::vector<Vector2f>{rim, middle};
  for (int i = 0; i < count; ++i) {
    const float angle = k_two_pi * static_cast<float>(i) / static_cast<float>(count);
    mesh.add_lathe(profile, std::min(detail.segments(size), 6), {circle * std::cos(angle), 0, circle * std::sin(angle)},
                   material);
  }
}

/// Disc from y = inner to outer: tyre outside, dished steel inside; the face towards the gap is plain.
struct DiscShape {
  float radius, inner, outer, tyre;
  Detail detail;
};

void add_disc(const DiscShape& d, const Material& steel, bool dished, Mesh& mesh) {
  const int segments = d.detail.segments(d.radius);
  const float rim = d.radius - d.tyre, soft = 0.012f, dish = d.outer - 0.45f * (d.outer - d.inner);
  if (d.tyre > 0.0f && !d.detail.shows(soft)) {
    mesh.add_lathe({{rim, d.inner}, {d.radius, d.inner}, {d.radius, d.outer}, {rim, d.outer}}, segments,
                   Vector3f::Zero(), k_tyre);
  } else if (d.tyre > 0.0f) {
    mesh.add_lathe({{rim, d.inner},
                    {d.radius - soft, d.inner},
                    {d.radius, d.inner + soft},
                    {d.radius, d.outer - soft},
                    {d.radius - soft, d.outer},
                    {rim, d.outer}},
                   segments, Vector3f::Zero(), k_tyre);
  } else {
    mesh.add_lathe({{rim, d.inner}, {rim, d.outer}}, segments, Vector3f::Zero(), steel);
  }
  mesh.add_lathe({{0.3f * rim, d.inner}, {rim, d.inner}}, segments, Vector3f::Zero(), steel);
  if (dished) {
    mesh.add_lathe({{rim, d.outer}, {0.86f * rim, d.outer}, {0.76f * rim, dish}, {0.42f * rim, dish}}, segments,
                   Vector3f::Zero(), steel);
  } else {
    mesh.add_lathe({{rim, d.outer}, {0.2f * rim, d.outer}}, segments, Vector3f::Zero(), steel);
  }
}

/// Hub of radius r from the dish to `outer`, with a domed cap.
void add_hub(float r, float inner, float outer, const Material& material, const Detail& detail, Mesh& mesh) {
  const Vector2f foot(r, inner), rim(0.92f * r, outer - 0.015f), dome(0.7f * r, outer - 0.004f), middle(0.0f, outer);
  const auto profile =
      detail.shows(0.011f) ? std::vector<Vector2f>{foot, rim, dome, middle} : std::vector<Vector2f>{foot, rim, middle};
  mesh.add_lathe(profile, detail.segments(r), Vector3f::Zero(), material);
}

struct DiscPairShape {
  float radius, inner, outer;
  explicit DiscPairShape(const DiscPair& pair)
      : radius(static_cast<float>(pair.radius)),
        inner(static_cast<float>(0.5 * pair.gap)),
        outer(static_cast<float>(0.5 * pair.gap + pair.disc_width)) {}
};

/// The dished face, y.
float dish_of(const DiscPairShape& s) { return s.outer - 0.45f * (s.outer - s.inner); }

/// Axle between the discs.
void add_axle(const DiscPairShape& s, float radius, const Detail& detail, Mesh& mesh) {
  mesh.add_lathe({{radius, -s.inner}, {radius, s.inner}}, detail.segments(radius), Vector3f::Zero(), k_painted_dark);
}

/// Rim of one tooth and its gap, as (radius, angle from the gap's middle) over one pitch of the ring, rising angle.
std::vector<Vector2f> tooth_outline(const Sprocket& sprocket, const Track& track, const Detail& detail) {
  const double pitch_radius = track.pitch / (2.0 * std::sin(k_pi / sprocket.teeth));
  const double seat = track.pin_radius + sprocket.seat_clearance, center = pitch_radius + sprocket.seat_clearance;
  const double flank_sin = std::sin(sprocket.flank_angle), flank_cos = std::cos(sprocket.flank_angle);
  std::vector<Vector2f> half;  // gap middle to tooth middle
  const auto push = [&half](double x, double y) {
    half.emplace_back(static_cast<float>(std::hypot(x, y)), static_cast<float>(std::atan2(y, x)));
  };
  const int arc = std::max(2, detail.segments(static_cast<float>(seat)) / 4);
  for (int i = 0; i <= arc; ++i) {  // seat fillet, from the bottom to where the flank is tangent
    const double turn = (0.5 * k_pi - sprocket.flank_angle) * i / arc;
    push(center - seat * std::cos(turn), seat * std::sin(turn));
  }
  // Flank from the fillet to the tip circle: |start + s * direction| = tip radius.
  const double x = center - seat * flank_sin, y = seat * flank_cos;
  const double along = x * flank_cos + y * flank_sin;
  const double reach =
      std::sqrt(std::max(0.0, sprocket.tip_radius * sprocket.tip_radius - (x * x + y * y) + along * along)) - along;
  push(x + reach * flank_cos, y + reach * flank_sin);
  half.emplace_back(static_cast<float>(sprocket.tip_radius), static_cast<float>(k_pi / sprocket.teeth));
  std::vector<Vector2f> outline;
  for (std::size_t i = half.size(); i-- > 1;) outline.emplace_back(half[i].x(), -half[i].y());
  outline.insert(outline.end(), half.begin(), half.end() - 1);
  return outline;
}

void add_tooth_ring(const std::vector<Vector2f>& outline, int teeth, float hole, float y0, float y1, Mesh& mesh) {
  std::vector<Vector2f> points;
  for (int tooth = 0; tooth < teeth; ++tooth) {
    for (const Vector2f& p : outline)
      points.emplace_back(p.x(), p.y() + k_two_pi * static_cast<float>(tooth) / static_cast<float>(teeth));
  }
  const auto at = [](float radius, float angle, float y) {
    return Vector3f(radius * std::cos(angle), y, radius * std::sin(angle));
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector2f p = points[i], q = points[(i + 1) % points.size()];
    mesh.add_quad(at(hole, p.y(), y1), at(hole, q.y(), y1), at(q.x(), q.y(), y1), at(p.x(), p.y(), y1), k_tooth_steel);
    mesh.add_quad(at(hole, p.y(), y0), at(p.x(), p.y(), y0), at(q.x(), q.y(), y0), at(hole, q.y(), y0), k_tooth_steel);
    mesh.add_quad(at(p.x(), p.y(), y0), at(p.x(), p.y(), y1), at(q.x(), q.y(), y1), at(q.x(), q.y(), y0), k_steel);
  }
}

}  // namespace

Mesh road_wheel_mesh(const DiscPair& wheel, const Detail& detail) {
  const DiscPairShape s(wheel);
  const float tyre = 0.13f * s.radius, rim = s.radius - tyre, dish = dish_of(s);
  Mesh side;
  add_disc({s.radius, s.inner, s.outer, tyre, detail}, k_painted, true, side);
  add_hub(0.42f * rim, dish, s.outer + 0.02f, k_painted_dark, detail, side);
  add_bolts(8, 0.6f * rim, dish, 0.02f, k_steel, detail, side);
  Mesh mesh;
  append_both_sides(side, mesh);
  add_axle(s, 0.3f * rim, detail, mesh);
  return mesh;
}

Mesh idler_mesh(const DiscPair& wheel, const Detail& detail) {
  const DiscPairShape s(wheel);
  const float rim = s.radius, dish = dish_of(s);
  Mesh side;
  add_disc({s.radius, s.inner, s.outer, 0.0f, detail}, k_painted, true, side);
  add_hub(0.34f * rim, dish, s.outer + 0.02f, k_painted_dark, detail, side);
  for (int i = 0; i < 6; ++i) {  // ribs, so that the idler is told from a road wheel and its turning is seen
    Mesh rib;
    rib.add_box({0.56f * rim, dish + 0.012f, 0.0f}, {0.2f * rim, 0.014f, 0.02f}, 0.0f, k_painted_dark);
    const float angle = k_two_pi * static_cast<float>(i) / 6.0f;
    side.append(rib, Eigen::Affine3f(Eigen::AngleAxisf(angle, Vector3f::UnitY())));
  }
  Mesh mesh;
  append_both_sides(side, mesh);
  add_axle(s, 0.3f * rim, detail, mesh);
  return mesh;
}

Mesh roller_mesh(const DiscPair& roller, const Detail& detail) {
  const DiscPairShape s(roller);
  Mesh side;
  add_disc({s.radius, s.inner, s.outer, 0.22f * s.radius, detail}, k_painted, false, side);
  add_hub(0.4f * s.radius, s.outer - 0.005f, s.outer + 0.02f, k_painted_dark, detail, side);
  add_bolts(6, 0.58f * s.radius, s.outer, 0.011f, k_steel, detail, side);
  Mesh mesh;
  append_both_sides(side, mesh);
  add_axle(s, 0.4f * s.radius, detail, mesh);
  return mesh;
}

Mesh disc_pair_shadow_mesh(const DiscPair& wheel) {
  const DiscPairShape s(wheel);
  const float dish = dish_of(s), hub = 0.33f * s.radius, end = s.outer + 0.003f;  // within all that they shade
  Mesh side, mesh;
  side.add_lathe({{0, s.inner},
                  {s.radius, s.inner},
                  {s.radius, s.outer},
                  {0.6f * s.radius, dish},
                  {hub, dish},
                  {hub, end},
                  {0, end}},
                 24, Vector3f::Zero(), k_tyre);
  append_both_sides(side, mesh);
  return mesh;
}

Mesh sprocket_mesh(const Sprocket& sprocket, const Track& track, const Detail& detail) {
  constexpr float k_half_ring = 0.018f;
  const auto ring = static_cast<float>(sprocket.ring_offset), base = static_cast<float>(sprocket.base_radius);
  const std::vector<Vector2f> outline = tooth_outline(sprocket, track, detail);
  const float hole = 0.72f * base, drum = 0.78f * base;
  Mesh mesh;
  for (const float side : {-1.0f, 1.0f})
    add_tooth_ring(outline, sprocket.teeth, hole, side * ring - k_half_ring, side * ring + k_half_ring, mesh);
  Mesh face;
  face.add_lathe({{drum, 0.0f}, {drum, ring - k_half_ring}}, detail.segments(drum), Vector3f::Zero(), k_painted_dark);
  face.add_lathe({{hole + 0.001f, ring + k_half_ring}, {hole, ring - 0.03f}, {0.45f * base, ring - 0.05f}},
                 detail.segments(hole), Vector3f::Zero(), k_painted);
  add_hub(0.45f * base, ring - 0.06f, ring + 0.03f, k_painted_dark, detail, face);
  add_bolts(sprocket.teeth, 0.86f * base, ring + k_half_ring, 0.013f, k_steel, detail, face);
  add_bolts(8, 0.59f * base, ring - 0.036f, 0.014f, k_steel, detail, face);
  append_both_sides(face, mesh);
  return mesh;
}

Mesh arm_mesh(const Vector3d& pivot_to_axle, const DiscPair& wheel, double inboard, const Detail& detail) {
  const auto in = static_cast<float>(inboard);
  const DiscPairShape s(wheel);
  const float y = in * (s.outer + 0.05f), r = 0.09f;
  const Vector3f axle(static_cast<float>(pivot_to_axle.x()), 0.0f, static_cast<float>(pivot_to_axle.z()));
  Mesh mesh;
  Mesh beam;
  beam.add_box({0.5f * axle.norm(), y, 0.0f}, {0.5f * axle.norm(), 0.038f, 0.06f}, detail.shows(0.02f) ? 0.015f : 0.0f,
               k_painted_dark);
  // A turn about +y takes +x towards -z.
  mesh.append(beam, Eigen::Affine3f(Eigen::AngleAxisf(std::atan2(-axle.z(), axle.x()), Vector3f::UnitY())));
  mesh.add_lathe({{0, y - 0.055f}, {r, y - 0.055f}, {r, y + 0.055f}, {0, y + 0.055f}}, detail.segments(r),
                 Vector3f::Zero(), k_painted_dark);
  const float a = std::min(in * s.inner, y), b = std::max(in * s.inner, y);
  mesh.add_lathe({{0, a}, {0.8f * r, a}, {0.8f * r, b}, {0, b}}, detail.segments(0.8f * r), axle, k_painted_dark);
  return mesh;
}

}  // namespace grouser
