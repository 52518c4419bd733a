#include "simulator/start_pose.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "model/errors.h"

namespace grouser {
namespace {

constexpr double k_spacing = 0.05;  // m between the places looked at

/// Places under the wheels of both tracks, at the edges of the shoes: columns x, y, height [m].
Eigen::MatrixX3d ground_under(const System& system) {
  std::vector<Vector3d> places;
  for (const Side side : {Side::left, Side::right}) {
    const RunningGear& gear = system.scenario.vehicle.side(side);
    const auto [rear, front] =
        std::minmax_element(gear.stations.begin(), gear.stations.end(),
                            [](const Station& a, const Station& b) { return a.wheel.center.x() < b.wheel.center.x(); });
    const double margin = rear->wheel.radius;
    for (double x = rear->wheel.center.x() - margin; x <= front->wheel.center.x() + margin; x += k_spacing) {
      for (const double edge : {-0.5, 0.5}) {
        const double y = gear.track_center_y + edge * gear.track.shoe_width;
        places.emplace_back(x, y, system.ground.top(x, y));
      }
    }
  }
  Eigen::MatrixX3d all(static_cast<Eigen::Index>(places.size()), 3);
  for (std::size_t i = 0; i < places.size(); ++i) all.row(static_cast<Eigen::Index>(i)) = places[i];
  return all;
}

void require_hold(const System& system, const Eigen::MatrixX3d& places, double steepness) {
  double friction = 0.0;
  for (const auto& place : places.rowwise()) friction += system.ground.friction(place[0], place[1]);
  friction /= static_cast<double>(places.rows());
  if (steepness < friction) return;
  throw NumericalError(
      fmt::format("assembly: the ground on which the vehicle starts slopes by {:.1f} %, and friction holds only up to "
                  "{:.1f} %: it would slide away; start it on flatter ground or raise terrain.friction",
                  100.0 * steepness, 100.0 * friction));
}

}  // namespace

StartPose start_pose(const System& system) {
  StartPose pose;
  if (system.ground.level()) return pose;
  const Eigen::MatrixX3d places = ground_under(system);
  Eigen::MatrixX3d plane = places;
  plane.col(2).setOnes();
  const Vector3d fit = plane.colPivHouseholderQr().solve(places.col(2));  // z = fit.x x + fit.y y + fit.z
  require_hold(system, places, std::hypot(fit.x(), fit.y()));
  const Vector3d normal = Vector3d(-fit.x(), -fit.y(), 1.0).normalized();
  const Vector3d forward = Vector3d(1.0, 0.0, fit.x()).normalized();
  pose.rotation << forward, normal.cross(forward), normal;
  pose.plane = Vector3d(0.0, 0.0, fit.z());
  const double lift = (places.col(2) - plane * fit).maxCoeff();
  pose.position = pose.plane + lift * normal.z() * normal;
  return pose;
}

void put_down(const System& system, const StartPose& pose, State& state) {
  const Quaterniond turn(pose.rotation);
  state.chassis.position = pose.rotation * state.chassis.position + pose.position;
  state.chassis.orientation = turn * state.chassis.orientation;
  for (const CompiledTrack& track : system.tracks) {
    for (int i = track.offset; i < track.offset + track.num_links; ++i) {
      Field& p = state.position;
      Field& q = state.orientation;
      const Vector3d moved = pose.rotation * Vector3d(p[0][i], p[1][i], p[2][i]) + pose.position;
      const Quaterniond turned = turn * Quaterniond(q[0][i], q[1][i], q[2][i], q[3][i]);
      for (int c = 0; c < 3; ++c) p[c][i] = moved[c];
      const std::array<double, 4> wxyz{turned.w(), turned.x(), turned.y(), turned.z()};
      for (std::size_t c = 0; c < 4; ++c) q[static_cast<int>(c)][i] = wxyz[c];
    }
  }
  close_chains(system, state);
}

}  // namespace grouser
