#include <algorithm>
#include <cmath>

#include "model/geometry.h"

#include "render/parts.h"

namespace grouser {
namespace {

const Material k_cast_steel{{0.34f, 0.345f, 0.35f}, 0.45f};
const Material k_worn_steel{{0.50f, 0.50f, 0.49f}, 0.8f};
const Material k_forged_steel{{0.40f, 0.395f, 0.385f}, 0.6f};
const Material k_pad_rubber{{0.19f, 0.19f, 0.195f}, 0.06f};

/// Dimensions of the picture that follow from the track's own.
struct LinkShape {
  Detail detail;
  bool double_pin;
  float half_pitch, half_width, joint, pin, boss, plate_half_x, plate_half_y, plate_top, plate_bottom, ground;
  LinkShape(const Track& track, const Detail& of)
      : detail(of),
        double_pin(track.connection == Connection::double_pin),
        half_pitch(static_cast<float>(0.5 * track.pitch)),
        half_width(static_cast<float>(0.5 * track.shoe_width)),
        joint(half_pitch - (double_pin ? static_cast<float>(0.5 * track.connector.length) : 0.0f)),
        pin(static_cast<float>(track.pin_radius)),
        boss(std::min(static_cast<float>(std::min(1.55 * track.pin_radius, 0.9 * track.wheel_path_height)),
                      double_pin ? 0.9f * (half_pitch - joint) : half_pitch)),
        plate_half_x(joint - 1.12f * boss),
        plate_half_y(0.79f * half_width),  // the sprocket's rings run outside the plate
        plate_top(static_cast<float>(track.wheel_path_height)),
        plate_bottom(-0.62f * static_cast<float>(track.ground_depth)),
        ground(-static_cast<float>(track.ground_depth)) {}
};

void add_plate(const LinkShape& s, Mesh& mesh) {
  const float cut = 0.35f * s.plate_top, middle = s.plate_top - cut;
  const Vector2f half(s.plate_half_x, s.plate_half_y), inner(s.plate_half_x - cut, s.plate_half_y - 0.5f * cut);
  mesh.add_frustum({0, 0, middle}, half, cut, inner, k_cast_steel, true);
  mesh.add_frustum({0, 0, middle}, half, s.plate_bottom - middle, half, k_cast_steel, true);
}

/// Two bars across the link, each in two halves: the ground points stand in two rows.
void add_grousers(const LinkShape& s, Mesh& mesh) {
  const float depth = s.ground - s.plate_bottom;
  const float bar = 0.42f * s.half_pitch, center_x = 0.5f * s.half_pitch, half_y = 0.42f * s.half_width;
  for (const float x : {-1.0f, 1.0f}) {
    for (const float y : {-1.0f, 1.0f}) {
      mesh.add_frustum({x * center_x, y * (half_y + 0.03f * s.half_width), s.plate_bottom}, {bar, half_y}, depth,
                       {0.78f * bar, 0.96f * half_y}, k_pad_rubber, true);
    }
  }
}

void add_guide(const Track& track, const LinkShape& s, Mesh& mesh) {
  const auto height = static_cast<float>(track.guide_height);
  const Vector2f base(0.62f * s.half_pitch, static_cast<float>(0.5 * track.guide_base_width));
  const Vector2f top(0.26f * s.half_pitch, static_cast<float>(0.5 * track.guide_top_width));
  const Vector2f shoulder = base + 0.8f * (top - base);
  if (!s.detail.shows(0.02f)) {
    mesh.add_frustum({0, 0, s.plate_top}, base, height, top, k_cast_steel, true);
    return;
  }
  mesh.add_frustum({0, 0, s.plate_top}, base, 0.8f * height, shoulder, k_cast_steel, true);
  mesh.add_frustum({0, 0, s.plate_top + 0.8f * height}, shoulder, 0.2f * height, 0.6f * top, k_cast_steel, true);
}

/// One boss round a joint's axis at `x`; only its half that stands out of the plate.
void add_boss(const LinkShape& s, float x, float center_y, float half_y, Mesh& mesh) {
  const float from = x > 0.0f ? -1.9f : 1.2416f, to = from + 3.8f;
  const int segments = std::max(3, s.detail.segments(s.boss) * 6 / 10);
  const Vector2f first(s.boss, -half_y), last(s.boss, half_y);
  const auto profile = s.detail.shows(0.3f * s.boss)
                           ? std::vector<Vector2f>{Vector2f(0, -half_y), first, last, Vector2f(0, half_y)}
                           : std::vector<Vector2f>{first, last};
  mesh.add_lathe(profile, segments, {x, center_y, 0}, k_cast_steel, from, to);
}

/// At a single pin those of this link stand in the middle of the shoe at its leading joint and further out at its
/// trailing joint, so that neighbours interlock; a shoe with two pins of its own has a pair of long ones at either end.
void add_bosses(const LinkShape& s, Mesh& mesh) {
  for (const float side : {-1.0f, 1.0f}) {
    if (s.double_pin) {
      for (const float end : {-1.0f, 1.0f})
        add_boss(s, end * s.joint, side * 0.45f * s.half_width, 0.33f * s.half_width, mesh);
    } else {
      add_boss(s, s.joint, side * 0.33f * s.half_width, 0.17f * s.half_width, mesh);
      add_boss(s, -s.joint, side * 0.66f * s.half_width, 0.13f * s.half_width, mesh);
    }
  }
}

/// One end of a pin at `x`, where the sprocket drives a single pin, with the nut outside. `side`: +1 or -1.
void add_pin_end(const LinkShape& s, float x, float side, Mesh& mesh) {
  const float inside = s.plate_half_y - 0.02f, nut = 0.93f * s.half_width, outside = s.half_width, wide = 1.3f * s.pin;
  const int segments = s.detail.segments(s.pin);
  Mesh end;  // towards +y
  if (!s.double_pin && s.detail.shows(0.5f * s.pin)) {
    end.add_lathe({{s.pin, inside}, {s.pin, nut}, {wide, nut}, {wide, outside}, {0, outside}}, segments,
                  Vector3f::Zero(), k_worn_steel);
  } else {
    end.add_lathe({{s.pin, inside}, {s.pin, outside}, {0, outside}}, segments, Vector3f::Zero(), k_worn_steel);
  }
  const float turn = side > 0.0f ? 0.0f : static_cast<float>(k_pi);
  mesh.append(end, Eigen::Translation3f(x, 0, 0) * Eigen::Affine3f(Eigen::AngleAxisf(turn, Vector3f::UnitZ())));
}

/// A bar round two pins, `length` apart along x: flat faces and round ends.
void add_connector_bar(float length, float radius, float y0, float y1, const Detail& detail, Mesh& mesh) {
  std::vector<Vector2f> outline;                                  // x, z
  const int half = 2 * std::max(2, detail.segments(radius) / 4);  // a corner at the very end
  for (const float end : {1.0f, -1.0f}) {
    for (int i = 0; i <= half; ++i) {
      const auto angle =
          static_cast<float>(k_pi * (static_cast<double>(i) / half - 0.5)) + (end < 0.0f ? 3.14159265f : 0.0f);
      outline.emplace_back(0.5f * end * length + radius * std::cos(angle), radius * std::sin(angle));
    }
  }
  const auto at = [](const Vector2f& p, float y) { return Vector3f(p.x(), y, p.y()); };
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vector2f &p = outline[i], &q = outline[(i + 1) % outline.size()];
    mesh.add_quad(at(p, y0), at(p, y1), at(q, y1), at(q, y0), k_forged_steel);
    if (i > 0 && i + 1 < outline.size()) {
      mesh.add_triangle(at(outline[0], y1), at(q, y1), at(p, y1), k_forged_steel);
      mesh.add_triangle(at(outline[0], y0), at(p, y0), at(q, y0), k_forged_steel);
    }
  }
}

}  // namespace

Mesh link_mesh(const Track& track, const Detail& detail) {
  const LinkShape shape(track, detail);
  Mesh mesh;
  add_plate(shape, mesh);
  add_grousers(shape, mesh);
  add_guide(track, shape, mesh);
  add_bosses(shape, mesh);
  for (const float side : {-1.0f, 1.0f}) {
    add_pin_end(shape, shape.joint, side, mesh);
    if (shape.double_pin) add_pin_end(shape, -shape.joint, side, mesh);
  }
  return mesh;
}

Mesh connector_mesh(const Track& track, const Detail& detail) {
  const LinkShape s(track, detail);
  const auto length = static_cast<float>(track.connector.length);
  const float ends = 0.915f * s.half_width, center = 0.09f * s.half_width;
  Mesh mesh;
  add_connector_bar(length, 1.3f * s.pin, ends, s.half_width - 0.004f, detail, mesh);
  add_connector_bar(length, 1.3f * s.pin, -s.half_width + 0.004f, -ends, detail, mesh);
  add_connector_bar(length, 1.3f * s.pin, -center, center, detail, mesh);
  // What the sprocket drives: the middle of the joint.
  for (const float side : {-1.0f, 1.0f}) {
    const float a = std::min(side * s.plate_half_y, side * ends), b = std::max(side * s.plate_half_y, side * ends);
    mesh.add_lathe({{0, a}, {s.pin, a}, {s.pin, b}, {0, b}}, detail.segments(s.pin), Vector3f::Zero(), k_worn_steel);
  }
  return mesh;
}

Mesh link_shadow_mesh(const Track& track) {
  const LinkShape shape(track, {});
  Mesh mesh;
  const Vector2f half(shape.half_pitch, shape.plate_half_y);
  mesh.add_frustum({0, 0, shape.ground}, half, shape.plate_top - shape.ground, half, k_cast_steel);
  mesh.add_frustum({shape.half_pitch, 0, -shape.pin}, {shape.pin, shape.half_width}, 2.0f * shape.pin,
                   {shape.pin, shape.half_width}, k_cast_steel);
  const auto guide = static_cast<float>(track.guide_height);
  mesh.add_frustum({0, 0, shape.plate_top}, {0.5f * shape.half_pitch, 0.03f}, guide, {0.2f * shape.half_pitch, 0.012f},
                   k_cast_steel, true);
  return mesh;
}

}  // namespace grouser
