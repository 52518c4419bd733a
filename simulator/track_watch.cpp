#include "simulator/track_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "simulator/failures.h"
#include "simulator/track_path.h"

namespace grouser {
namespace {

Vector3d link_position(const State& state, int i) {
  return {state.position[0][i], state.position[1][i], state.position[2][i]};
}

/// Joints i to i + 7 (each between its link and the next) in the vehicle frame, along one of its axes [m].
Lanes joints_along(int axis, const System& system, const CompiledTrack& track, const State& state,
                   const Workspace& work, int i) {
  const Vector3d e_W = work.chassis.base_rotation.col(axis);
  Lanes along = system.chassis_center_V[axis] - e_W.dot(state.chassis.position);
  for (int c = 0; c < 3; ++c) {
    const Lanes from_link = (0.5 * track.pitch) * load(work.rotation[3 * c] + i);
    along += e_W[c] * (load(state.position[c] + i) + from_link);
  }
  return along;
}

/// Mean, least and greatest tension of the joints that `belongs` lets in by their x and z in the vehicle frame.
template <typename Belongs>
SpanTension span_tension(const System& system, const CompiledTrack& track, const State& state, const Workspace& work,
                         Belongs belongs) {
  SpanTension span{0.0, std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), 0};
  for (int block = 0; block < track.num_links; block += k_lanes) {
    const int first = track.offset + block;
    const Lanes x = joints_along(0, system, track, state, work, first);
    const Lanes z = joints_along(2, system, track, state, work, first);
    for (int lane = 0; lane < std::min(k_lanes, track.num_links - block); ++lane) {
      if (!belongs(x[lane], z[lane])) continue;
      const double tension = work.bushing_force[0][first + lane];
      span.mean += tension;
      span.low = std::min(span.low, tension);
      span.high = std::max(span.high, tension);
      ++span.joints;
    }
  }
  span.mean /= std::max(1, span.joints);
  return span;
}

/// The road wheel whose axle stands nearest to the sprocket at design.
const CompiledDiscs& wheel_next_to_sprocket(const System& system, const CompiledTrack& track) {
  const RunningGear& gear = system.scenario.vehicle.side(track.side);
  const auto distance = [&](const Station& s) { return (s.wheel.center - gear.sprocket.center).norm(); };
  const auto nearest = std::min_element(gear.stations.begin(), gear.stations.end(),
                                        [&](const Station& a, const Station& b) { return distance(a) < distance(b); });
  const auto index = nearest - gear.stations.begin();
  return track.discs[static_cast<std::size_t>(index)];
}

/// Length of the pin line round the running gear at design, with the idler arm where it is [m].
double way_round(const System& system, const State& state, Side side) {
  const int arm = system.idler_arm_body[static_cast<std::size_t>(index_of(side))];
  return path_length(path_wheels(system.scenario.vehicle.side(side), state.chassis.angle[arm]));
}

/// The link that stands furthest beside a wheel that it meets.
struct Beside {
  int link = 0;         ///< link array index
  int wheel = 0;        ///< tree body
  double offset = 0.0;  ///< m
  double play = 0.0;    ///< m, of a centred guide between the discs
};

Beside furthest_beside(const CompiledTrack& track, const State& state, const Workspace& work) {
  Beside worst{track.offset, track.discs.front().body, 0.0, 0.0};
  for (const CompiledDiscs& discs : track.discs) {
    const Vector3d axle = state.chassis.position + work.chassis.origin_W(discs.body);
    for (int i = track.offset; i < track.offset + track.num_links; ++i) {
      const Quaterniond q(state.orientation[0][i], state.orientation[1][i], state.orientation[2][i],
                          state.orientation[3][i]);
      const Vector3d center = q.conjugate() * (axle - link_position(state, i));
      const double above = center.z() - discs.radius - track.wheel_path_height;
      if (std::abs(center.x()) >= track.pitch || center.z() < 0.0 || above >= track.guide_height) continue;
      if (std::abs(center.y()) > worst.offset)
        worst = {i, discs.body, std::abs(center.y()), discs.half_gap - track.guide_half_base};
    }
  }
  return worst;
}

}  // namespace

SpanTension upper_run_tension(const System& system, const State& state, const Workspace& work, Side side) {
  const CompiledTrack& track = system.tracks[static_cast<std::size_t>(index_of(side))];
  const RunningGear& gear = system.scenario.vehicle.side(side);
  const Vector3d a = gear.sprocket.center, b = gear.idler.wheel.center;
  const double margin_a = gear.sprocket.tip_radius + 0.1, margin_b = gear.idler.wheel.radius + 0.1;
  const bool a_first = a.x() < b.x();
  const double from = a_first ? a.x() + margin_a : b.x() + margin_b, to = a_first ? b.x() - margin_b : a.x() - margin_a;
  return span_tension(system, track, state, work, [&](double x, double z) {
    const double axle_line = a.z() + (b.z() - a.z()) * (x - a.x()) / (b.x() - a.x());
    return x >= from && x <= to && z >= axle_line;
  });
}

SpanTension sprocket_span_tension(const System& system, const State& state, const Workspace& work, Side side) {
  const CompiledTrack& track = system.tracks[static_cast<std::size_t>(index_of(side))];
  if (track.discs.empty() || system.scenario.vehicle.side(side).stations.empty()) return {};
  const CompiledDiscs& wheel = wheel_next_to_sprocket(system, track);
  const Vector3d a = system.scenario.vehicle.side(side).sprocket.center;
  const Vector3d b =
      work.chassis.base_rotation.transpose() * work.chassis.origin_W(wheel.body) + system.chassis_center_V;
  // Outer tangent below both: unit normal n with (b - a) . n = r_a - r_b, in the x-z plane.
  const double r_a = track.speed_per_sprocket_rate, r_b = wheel.radius + track.wheel_path_height;
  const double dx = b.x() - a.x(), dz = b.z() - a.z(), d = std::hypot(dx, dz), c = (r_a - r_b) / d;
  const double across = std::sqrt(1.0 - c * c) * (dx > 0.0 ? 1.0 : -1.0);
  const double nx = c * dx / d + across * dz / d, nz = c * dz / d - across * dx / d;
  const double tx = (dx + (r_b - r_a) * nx), tz = (dz + (r_b - r_a) * nz), length = std::hypot(tx, tz);
  return span_tension(system, track, state, work, [&](double joint_x, double joint_z) {
    const double x = joint_x - a.x() - r_a * nx, z = joint_z - a.z() - r_a * nz;
    const double along = (x * tx + z * tz) / length, off = x * nx + z * nz;
    return along >= 0.5 * track.pitch && along <= length - 0.5 * track.pitch && std::abs(off) < track.pitch;
  });
}

ToothCounter::ToothCounter(const System& system, const State& state, Side side) : side_(side) {
  const int body = system.sprocket_body[static_cast<std::size_t>(index_of(side))];
  start_angle_ = state.chassis.angle[body];
  const std::optional<double> index = pin_index(system, state);
  seen_ = index.has_value();
  last_index_ = index.value_or(0.0);
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
  const std::optional<double> index = pin_index(system, state);
  if (!index) return;  // links and teeth are told together, or a loop that stands off for a moment would be a jump
  if (!seen_) {
    seen_ = true;
    start_angle_ = state.chassis.angle[body];
    last_index_ = *index;
    return;
  }
  teeth_ = (state.chassis.angle[body] - start_angle_) * track.sprocket.teeth / (2.0 * k_pi);
  links_ += std::remainder(*index - last_index_, track.num_links);
  last_index_ = *index;
}

int ToothCounter::link(const System& system) const {
  const CompiledTrack& track = system.tracks[static_cast<std::size_t>(index_of(side_))];
  const int nearest = static_cast<int>(std::lround(last_index_)) % track.num_links;
  return track.offset + (nearest < 0 ? nearest + track.num_links : nearest);
}

TrackWatch::TrackWatch(const System& system, const State& rest)
    : system_(system),
      tracks_{OneTrack{ToothCounter(system, rest, Side::left), 0.0, {}, {}},
              OneTrack{ToothCounter(system, rest, Side::right), 0.0, {}, {}}} {
  for (const Side side : {Side::left, Side::right}) {
    tracks_[static_cast<std::size_t>(index_of(side))].length_at_rest = way_round(system, rest, side);
  }
}

std::optional<std::string> TrackWatch::update(const Stepper& stepper) {
  constexpr long k_steps_between_looks = 20;  // far less than a tooth at any speed a step can follow
  const bool look = ++steps_ % k_steps_between_looks == 0;
  for (const Side side : {Side::left, Side::right}) {
    const auto s = static_cast<std::size_t>(index_of(side));
    if (stepper.work().lateral_guide_offset[s] >= k_thrown_offset) return thrown(stepper, side);
    if (!look) continue;
    tracks_[s].counter.update(system_, stepper.state());
    note_slack(stepper, side);
    if (std::abs(tracks_[s].counter.skipped()) >= k_skipped_tooth) return skipped(stepper, side);
  }
  return std::nullopt;
}

void TrackWatch::note_slack(const Stepper& stepper, Side side) {
  OneTrack& track = tracks_[static_cast<std::size_t>(index_of(side))];
  const SpanTension span = sprocket_span_tension(system_, stepper.state(), stepper.work(), side);
  if (span.joints == 0 || span.mean > 0.0) return;
  const SlackSpan now{stepper.state().time, track.length_at_rest - way_round(system_, stepper.state(), side)};
  if (track.slack.time < 0.0) track.slack = now;
  if (!lately_slack(side)) track.spell.begun = now;
  track.spell.last_teeth = track.counter.teeth();
}

bool TrackWatch::lately_slack(Side side) const {
  const auto& [begun, last_teeth] = at(side).spell;
  const int teeth = system_.tracks[static_cast<std::size_t>(index_of(side))].sprocket.teeth;
  return begun.time >= 0.0 && std::abs(at(side).counter.teeth() - last_teeth) <= 0.5 * teeth;
}

std::string TrackWatch::slack_story(Side side) const {
  const SlackSpan& begun = at(side).spell.begun;
  std::string text =
      fmt::format("the span between its sprocket and the next road wheel went slack at {:.4f} s", begun.time);
  if (begun.given_way > 0.0)
    text += fmt::format(", when the idler had given way by {:.1f} mm of track", 1e3 * begun.given_way);
  return text + "; a stiffer tensioner, more pre-tension or a gentler change of speed would hold it";
}

std::string TrackWatch::skipped(const Stepper& stepper, Side side) const {
  const ToothCounter& counter = at(side).counter;
  std::string text = fmt::format(
      "{} track skipped a tooth at {:.4f} s, {} on the sprocket: {:.2f} links passed it for {:.2f} teeth turned; ",
      name_of(side), stepper.state().time, link_name(system_, counter.link(system_)),
      counter.teeth() + counter.skipped(), counter.teeth());
  if (lately_slack(side)) return text + slack_story(side);
  const SpanTension span = sprocket_span_tension(system_, stepper.state(), stepper.work(), side);
  return text + fmt::format(
                    "with {:.1f} kN in its free span the pins climb the flanks; steeper flanks, more friction on them "
                    "or less sprocket torque would hold it",
                    1e-3 * span.mean);
}

std::string TrackWatch::thrown(const Stepper& stepper, Side side) const {
  const CompiledTrack& track = system_.tracks[static_cast<std::size_t>(index_of(side))];
  const Workspace& work = stepper.work();
  const Beside worst = furthest_beside(track, stepper.state(), work);
  const Field& guide = work.contact_force_W[static_cast<std::size_t>(Partner::guide)];
  const double held = std::hypot(guide[0][worst.link], guide[1][worst.link], guide[2][worst.link]);
  std::string text = fmt::format(
      "{} track thrown at {:.4f} s: {} stands {:.0f} mm beside {}, where its guide has {:.0f} "
      "mm of play; ",
      name_of(side), stepper.state().time, link_name(system_, worst.link), 1e3 * worst.offset,
      part_name(system_, {-1, worst.wheel}), 1e3 * worst.play);
  if (lately_slack(side)) return text + slack_story(side);
  return text + fmt::format(
                    "the guide holds it with {:.1f} kN and gives way, with {:.1f} kN in the joint; a stiffer or higher "
                    "guide, more pre-tension or a wider turn would hold it",
                    1e-3 * held, 1e-3 * work.bushing_force[0][worst.link]);
}

}  // namespace grouser
