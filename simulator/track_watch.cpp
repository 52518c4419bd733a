#include "simulator/track_watch.h"

#include <cmath>
#include <limits>

namespace grouser {
namespace {

Vector3d link_position(const State& state, int i) {
  return {state.position[0][i], state.position[1][i], state.position[2][i]};
}

}  // namespace

SpanTension upper_run_tension(const System& system, const State& state, const Workspace& work, Side side) {
  const CompiledTrack& track = system.tracks[static_cast<std::size_t>(index_of(side))];
  const RunningGear& gear = system.scenario.vehicle.side(side);
  const Vector3d a = gear.sprocket.center, b = gear.idler.wheel.center;
  const double margin_a = gear.sprocket.tip_radius + 0.1, margin_b = gear.idler.wheel.radius + 0.1;
  const bool a_first = a.x() < b.x();
  const double from = a_first ? a.x() + margin_a : b.x() + margin_b, to = a_first ? b.x() - margin_b : a.x() - margin_a;
  SpanTension span{0.0, std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), 0};
  for (int k = 0; k < track.num_links; ++k) {
    const int i = track.offset + k;
    const Vector3d half(0.5 * track.pitch * work.rotation[0][i], 0.5 * track.pitch * work.rotation[3][i],
                        0.5 * track.pitch * work.rotation[6][i]);
    const Vector3d p_V =
        work.chassis.base_rotation.transpose() * (link_position(state, i) + half - state.chassis.position) +
        system.chassis_center_V;
    const double axle_line = a.z() + (b.z() - a.z()) * (p_V.x() - a.x()) / (b.x() - a.x());
    if (p_V.x() < from || p_V.x() > to || p_V.z() < axle_line) continue;
    const double tension = work.bushing_force[0][i];
    span.mean += tension;
    span.low = std::min(span.low, tension);
    span.high = std::max(span.high, tension);
    ++span.joints;
  }
  span.mean /= std::max(1, span.joints);
  return span;
}

ToothCounter::ToothCounter(const System& system, const State& state, Side side) : side_(side) {
  const int body = system.sprocket_body[static_cast<std::size_t>(index_of(side))];
  start_angle_ = state.chassis.angle[body];
  last_index_ = pin_index(system, state).value_or(0.0);
}

/// Index of the pin line at the outermost point of the sprocket, between pins by their angles; none where no pin is
/// engaged there.
std::optional<double> ToothCounter::pin_index(const System& system, const State& state) const {
  const auto s = static_cast<std::size_t>(index_of(side_));
  const CompiledTrack& track = system.tracks[s];
  const RunningGear& gear = system.scenario.vehicle.side(side_);
  const double outward = gear.sprocket.center.x() < gear.idler.wheel.center.x() ? -1.0 : 1.0;
  const Matrix3d R_VW = state.chassis.orientation.toRotationMatrix().transpose();
  const Vector3d center = gear.sprocket.center - system.chassis_center_V;
  const double step = 2.0 * k_pi / track.sprocket.teeth, reach = track.sprocket.tip_radius + track.sprocket.pin_radius;
  double best = 0.75 * step;
  std::optional<double> index;
  for (int k = 0; k < track.num_links; ++k) {
    const int i = track.offset + k;
    const Quaterniond q(state.orientation[0][i], state.orientation[1][i], state.orientation[2][i],
                        state.orientation[3][i]);
    const Vector3d pin =
        R_VW * (link_position(state, i) - q * Vector3d(0.5 * track.pitch, 0.0, 0.0) - state.chassis.position) - center;
    if (std::hypot(pin.x(), pin.z()) > reach) continue;
    // Angle from the outermost direction, growing with the link index (the track runs up in front, back above).
    const double angle = std::atan2(outward * pin.z(), outward * pin.x());
    if (std::abs(angle) < best) {
      best = std::abs(angle);
      index = k - angle / step;
    }
  }
  return index;
}

void ToothCounter::update(const System& system, const State& state) {
  const auto s = static_cast<std::size_t>(index_of(side_));
  const CompiledTrack& track = system.tracks[s];
  const int body = system.sprocket_body[s];
  teeth_ = (state.chassis.angle[body] - start_angle_) * track.sprocket.teeth / (2.0 * k_pi);
  const std::optional<double> index = pin_index(system, state);
  if (!index) return;
  links_ += std::remainder(*index - last_index_, track.num_links);
  last_index_ = *index;
}

}  // namespace grouser
