#include <algorithm>
#include <cmath>

#include "render/pose.h"

namespace grouser {
namespace {

using Eigen::Vector2d;

/// One wheel that the pin line goes round: centre (x, z) and distance of the pin line from it.
struct Bend {
  Vector2d center;
  double radius = 0.0;
};

/// Points of the taut line (outer hull of the bends' circles and the ground run), close together.
std::vector<Vector2d> taut_line(const std::vector<Bend>& bends) {
  constexpr int k_points = 180;
  std::vector<Vector2d> points;
  for (const Bend& bend : bends) {
    for (int i = 0; i < k_points; ++i) {
      const double angle = 2.0 * k_pi * i / k_points;
      points.emplace_back(bend.center + bend.radius * Vector2d(std::cos(angle), std::sin(angle)));
    }
  }
  std::sort(points.begin(), points.end(),
            [](const Vector2d& a, const Vector2d& b) { return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y()); });
  const auto turns_right = [](const Vector2d& o, const Vector2d& a, const Vector2d& b) {
    return (a - o).x() * (b - o).y() - (a - o).y() * (b - o).x() <= 0.0;
  };
  std::vector<Vector2d> hull;
  for (int half = 0; half < 2; ++half) {  // lower half to the right, upper half back
    const std::size_t start = hull.size();
    for (const Vector2d& p : points) {
      while (hull.size() >= start + 2 && turns_right(hull[hull.size() - 2], hull.back(), p)) hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

/// Point at arc length s of a closed polyline.
Vector2d point_at(const std::vector<Vector2d>& line, double length, double s) {
  s = std::fmod(std::fmod(s, length) + length, length);
  for (std::size_t i = 0; i < line.size(); ++i) {
    const Vector2d a = line[i], step = line[(i + 1) % line.size()] - a;
    if (s <= step.norm()) return a + s * step.normalized();
    s -= step.norm();
  }
  return line.front();
}

std::vector<BodyPose> links_along(const RunningGear& gear, double travel) {
  const Track& track = gear.track;
  std::vector<Bend> bends;
  const auto bend = [&](const DiscPair& wheel) {
    bends.push_back({{wheel.center.x(), wheel.center.z()}, wheel.radius + track.wheel_path_height});
  };
  for (const Station& station : gear.stations) bend(station.wheel);
  for (const DiscPair& roller : gear.support_rollers) bend(roller);
  bend(gear.idler.wheel);
  bends.push_back(
      {{gear.sprocket.center.x(), gear.sprocket.center.z()}, gear.sprocket.teeth * track.pitch / (2.0 * k_pi)});
  const std::vector<Vector2d> line = taut_line(bends);
  double length = 0.0;
  for (std::size_t i = 0; i < line.size(); ++i) length += (line[(i + 1) % line.size()] - line[i]).norm();
  std::vector<BodyPose> links;
  for (int i = 0; i < track.num_links; ++i) {
    // The ground run is walked towards the front, so that links stay behind as the vehicle moves on: minus the travel.
    const Vector2d a = point_at(line, length, length * i / track.num_links - travel);
    const Vector2d b = point_at(line, length, length * (i + 1) / track.num_links - travel);
    const Vector2d middle = 0.5 * (a + b), along = b - a;
    const double angle = -std::atan2(along.y(), along.x());  // a turn about +y takes +x towards -z
    links.push_back(
        {{middle.x(), gear.track_center_y, middle.y()}, Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitY()))});
  }
  return links;
}

}  // namespace

VehiclePose design_pose(const Vehicle& vehicle, double travel) {
  VehiclePose pose;
  for (std::size_t s = 0; s < k_num_sides; ++s) {
    const RunningGear& gear = vehicle.sides[s];
    const double height = gear.track.wheel_path_height;
    SideAngles& angles = pose.angles[s];
    for (const Station& station : gear.stations) {
      angles.arms.push_back(0.0);
      angles.wheels.push_back(travel / (station.wheel.radius + height));
    }
    for (const DiscPair& roller : gear.support_rollers) angles.rollers.push_back(travel / (roller.radius + height));
    angles.idler = travel / (gear.idler.wheel.radius + height);
    angles.sprocket = 2.0 * k_pi * travel / (gear.sprocket.teeth * gear.track.pitch);
    pose.links[s] = links_along(gear, travel);
  }
  return pose;
}

}  // namespace grouser
