#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "model/scenario.h"
#include "render/camera.h"
#include "render/mesh.h"
#include "render/pose.h"

/// What a picture shows, as plain data without GL.
namespace grouser {

struct SceneMesh {
  Mesh shape;               ///< for up to Detail::k_middle pixels a metre
  Mesh shadow;              ///< coarser outline for the shadow map; empty = shape
  bool annotation = false;  ///< drawn after all else, faintly where it is hidden; casts no shadow
  Mesh coarse{}, fine{};    ///< for up to Detail::k_coarse pixels a metre, and for more than k_middle; empty = shape
};

struct Instance {
  Matrix4f X_WB = Matrix4f::Identity();            ///< mesh to World
  Eigen::Vector4f tint = Eigen::Vector4f::Zero();  ///< linear colour and its share 0..1 of the mesh's own
  float glow = 0.0f;  ///< share 0..1 of the picture's brightness that does not come from the sun: colours of a legend
};

/// Rectangle on the ground under the vehicle, where little of the sky is seen.
struct Footprint {
  Vector2f center = Vector2f::Zero(), half = Vector2f::Zero();  ///< m
  float heading = 0.0f;                                         ///< rad
};

struct Scene {
  std::shared_ptr<const std::vector<SceneMesh>> meshes;
  std::vector<std::vector<Instance>> instances;  ///< of each mesh
  Camera camera;
  Vector3f sun = Vector3f(0.42f, -0.55f, 0.85f).normalized();  ///< towards it
  Vector3f shadow_center = Vector3f::Zero();                   ///< the shadow map covers a sphere
  float shadow_radius = 5.0f;                                  ///< m
  Footprint footprint;
  bool ground = true;
  std::shared_ptr<const Mesh> terrain;     ///< in World, drawn as ground; without it the ground is the plane z = 0
  std::optional<std::size_t> see_through;  ///< a mesh of which little is drawn, so that what it hides is seen
  Mesh section;  ///< of the ground, in World; the normal's z is the depth below the surface [m]
  Mesh trails;   ///< annotation in World
};

/// Meshes of one vehicle, built once and placed by poses.
class VehicleModel {
 public:
  /// Every tenth link is tinted so that the track's motion is seen, and the probe links more strongly.
  explicit VehicleModel(const Vehicle& vehicle, const std::vector<ProbeLink>& probes = {});

  /// The vehicle as posed; camera at its default.
  [[nodiscard]] Scene place(const VehiclePose& pose) const;
  /// A mesh of the caller's own; its index in Scene::instances of scenes placed from now on.
  [[nodiscard]] std::size_t add_annotation(Mesh shape);
  /// Colours the links of one side, linear RGB each.
  void color_links(Scene& scene, Side side, const std::vector<Vector3f>& colors, float glow) const;
  [[nodiscard]] std::size_t chassis_mesh_index() const { return chassis_mesh_; }
  /// For make_camera().
  [[nodiscard]] Subject subject(const VehiclePose& pose, double start_heading) const;

 private:
  struct SideMeshes {
    std::vector<std::size_t> arms, wheels, rollers;
    std::size_t idler_arm = 0, idler = 0, sprocket = 0, link = 0;
    std::optional<std::size_t> connector;  ///< of double pins
  };
  Vehicle vehicle_;
  std::vector<ProbeLink> probes_;
  std::shared_ptr<std::vector<SceneMesh>> meshes_;
  std::size_t chassis_mesh_ = 0;
  float nose_ = 0.0f, tail_ = 0.0f;  ///< m, ends of the chassis in V
  std::array<SideMeshes, k_num_sides> side_meshes_;
};

}  // namespace grouser
