#include "render/mesh.h"

#include <charconv>
#include <cmath>
#include <unordered_map>

#include "model/errors.h"

namespace grouser {
namespace {

/// sRGB transfer function, decoded (IEC 61966-2-1).
float linear(float s) { return s <= 0.04045f ? s / 12.92f : std::pow((s + 0.055f) / 1.055f, 2.4f); }

}  // namespace

Vector3f linear_rgb(const Rgb& color) { return {linear(color[0]), linear(color[1]), linear(color[2])}; }

Rgb parse_color(const std::string& text) {
  Rgb color{};
  bool good = text.size() == 7 && text[0] == '#';
  for (std::size_t i = 0; good && i < 3; ++i) {
    int value = 0;
    const char* first = text.data() + 1 + 2 * i;
    const auto [end, error] = std::from_chars(first, first + 2, value, 16);
    good = error == std::errc() && end == first + 2;
    color[i] = static_cast<float>(value) / 255.0f;
  }
  if (!good) throw InputError({"", "visual colour", "a colour as #rrggbb", text, ""});
  return color;
}

void Mesh::add_triangle(const std::array<Vector3f, 3>& corners, const std::array<Vector3f, 3>& normals,
                        const Material& material) {
  const Vector3f color = linear_rgb(material.color);
  for (std::size_t i = 0; i < 3; ++i) {
    indices.push_back(static_cast<std::uint32_t>(vertices.size()));
    vertices.push_back({corners[i], normals[i], color, material.gloss});
  }
}

void Mesh::add_triangle(const Vector3f& a, const Vector3f& b, const Vector3f& c, const Material& material) {
  const Vector3f normal = (b - a).cross(c - a).normalized();
  add_triangle({a, b, c}, {normal, normal, normal}, material);
}

void Mesh::add_quad(const Vector3f& a, const Vector3f& b, const Vector3f& c, const Vector3f& d,
                    const Material& material) {
  const Vector3f normal = (c - a).cross(d - b).normalized();
  add_triangle({a, b, c}, {normal, normal, normal}, material);
  add_triangle({a, c, d}, {normal, normal, normal}, material);
}

void Mesh::add_box(const Vector3f& center, const Vector3f& half, float bevel, const Material& material) {
  // Corner (sx, sy, sz) of the face across `axis`: on the face, drawn in by the bevel along the other two axes.
  const auto corner = [&](int axis, float sx, float sy, float sz) {
    Vector3f at = Vector3f(sx, sy, sz).cwiseProduct(half - Vector3f::Constant(bevel));
    at[axis] += (axis == 0 ? sx : axis == 1 ? sy : sz) * bevel;
    return Vector3f(center + at);
  };
  const auto outward_quad = [&](Vector3f a, const Vector3f& b, Vector3f c, const Vector3f& d) {
    if ((c - a).cross(d - b).dot(0.25f * (a + b + c + d) - center) < 0.0f) std::swap(a, c);
    add_quad(a, b, c, d, material);
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const auto signs = [&](float sa, float su, float sv) {
      Vector3f s;
      s[axis] = sa;
      s[u] = su;
      s[v] = sv;
      return s;
    };
    const auto at = [&](int face, const Vector3f& s) { return corner(face, s.x(), s.y(), s.z()); };
    for (const float sa : {-1.0f, 1.0f}) {
      outward_quad(at(axis, signs(sa, -1, -1)), at(axis, signs(sa, 1, -1)), at(axis, signs(sa, 1, 1)),
                   at(axis, signs(sa, -1, 1)));
      if (bevel <= 0.0f) continue;
      for (const float su : {-1.0f, 1.0f}) {  // the cut edge between the faces across `axis` and `u`
        outward_quad(at(axis, signs(sa, su, -1)), at(axis, signs(sa, su, 1)), at(u, signs(sa, su, 1)),
                     at(u, signs(sa, su, -1)));
      }
    }
  }
  if (bevel <= 0.0f) return;
  for (const float sx : {-1.0f, 1.0f}) {
    for (const float sy : {-1.0f, 1.0f}) {
      for (const float sz : {-1.0f, 1.0f}) {
        const Vector3f a = corner(0, sx, sy, sz), b = corner(1, sx, sy, sz), c = corner(2, sx, sy, sz);
        if (sx * sy * sz > 0.0f) add_triangle(a, b, c, material);
        if (sx * sy * sz < 0.0f) add_triangle(a, c, b, material);
      }
    }
  }
}

void Mesh::add_frustum(const Vector3f& base_center, const Vector2f& base_half, float height, const Vector2f& top_half,
                       const Material& material, bool open_base) {
  std::array<Vector3f, 4> base, top;
  const std::array<Vector2f, 4> signs{Vector2f(-1, -1), Vector2f(1, -1), Vector2f(1, 1), Vector2f(-1, 1)};
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector2f b = signs[i].cwiseProduct(base_half), t = signs[i].cwiseProduct(top_half);
    base[i] = base_center + Vector3f(b.x(), b.y(), 0.0f);
    top[i] = base_center + Vector3f(t.x(), t.y(), height);
  }
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t k = (i + 1) % 4;
    if (height > 0.0f) add_quad(base[i], base[k], top[k], top[i], material);
    if (height < 0.0f) add_quad(base[i], top[i], top[k], base[k], material);
  }
  if (height > 0.0f) add_quad(top[0], top[1], top[2], top[3], material);
  if (height < 0.0f) add_quad(top[3], top[2], top[1], top[0], material);
  if (!open_base && height > 0.0f) add_quad(base[3], base[2], base[1], base[0], material);
  if (!open_base && height < 0.0f) add_quad(base[0], base[1], base[2], base[3], material);
}

void Mesh::add_lathe(const std::vector<Vector2f>& profile, int segments, const Vector3f& center,
                     const Material& material, float from, float to) {
  for (std::size_t k = 0; k + 1 < profile.size(); ++k) {
    const Vector2f p = profile[k], q = profile[k + 1], along = (q - p).normalized();
    for (int i = 0; i < segments; ++i) {
      const float a = from + (to - from) * static_cast<float>(i) / static_cast<float>(segments);
      const float b = from + (to - from) * static_cast<float>(i + 1) / static_cast<float>(segments);
      const auto at = [&](const Vector2f& point, float angle) {
        return Vector3f(center + Vector3f(point.x() * std::cos(angle), point.y(), point.x() * std::sin(angle)));
      };
      const auto normal = [&](float angle) {
        return Vector3f(along.y() * std::cos(angle), -along.x(), along.y() * std::sin(angle));
      };
      if (q.x() > 0.0f) add_triangle({at(p, a), at(q, a), at(q, b)}, {normal(a), normal(a), normal(b)}, material);
      if (p.x() > 0.0f) add_triangle({at(p, a), at(q, b), at(p, b)}, {normal(a), normal(b), normal(b)}, material);
    }
  }
}

void Mesh::append(const Mesh& other, const Eigen::Affine3f& placed) {
  const auto first = static_cast<std::uint32_t>(vertices.size());
  for (const Vertex& vertex : other.vertices) {
    vertices.push_back(
        {placed * vertex.position, (placed.linear() * vertex.normal).normalized(), vertex.color, vertex.gloss});
  }
  for (const std::uint32_t index : other.indices) indices.push_back(first + index);
}

void Mesh::weld() {
  static_assert(sizeof(Vertex) == 10 * sizeof(float), "compared as bytes, so it must hold no padding");
  const auto bytes_of = [](const Vertex& vertex) {
    return std::string(reinterpret_cast<const char*>(&vertex), sizeof(Vertex));
  };
  std::unordered_map<std::string, std::uint32_t> known;
  std::vector<Vertex> kept;
  for (std::uint32_t& index : indices) {
    const Vertex& vertex = vertices[index];
    const auto [found, added] = known.emplace(bytes_of(vertex), static_cast<std::uint32_t>(kept.size()));
    if (added) kept.push_back(vertex);
    index = found->second;
  }
  vertices = std::move(kept);
}

}  // namespace grouser
