#include "render/ground_section.h"

namespace grouser {

Mesh ground_section(const GroundSurface& ground, const Camera& camera, float aspect) {
  constexpr float k_spacing = 0.02f;  // m
  const Vector3f right = (camera.target - camera.eye).cross(camera.up).normalized();
  const float half = 0.5f * camera.parallel_height * aspect + k_spacing, depth = 2.0f * camera.parallel_height;
  const int count = static_cast<int>(2.0f * half / k_spacing) + 1;
  const auto top = [&](int i) {
    const Vector3f at = camera.target + (static_cast<float>(i) * k_spacing - half) * right;
    return Vector3f(at.x(), at.y(), static_cast<float>(ground.top(at.x(), at.y())));
  };
  const Vector3f down(0.0f, 0.0f, -depth), deep(0.0f, 0.0f, depth), surface = Vector3f::Zero();
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const Vector3f a = top(i), b = top(i + 1);
    mesh.add_triangle({a, a + down, b + down}, {surface, deep, deep}, {});
    mesh.add_triangle({a, b + down, b}, {surface, deep, surface}, {});
  }
  return mesh;
}

}  // namespace grouser
