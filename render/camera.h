#pragma once
#include <optional>
#include <string>
#include <vector>

#include "model/camera_view.h"
#include "render/mesh.h"
#include "render/pose.h"

namespace grouser {

using Eigen::Matrix4f;

/// A view of World. Parallel when `parallel_height` > 0 (metres across the picture's height), else a perspective.
struct Camera {
  Vector3f eye{10, -10, 5}, target = Vector3f::Zero(), up = Vector3f::UnitZ();
  float field_of_view = 0.6f;    ///< rad, vertical, of a perspective
  float parallel_height = 0.0f;  ///< m
  float near_plane = 0.3f, far_plane = 400.0f;

  /// A parallel view along the horizon: the ground is edge-on, so it is shown cut open at the target.
  [[nodiscard]] bool shows_section() const {
    return parallel_height > 0.0f && std::abs((target - eye).normalized().z()) < 1e-3f;
  }

  /// How far a point lies behind the eye, along the line of sight of a parallel view [m].
  [[nodiscard]] float distance_of(const Vector3f& p) const {
    return parallel_height > 0.0f ? (target - eye).normalized().dot(p - eye) : (p - eye).norm();
  }
  /// Size of a metre across the line of sight in a picture of `height` pixels; before the near plane as on it.
  [[nodiscard]] float pixels_per_metre(float distance, int height) const;
  /// World to clip space for a picture of the given width / height.
  [[nodiscard]] Matrix4f view_projection(float aspect) const;
};

/// Right-handed view matrix, looking along -z.
[[nodiscard]] Matrix4f look_at(const Vector3f& eye, const Vector3f& target, const Vector3f& up);
/// Box of half extents (half_x, half_y) between the planes at `near_plane` and `far_plane` in front of the eye.
[[nodiscard]] Matrix4f parallel_projection(float half_x, float half_y, float near_plane, float far_plane);

/// What a camera looks at and where it stood when the run began.
struct Subject {
  VehiclePose pose;
  double start_heading = 0.0;            ///< rad about z at the run's first sample
  Vector3f sprocket = Vector3f::Zero();  ///< centre of the right sprocket in V
  Vector3f wheel = Vector3f::Zero();     ///< centre of the right road wheel in the middle, in V
  float front = 3.5f, rear = -3.5f;      ///< m, ends of the running gear in V
  float half_width = 1.7f;               ///< m, outside of the tracks
  float nose = 3.5f, tail = -3.5f;       ///< m, ends of all that is drawn, a gun too, in V
  float ground = 0.0f;                   ///< m, height of the plane under the vehicle
};

/// `chase` keeps the heading of the start, so that a turn is seen as a turn; `orbit` goes round once in 20 s; the
/// others follow the heading; `side` is an elevation and `top` a plan. `aspect`: width / height. Throws InputError for
/// another name.
[[nodiscard]] Camera make_camera(const std::string& name, const Subject& subject, float aspect);
[[nodiscard]] Camera make_camera(const CameraView& view, const Subject& subject);

[[nodiscard]] double heading_of(const Quaterniond& orientation);

}  // namespace grouser
