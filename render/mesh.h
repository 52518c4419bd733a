#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "render/figure.h"

/// Triangles with normals and colours, built from boxes, lathed profiles and outlines. Metres; counter-clockwise seen
/// from outside, so that back faces can be culled.
namespace grouser {

using Eigen::Vector2f;
using Eigen::Vector3f;

/// sRGB 0..1 from "#rrggbb". Throws InputError for anything else.
[[nodiscard]] Rgb parse_color(const std::string& text);

/// The same in linear light.
[[nodiscard]] Vector3f linear_rgb(const Rgb& color);

/// Look of a surface.
struct Material {
  Rgb color{0.5f, 0.5f, 0.5f};  ///< sRGB
  float gloss = 0.2f;           ///< 0 rubber .. 1 polished
};

struct Vertex {
  Vector3f position, normal;
  Vector3f color;  ///< linear
  float gloss = 0.0f;
};

struct Mesh {
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;

  [[nodiscard]] std::size_t num_triangles() const { return indices.size() / 3; }
  void add_triangle(const Vector3f& a, const Vector3f& b, const Vector3f& c, const Material& material);
  void add_triangle(const std::array<Vector3f, 3>& corners, const std::array<Vector3f, 3>& normals,
                    const Material& material);
  /// Flat; the corners lie in one plane.
  void add_quad(const Vector3f& a, const Vector3f& b, const Vector3f& c, const Vector3f& d, const Material& material);
  /// A box whose edges are cut at 45 degrees by `bevel` (0: sharp).
  void add_box(const Vector3f& center, const Vector3f& half, float bevel, const Material& material);
  /// A frustum along z with rectangular ends; the lower end stays open when `open_base`.
  void add_frustum(const Vector3f& base_center, const Vector2f& base_half, float height, const Vector2f& top_half,
                   const Material& material, bool open_base = false);
  /// Turns the profile of points (radius, y) about the y axis through `center`, over the angles [from, to] (0 = +x,
  /// rising towards +z). A profile that runs from the axis on the -y side outwards and back to the axis closes the
  /// body.
  void add_lathe(const std::vector<Vector2f>& profile, int segments, const Vector3f& center, const Material& material,
                 float from = 0.0f, float to = 6.2831853f);
  void append(const Mesh& other, const Eigen::Affine3f& placed);
  /// Keeps one of equal vertices: less than half remain.
  void weld();
};

}  // namespace grouser
