#include <cmath>

#include "render/parts.h"

namespace grouser {
namespace {

const Material k_cast_steel{{0.34f, 0.345f, 0.35f}, 0.45f};
const Material k_worn_steel{{0.50f, 0.50f, 0.49f}, 0.8f};
const Material k_pad_rubber{{0.19f, 0.19f, 0.195f}, 0.06f};

/// Dimensions of the picture that follow from the track's own.
struct LinkShape {
  float half_pitch, half_width, pin, boss, plate_half_x, plate_half_y, plate_top, plate_bottom, ground;
  explicit LinkShape(const Track& track)
      : half_pitch(static_cast<float>(0.5 * track.pitch)),
        half_width(static_cast<float>(0.5 * track.shoe_width)),
        pin(static_cast<float>(track.pin_radius)),
        boss(static_cast<float>(std::min(1.55 * track.pin_radius, 0.9 * track.wheel_path_height))),
        plate_half_x(half_pitch - 1.12f * boss),
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
  mesh.add_frustum({0, 0, s.plate_top}, base, 0.8f * height, shoulder, k_cast_steel, true);
  mesh.add_frustum({0, 0, s.plate_top + 0.8f * height}, shoulder, 0.2f * height, 0.6f * top, k_cast_steel, true);
}

/// Bosses of this link at its leading joint in the middle of the shoe, at its trailing joint further out, so that
/// neighbours interlock; only the half of each that stands out of the plate.
void add_bosses(const LinkShape& s, Mesh& mesh) {
  const auto boss = [&](float joint_x, float center_y, float half_y) {
    const float from = joint_x > 0.0f ? -1.9f : 1.2416f;
    mesh.add_lathe({{0, -half_y}, {s.boss, -half_y}, {s.boss, half_y}, {0, half_y}}, 5, {joint_x, center_y, 0},
                   k_cast_steel, from, from + 3.8f);
  };
  for (const float side : {-1.0f, 1.0f}) {
    boss(s.half_pitch, side * 0.33f * s.half_width, 0.17f * s.half_width);
    boss(-s.half_pitch, side * 0.66f * s.half_width, 0.13f * s.half_width);
  }
}

/// The pin's ends, where the sprocket drives, with the nut outside.
void add_pin(const LinkShape& s, Mesh& mesh) {
  const float inside = s.plate_half_y - 0.02f, nut = 0.93f * s.half_width, outside = s.half_width;
  mesh.add_lathe({{s.pin, inside}, {s.pin, nut}, {1.3f * s.pin, nut}, {1.3f * s.pin, outside}, {0, outside}}, 8,
                 {s.half_pitch, 0, 0}, k_worn_steel);
  mesh.add_lathe({{0, -outside}, {1.3f * s.pin, -outside}, {1.3f * s.pin, -nut}, {s.pin, -nut}, {s.pin, -inside}}, 8,
                 {s.half_pitch, 0, 0}, k_worn_steel);
}

}  // namespace

Mesh link_mesh(const Track& track) {
  const LinkShape shape(track);
  Mesh mesh;
  add_plate(shape, mesh);
  add_grousers(shape, mesh);
  add_guide(track, shape, mesh);
  add_bosses(shape, mesh);
  add_pin(shape, mesh);
  return mesh;
}

Mesh link_shadow_mesh(const Track& track) {
  const LinkShape shape(track);
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
