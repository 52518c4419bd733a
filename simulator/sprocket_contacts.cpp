#include <array>
#include <span>

#include "simulator/contacts.h"

namespace grouser {
namespace {

/// A point of a body that carries the pin.
struct PinBearer {
  LinkView body;
  Vector3d from_body_W;
};

/// A point of the pin: the mean of points of its bearers. A single pin is borne by its link; a double pin's middle,
/// half way between the bores of two shoes, by both, each with half of its load; or by a connector that is a body.
struct PinMeeting {
  const CompiledTrack& track;
  std::span<const PinBearer> bearers;
  Vector3d pin_from_base_W;
};

/// The bodies of one kind that `index` belongs to.
const LinkBodies& bodies_of(const CompiledTrack& track, int index) {
  const LinkBodies& links = track.bodies.front();
  return index < links.offset + links.count && index >= links.offset ? links : track.bodies.back();
}

/// Force on the pin, minus it on the sprocket, at one common point; counts towards the step's bound.
void push_pin(const PinMeeting& m, const Vector3d& force, double stiffness, double damping, Workspace& work) {
  const CompiledTrack& track = m.track;
  const double share = 1.0 / static_cast<double>(m.bearers.size()), ring = track.sprocket.ring_offset;
  for (const PinBearer& bearer : m.bearers) {
    const LinkBodies& kind = bodies_of(track, bearer.body.index);
    LinkLoad load;
    load.add(bearer.from_body_W, share * force);
    push_link(work, bearer.body.index, load, Partner::sprocket);
    const double half = kind.offset == track.offset ? 0.5 * track.pitch : 0.0;
    const double mobility = 1.0 / kind.mass + half * half / kind.inertia.y();
    work.stability[0][bearer.body.index] += share * stiffness * (mobility + ring * ring / kind.inertia.x());
    work.stability[1][bearer.body.index] += share * damping * mobility;
  }
  work.chassis.add_force(track.sprocket.body, m.pin_from_base_W, -force);
}

void touch_with(const PinMeeting& m, const CompiledContact& law, double stiffness, double depth, const Vector3d& normal,
                const Vector3d& relative_velocity, Workspace& work) {
  const double elastic = stiffness * depth, closing = -relative_velocity.dot(normal);
  const double factor = normal_factor(law, closing), force = elastic * factor;
  const Vector3d slip = relative_velocity + closing * normal;
  const double q = sliding_friction(law, force, slip.squaredNorm());
  const double steepest = std::min(law.friction_slope_limit, law.friction * force / law.friction_speed);
  push_pin(m, force * normal - q * slip, stiffness, steepest + elastic * law.rate, work);
  work.energy.contact += 0.5 * stiffness * depth * depth;
  work.energy.contact_power += elastic * (factor - 1.0) * closing;
  work.energy.friction_power += q * slip.squaredNorm();
}

/// Tooth sides: lateral play used up while the pin is below the tips. The stiffness fades over 20 mm below the tip
/// circle so that a pin entering sideways is met gradually; its gradient pushes the pin outwards.
void touch_side(const PinMeeting& m, double lateral, double radius, const Vector3d& radial_W, const Vector3d& axle_W,
                const Vector3d& relative_velocity, Workspace& work) {
  constexpr double k_fade = 0.02;  // m
  const CompiledSprocket& sprocket = m.track.sprocket;
  const double depth = std::abs(lateral) - sprocket.side_clearance;
  const double fade = std::min(1.0, (sprocket.tip_radius - radius) / k_fade);
  if (depth <= 0.0 || fade <= 0.0) return;
  const double sign = lateral > 0.0 ? 1.0 : -1.0, k = sprocket.side_stiffness * fade;
  Vector3d elastic = -sign * k * depth * axle_W;
  if (fade < 1.0) elastic += 0.5 * sprocket.side_stiffness * depth * depth / k_fade * radial_W;
  const double magnitude = elastic.norm(), closing = -elastic.dot(relative_velocity) / magnitude;
  const double factor = normal_factor(sprocket.contact, closing);
  push_pin(m, factor * elastic, k, 0.0, work);
  work.energy.contact += 0.5 * k * depth * depth;
  work.energy.contact_power += magnitude * (factor - 1.0) * closing;
  ++work.case_count[static_cast<std::size_t>(sign > 0.0 ? ContactCase::sprocket_side_left
                                                        : ContactCase::sprocket_side_right)];
}

Vector3d relative_velocity(const PinMeeting& m, const Workspace& work) {
  Vector3d velocity = Vector3d::Zero();
  for (const PinBearer& bearer : m.bearers) velocity += bearer.body.velocity_at(bearer.from_body_W);
  return velocity / static_cast<double>(m.bearers.size()) -
         work.chassis.velocity_at(m.track.sprocket.body, m.pin_from_base_W);
}

/// The middle of the pin against the sides of the teeth.
void meet_sides(const PinMeeting& m, const Matrix3d& R_WS, const Vector3d& sprocket_from_base, Workspace& work) {
  const Vector3d pin = R_WS.transpose() * (m.pin_from_base_W - sprocket_from_base);
  const double radius = std::hypot(pin.x(), pin.z());
  if (radius > m.track.sprocket.tip_radius) return;
  const Vector3d outward = R_WS * Vector3d(pin.x(), 0.0, pin.z()) / radius;
  touch_side(m, pin.y(), radius, outward, R_WS.col(1), relative_velocity(m, work), work);
}

/// The pin at one ring of teeth: tooth surfaces and base circle.
void meet_ring(const PinMeeting& m, double stiffness, const Matrix3d& R_WS, const Vector3d& sprocket_from_base,
               Workspace& work) {
  const CompiledSprocket& sprocket = m.track.sprocket;
  const Vector3d pin = R_WS.transpose() * (m.pin_from_base_W - sprocket_from_base);  // gap 0 along its x
  const double radius = std::hypot(pin.x(), pin.z());
  if (radius > sprocket.tip_radius + sprocket.pin_radius) return;
  const double step = 2.0 * k_pi / sprocket.teeth, angle = std::atan2(pin.z(), pin.x());
  const double gap = step * std::round(angle / step), within = angle - gap;
  const Vector3d radial(std::cos(gap), 0.0, std::sin(gap)), tangential(-std::sin(gap), 0.0, std::cos(gap));
  const Vector3d relative = relative_velocity(m, work);

  const ToothContact tooth = touch_tooth(sprocket, radius * std::cos(within), radius * std::sin(within));
  if (tooth.penetration > 0.0) {
    const Vector3d normal = R_WS * (tooth.normal_x * radial + tooth.normal_y * tangential);
    touch_with(m, sprocket.contact, stiffness, tooth.penetration, normal, relative, work);
    ++work.case_count[static_cast<std::size_t>(tooth.where)];
  }
  const double base_depth = sprocket.pin_radius + sprocket.base_radius - radius;
  if (base_depth > 0.0) {
    const Vector3d outward = R_WS * Vector3d(pin.x(), 0.0, pin.z()) / radius;
    touch_with(m, sprocket.contact, stiffness, base_depth, outward, relative, work);
    ++work.case_count[static_cast<std::size_t>(ContactCase::sprocket_base)];
  }
}

/// The bodies that bear the pin behind link i, at its middle; returns their number.
std::size_t find_bearers(const CompiledTrack& track, const State& state, const Workspace& work, int i,
                         std::array<PinBearer, 2>& bearers) {
  const int before = i == track.offset ? i + track.num_links - 1 : i - 1;
  if (track.joint == JointForm::connector_bodies) {
    bearers[0] = {view_link(state, work, before - track.offset + track.connector_offset), Vector3d::Zero()};
    return 1;
  }
  bearers[0].body = view_link(state, work, i);
  bearers[0].from_body_W = -track.groove * bearers[0].body.rotation.col(0);
  if (track.joint == JointForm::single_pin) return 1;
  bearers[1].body = view_link(state, work, before);
  bearers[1].from_body_W = track.groove * bearers[1].body.rotation.col(0);
  return 2;
}

}  // namespace

ToothContact touch_tooth(const CompiledSprocket& sprocket, double x, double y) {
  const double sign = y < 0.0 ? -1.0 : 1.0, height = std::abs(y), from_seat = x - sprocket.seat_center;
  const double along = from_seat * sprocket.flank_cos + height * sprocket.flank_sin;
  const double corner =
      (sprocket.corner_x - sprocket.seat_center) * sprocket.flank_cos + sprocket.corner_y * sprocket.flank_sin;
  const double radius = std::hypot(x, y), pin = sprocket.pin_radius;
  ToothContact contact;
  contact.where = sign > 0.0 ? ContactCase::sprocket_flank_driving : ContactCase::sprocket_flank_braking;
  if (along <= 0.0) {  // root fillet
    const double from_center = std::hypot(from_seat, height);
    if (from_center < 1e-12) return contact;
    contact.penetration = from_center + pin - sprocket.seat_radius;
    contact.normal_x = -from_seat / from_center;
    contact.normal_y = -height / from_center;
  } else if (along < corner &&
             radius < sprocket.tip_radius + 0.5 * pin) {  // straight flank, or the tip where that is nearer
    contact.penetration = pin - sprocket.seat_radius - from_seat * sprocket.flank_sin + height * sprocket.flank_cos;
    contact.normal_x = sprocket.flank_sin;
    contact.normal_y = -sprocket.flank_cos;
    const double tip = pin - (radius - sprocket.tip_radius);
    if (tip < contact.penetration && height > sprocket.corner_y) {
      contact = {tip, x / radius, height / radius, ContactCase::sprocket_top};
    }
  } else if (std::atan2(height, x) > std::atan2(sprocket.corner_y, sprocket.corner_x)) {  // tip circle
    contact = {pin - (radius - sprocket.tip_radius), x / radius, height / radius, ContactCase::sprocket_top};
  } else {  // corner between flank and tip
    const double dx = x - sprocket.corner_x, dy = height - sprocket.corner_y, distance = std::hypot(dx, dy);
    contact = {pin - distance, dx / distance, dy / distance, ContactCase::sprocket_top};
  }
  contact.normal_y *= sign;
  return contact;
}

void sprocket_contacts(const System& system, const AssemblyKnobs& knobs, const State& state, Workspace& work) {
  for (const CompiledTrack& track : system.tracks) {
    const CompiledSprocket& sprocket = track.sprocket;
    const auto body = static_cast<std::size_t>(sprocket.body);
    const Vector3d from_base = work.chassis.origin_W[body];
    const Vector3d center = state.chassis.position + from_base;
    const double reach = sprocket.tip_radius + sprocket.pin_radius + 0.5 * track.pitch + 0.05;
    const double stiffness = knobs.stiffness_scale * sprocket.contact.stiffness;
    for_links_within(track, state, center, reach, [&](int first, const LaneMask& near) {
      for (unsigned left = bits_of(near); left != 0; left &= left - 1) {
        std::array<PinBearer, 2> middle, points;
        const std::size_t count = find_bearers(track, state, work, first + std::countr_zero(left), middle);
        const auto meeting = [&](double lateral) {
          points = middle;
          Vector3d pin = Vector3d::Zero();
          for (PinBearer& bearer : std::span(points.data(), count)) {
            bearer.from_body_W += lateral * bearer.body.rotation.col(1);
            pin += (bearer.body.position - state.chassis.position) + bearer.from_body_W;
          }
          return PinMeeting{track, {points.data(), count}, pin / static_cast<double>(count)};
        };
        const Matrix3d& R_WS = work.chassis.rotation[body];
        const double outwards = track.lateral * sprocket.ring_offset;
        for (const double ring : {-outwards, outwards}) meet_ring(meeting(ring), stiffness, R_WS, from_base, work);
        meet_sides(meeting(0.0), R_WS, from_base, work);
      }
    });
  }
}

}  // namespace grouser
