#include "render/camera.h"

#include <algorithm>
#include <cmath>

#include "model/errors.h"
#include "render/render.h"

namespace grouser {
namespace {

constexpr double k_orbit_period = 20.0;  ///< s

Matrix4f perspective(float field_of_view, float aspect, float near_plane, float far_plane) {
  const float f = 1.0f / std::tan(0.5f * field_of_view), depth = near_plane - far_plane;
  Matrix4f m = Matrix4f::Zero();
  m(0, 0) = f / aspect;
  m(1, 1) = f;
  m(2, 2) = (far_plane + near_plane) / depth;
  m(2, 3) = 2.0f * far_plane * near_plane / depth;
  m(3, 2) = -1.0f;
  return m;
}

/// Places offsets given in a frame that follows the vehicle over the ground and looks along `heading`.
struct Follower {
  Vector3f origin;
  Eigen::AngleAxisf turn;
  Follower(const Subject& subject, double heading)
      : origin(static_cast<float>(subject.pose.chassis.position.x()),
               static_cast<float>(subject.pose.chassis.position.y()), subject.ground),
        turn(static_cast<float>(heading), Vector3f::UnitZ()) {}
  [[nodiscard]] Vector3f at(float x, float y, float z) const { return origin + turn * Vector3f(x, y, z); }
};

Camera perspective_camera(const Vector3f& eye, const Vector3f& target, float degrees) {
  Camera camera;
  camera.eye = eye;
  camera.target = target;
  camera.field_of_view = degrees * static_cast<float>(k_pi) / 180.0f;
  return camera;
}

/// What stands between eye and target is cut away half a metre before the target when the ground is shown in section.
Camera parallel_camera(const Vector3f& eye, const Vector3f& target, float height) {
  Camera camera;
  camera.eye = eye;
  camera.target = target;
  camera.parallel_height = height;
  camera.far_plane = 150.0f;
  if (camera.shows_section()) camera.near_plane = std::max(0.01f, (target - eye).norm() - 0.5f);
  return camera;
}

/// `up` may not lie along the line of sight.
void keep_up_apart(Camera& camera, const Vector3f& forward) {
  const Vector3f along = (camera.target - camera.eye).normalized();
  if (std::abs(along.z()) > 0.999f) camera.up = forward;
}

}  // namespace

Matrix4f look_at(const Vector3f& eye, const Vector3f& target, const Vector3f& up) {
  const Vector3f back = (eye - target).normalized(), right = up.cross(back).normalized(), above = back.cross(right);
  Matrix4f m = Matrix4f::Identity();
  m.block<1, 3>(0, 0) = right.transpose();
  m.block<1, 3>(1, 0) = above.transpose();
  m.block<1, 3>(2, 0) = back.transpose();
  m(0, 3) = -right.dot(eye);
  m(1, 3) = -above.dot(eye);
  m(2, 3) = -back.dot(eye);
  return m;
}

Matrix4f parallel_projection(float half_x, float half_y, float near_plane, float far_plane) {
  Matrix4f m = Matrix4f::Identity();
  m(0, 0) = 1.0f / half_x;
  m(1, 1) = 1.0f / half_y;
  m(2, 2) = -2.0f / (far_plane - near_plane);
  m(2, 3) = -(far_plane + near_plane) / (far_plane - near_plane);
  return m;
}

Matrix4f Camera::view_projection(float aspect) const {
  const float half = 0.5f * parallel_height;
  const Matrix4f projection = parallel_height > 0.0f ? parallel_projection(aspect * half, half, near_plane, far_plane)
                                                     : perspective(field_of_view, aspect, near_plane, far_plane);
  return projection * look_at(eye, target, up);
}

float Camera::pixels_per_metre(float distance, int height) const {
  const float seen =
      parallel_height > 0.0f ? parallel_height : 2.0f * std::max(distance, near_plane) * std::tan(0.5f * field_of_view);
  return static_cast<float>(height) / seen;
}

double heading_of(const Quaterniond& orientation) {
  const Vector3d forward = orientation * Vector3d::UnitX();
  return std::atan2(forward.y(), forward.x());
}

std::vector<std::string> camera_names() { return {"chase", "side", "front", "sprocket", "road_wheel", "top", "orbit"}; }

Camera make_camera(const std::string& name, const Subject& subject, float aspect) {
  const double heading = heading_of(subject.pose.chassis.orientation);
  const Follower body(subject, heading), start(subject, subject.start_heading);
  const float middle = 0.5f * (subject.front + subject.rear), length = subject.front - subject.rear;
  if (name == "chase")
    // Far enough that a gun stays in the picture at every heading.
    return perspective_camera(start.at(1.36f * length, -1.16f * length, 0.55f * length), start.at(middle, 0.0f, 1.15f),
                              36.0f);
  if (name == "front")
    return perspective_camera(body.at(1.9f * length, -0.18f * length, 0.22f * length), body.at(middle, 0.0f, 1.1f),
                              24.0f);
  if (name == "sprocket") {
    const Vector3f& s = subject.sprocket;
    return perspective_camera(body.at(s.x() - 0.75f, -(subject.half_width + 2.35f), s.z() + 0.5f),
                              body.at(s.x() + 0.22f, s.y(), s.z() - 0.08f), 36.0f);
  }
  if (name == "road_wheel") {
    const Vector3f& w = subject.wheel;
    return perspective_camera(body.at(w.x() - 0.55f, -(subject.half_width + 1.9f), w.z() + 0.42f),
                              body.at(w.x() + 0.1f, w.y(), w.z() - 0.02f), 33.0f);
  }
  if (name == "top") {  // the front points to the right
    // Room for the legends' corner behind.
    const float center = 0.5f * (subject.nose + subject.tail), around = subject.nose - subject.tail + 3.4f;
    const float height = std::max(around / aspect, 2.0f * subject.half_width + 1.6f);
    Camera camera = parallel_camera(body.at(center, 0.0f, 30.0f), body.at(center, 0.0f, 0.0f), height);
    camera.up = body.turn * Vector3f::UnitY();
    return camera;
  }
  if (name == "orbit") {
    const double angle = subject.start_heading - 0.9 + 2.0 * k_pi * subject.pose.time / k_orbit_period;
    const Follower round(subject, angle);
    const float reach = std::max(subject.nose, -subject.tail);  // so that what turns past the eye stays in the picture
    return perspective_camera(round.at(1.0f * length + 1.1f * reach, 0.0f, 0.58f * length),
                              round.origin + Vector3f(0, 0, 1.0f), 36.0f);
  }
  if (name == "side") {
    const float height = (subject.nose - subject.tail + 0.9f) / aspect;  // all of it, and a margin
    const float outside = -(subject.half_width + 0.03f), up = 0.27f * height;
    const float center = 0.5f * (subject.nose + subject.tail);
    return parallel_camera(body.at(center, outside - 20.0f, up), body.at(center, outside, up), height);
  }
  std::string known;
  for (const std::string& each : camera_names()) known += (known.empty() ? "" : ", ") + each;
  throw InputError({"", "camera", "one of " + known, name, ""});
}

Camera make_camera(const CameraView& view, const Subject& subject) {
  const BodyPose& chassis = subject.pose.chassis;
  const Follower follower(subject,
                          view.mount == CameraMount::follow ? subject.start_heading : heading_of(chassis.orientation));
  const auto placed = [&](const Vector3d& p) -> Vector3f {
    if (view.mount == CameraMount::world) return p.cast<float>();
    if (view.mount == CameraMount::chassis) return (chassis.position + chassis.orientation * p).eval().cast<float>();
    const Vector3f q = p.cast<float>();
    return follower.at(q.x(), q.y(), q.z());
  };
  const Vector3f eye = placed(view.eye), target = placed(view.target);
  Camera camera = view.height ? parallel_camera(eye, target, static_cast<float>(*view.height))
                              : perspective_camera(eye, target, static_cast<float>(view.field_of_view * 180.0 / k_pi));
  keep_up_apart(camera, follower.turn * Vector3f::UnitX());
  return camera;
}

}  // namespace grouser
