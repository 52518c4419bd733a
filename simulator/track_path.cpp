#include "simulator/track_path.h"

#include <algorithm>
#include <cmath>

namespace grouser {
namespace {

PathWheel wrap(const Vector3d& center, double radius, double pitch, double wheel_path_height) {
  const double line = radius + wheel_path_height;
  return {center.x(), center.z(), line, pitch / (2.0 * std::atan(pitch / (2.0 * line)))};
}

/// Direction angle of the tangent from each wheel to the next.
std::vector<double> tangent_angles(const std::vector<PathWheel>& wheels) {
  const std::size_t n = wheels.size();
  std::vector<double> angle(n);
  for (std::size_t i = 0; i < n; ++i) {
    const PathWheel &a = wheels[i], &b = wheels[(i + 1) % n];
    const double dx = b.x - a.x, dz = b.z - a.z;
    angle[i] = std::atan2(dz, dx) + std::asin((a.tangent_radius - b.tangent_radius) / std::hypot(dx, dz));
  }
  return angle;
}

double straight_length(const PathWheel& a, const PathWheel& b) {
  const double dx = b.x - a.x, dz = b.z - a.z, dr = a.tangent_radius - b.tangent_radius;
  return std::sqrt(dx * dx + dz * dz - dr * dr);
}

/// Angle by which the line turns on wheel i, between -1 rad (a wheel that bends it back) and 2 pi - 1.
double wrap_angle(const std::vector<double>& angle, std::size_t i) {
  double turned = angle[i] - angle[(i + angle.size() - 1) % angle.size()];
  while (turned < -1.0) turned += 2.0 * k_pi;
  while (turned > 2.0 * k_pi - 1.0) turned -= 2.0 * k_pi;
  return turned;
}

PathPoint point_at(const std::vector<PathWheel>& wheels, const std::vector<double>& angle, double s) {
  const std::size_t n = wheels.size();
  for (std::size_t i = 0; i < n; ++i) {
    const PathWheel &a = wheels[i], &b = wheels[(i + 1) % n];
    const double straight = straight_length(a, b);
    if (s < straight) {
      return {a.x + a.tangent_radius * std::sin(angle[i]) + s * std::cos(angle[i]),
              a.z - a.tangent_radius * std::cos(angle[i]) + s * std::sin(angle[i])};
    }
    s -= straight;
    const double arc = wrap_angle(angle, (i + 1) % n) * b.wrap_radius;
    if (s < arc || i + 1 == n) {
      const double turned = angle[i] + s / b.wrap_radius;
      return {b.x + b.tangent_radius * std::sin(turned), b.z - b.tangent_radius * std::cos(turned)};
    }
    s -= arc;
  }
  return {wheels[0].x, wheels[0].z};
}

}  // namespace

std::vector<PathWheel> path_wheels(const RunningGear& gear, double idler_angle) {
  const Track& track = gear.track;
  std::vector<PathWheel> ground, upper, path;
  for (const Station& station : gear.stations) {
    ground.push_back(wrap(station.wheel.center, station.wheel.radius, track.pitch, track.wheel_path_height));
  }
  for (const DiscPair& roller : gear.support_rollers) {
    upper.push_back(wrap(roller.center, roller.radius, track.pitch, track.wheel_path_height));
  }
  std::sort(ground.begin(), ground.end(), [](const PathWheel& a, const PathWheel& b) { return a.x < b.x; });
  std::sort(upper.begin(), upper.end(), [](const PathWheel& a, const PathWheel& b) { return a.x > b.x; });
  const Vector3d arm = gear.idler.wheel.center - gear.idler.pivot;
  const double c = std::cos(idler_angle), s = std::sin(idler_angle);
  const Vector3d center = gear.idler.pivot + Vector3d(c * arm.x() + s * arm.z(), 0.0, -s * arm.x() + c * arm.z());
  const PathWheel idler = wrap(center, gear.idler.wheel.radius, track.pitch, track.wheel_path_height);
  const double rolling = gear.sprocket.teeth * track.pitch / (2.0 * k_pi);
  const PathWheel sprocket{gear.sprocket.center.x(), gear.sprocket.center.z(), rolling, rolling};
  const bool sprocket_in_front = sprocket.x > idler.x;

  path = ground;
  path.push_back(sprocket_in_front ? sprocket : idler);
  path.insert(path.end(), upper.begin(), upper.end());
  path.push_back(sprocket_in_front ? idler : sprocket);
  return path;
}

double path_length(const std::vector<PathWheel>& wheels) {
  const std::vector<double> angle = tangent_angles(wheels);
  double length = 0.0;
  for (std::size_t i = 0; i < wheels.size(); ++i) {
    length +=
        straight_length(wheels[i], wheels[(i + 1) % wheels.size()]) + wrap_angle(angle, i) * wheels[i].wrap_radius;
  }
  return length;
}

std::vector<PathPoint> path_pins(const std::vector<PathWheel>& wheels, int count) {
  const std::vector<double> angle = tangent_angles(wheels);
  const double length = path_length(wheels);
  std::vector<PathPoint> pins;
  for (int k = 0; k < count; ++k) pins.push_back(point_at(wheels, angle, k * length / count));
  return pins;
}

}  // namespace grouser
