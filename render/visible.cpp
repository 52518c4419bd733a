#include "render/visible.h"

#include <algorithm>
#include <array>

namespace grouser {
namespace {

/// The six planes of a picture, inside positive.
class Frustum {
 public:
  explicit Frustum(const Matrix4f& view_projection) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const float sign : {-1.0f, 1.0f}) {
        Eigen::Vector4f plane = (view_projection.row(3) + sign * view_projection.row(axis)).transpose();
        planes_[static_cast<std::size_t>(2 * axis + (sign > 0.0f ? 1 : 0))] = plane / plane.head<3>().norm();
      }
    }
  }
  /// False when every point within `radius` of the line from a to b lies behind one of the planes.
  [[nodiscard]] bool may_hold(const Vector3f& a, const Vector3f& b, float radius) const {
    return std::none_of(planes_.begin(), planes_.end(), [&](const Eigen::Vector4f& plane) {
      const auto inside = [&plane](const Vector3f& p) { return plane.head<3>().dot(p) + plane.w(); };
      return std::max(inside(a), inside(b)) < -radius;
    });
  }

 private:
  std::array<Eigen::Vector4f, 6> planes_;
};

struct PlacedInstance {
  const Instance* instance;
  Ball ball;  ///< in World
  float distance;
};

Ball placed(const Ball& ball, const Matrix4f& X_WB) {
  const float scale = X_WB.topLeftCorner<3, 3>().colwise().norm().maxCoeff();
  return {X_WB.topLeftCorner<3, 3>() * ball.center + X_WB.topRightCorner<3, 1>(), scale * ball.radius};
}

/// Instances of one mesh, nearest first, in groups of equal detail.
void add_groups(std::size_t mesh, std::vector<PlacedInstance> instances, const Camera& camera, int height,
                std::vector<PartGroup>& groups) {
  std::stable_sort(instances.begin(), instances.end(),
                   [](const PlacedInstance& a, const PlacedInstance& b) { return a.distance < b.distance; });
  for (const PlacedInstance& each : instances) {
    const Detail::Level level = Detail::level_for(camera.pixels_per_metre(each.distance, height));
    if (groups.empty() || groups.back().mesh != mesh || groups.back().level != level)
      groups.push_back({mesh, level, each.distance, 0, {}});
    groups.back().instances.push_back(each.instance);
  }
}

void sort_by_distance(std::vector<PartGroup>& groups) {
  std::stable_sort(groups.begin(), groups.end(),
                   [](const PartGroup& a, const PartGroup& b) { return a.distance < b.distance; });
}

}  // namespace

Ball ball_round(const Mesh& mesh) {
  Eigen::AlignedBox3f box;
  for (const Vertex& vertex : mesh.vertices) box.extend(vertex.position);
  return box.isEmpty() ? Ball{} : Ball{box.center(), 0.5f * box.diagonal().norm()};
}

VisibleParts visible_parts(const Scene& scene, const std::vector<Ball>& balls, int width, int height) {
  const Camera& camera = scene.camera;
  const Frustum frustum(camera.view_projection(static_cast<float>(width) / static_cast<float>(height)));
  const Vector3f shade = -2.0f * scene.shadow_radius * scene.sun;  // no shadow in the map is longer
  VisibleParts visible;
  for (std::size_t mesh = 0; mesh < scene.instances.size(); ++mesh) {
    const bool annotation = (*scene.meshes)[mesh].annotation;
    std::vector<PlacedInstance> seen, casting;
    for (const Instance& instance : scene.instances[mesh]) {
      const Ball ball = placed(balls[mesh], instance.X_WB);
      const PlacedInstance each{&instance, ball, camera.distance_of(ball.center) - ball.radius};
      if (frustum.may_hold(ball.center, ball.center, ball.radius)) seen.push_back(each);
      if (!annotation && frustum.may_hold(ball.center, ball.center + shade, ball.radius)) casting.push_back(each);
    }
    std::vector<PartGroup>& groups = annotation                  ? visible.annotations
                                     : scene.see_through == mesh ? visible.see_through
                                                                 : visible.solids;
    add_groups(mesh, std::move(seen), camera, height, groups);
    add_groups(mesh, std::move(casting), camera, height, visible.casters);
  }
  for (std::vector<PartGroup>* groups : {&visible.solids, &visible.see_through, &visible.annotations})
    sort_by_distance(*groups);
  std::size_t count = 0;
  for (std::vector<PartGroup>* groups :
       {&visible.solids, &visible.see_through, &visible.annotations, &visible.casters}) {
    for (PartGroup& group : *groups) {
      group.first = count;
      count += group.instances.size();
    }
  }
  return visible;
}

std::vector<const Instance*> VisibleParts::instances() const {
  std::vector<const Instance*> all;
  for (const std::vector<PartGroup>* groups : {&solids, &see_through, &annotations, &casters})
    for (const PartGroup& group : *groups) all.insert(all.end(), group.instances.begin(), group.instances.end());
  return all;
}

}  // namespace grouser
