#include <array>
#include <span>

#include "simulator/contacts.h"
#include "simulator/stability.h"

namespace grouser {
namespace {

/// The sprocket at the instant: its frame S, all in all lanes.
struct Wheel {
  const CompiledTrack& track;
  double stiffness;  ///< N/m per ring
  BlockFrame frame;  ///< origin_W: less the base's centre of mass
  bool slopes;       ///< wanted, for the step's bound
  [[nodiscard]] Lanes3 to_sprocket(const Lanes3& v_W) const { return transposed_times(frame.rotation, v_W); }
  [[nodiscard]] Lanes3 to_world(const Lanes3& v_S) const { return frame.rotation * v_S; }
};

/// Who bears a joint's pin for the teeth: a point of a body, `ahead` of its centre. A single pin is borne by the link
/// ahead; a double pin's middle, half way between the bores of two shoes, by both, each with half of the load; or by a
/// connector that is a body.
struct Bearer {
  const LinkBodies& kind;
  int from_joint;  ///< its place in the link arrays less the joint's
  double ahead;    ///< m
  double share;
};

/// Pins of eight joints in a row, or points on them.
struct Pins {
  std::span<const Bearer> bearers;
  int first;                    ///< joint of lane 0; joint i stands between links i and i+1
  LaneMask near;                ///< lanes that count
  std::array<Lanes3, 2> arm_W;  ///< of the bearers' points from their centres
  Lanes3 from_base_W;           ///< from the base's centre of mass
  Lanes3 place;                 ///< in S
  Lanes radius;                 ///< from the axle
};

/// What the contacts of one sprocket leave to be summed over lanes at its end.
struct Sums {
  Lanes energy = 0.0, contact_power = 0.0, friction_power = 0.0;
};

/// Points `aside` from the middles of the pins, along them: the means of their bearers' points.
Pins place_pins(const Wheel& wheel, std::span<const Bearer> bearers, const State& state, const Workspace& work,
                int first, const LaneMask& near, double aside) {
  Pins pins{bearers, first, near, {}, -in_all_lanes(state.chassis.position), {}, {}};
  for (std::size_t b = 0; b < bearers.size(); ++b) {
    const int body = first + bearers[b].from_joint;
    const Lanes3 x{load(work.rotation[0] + body), load(work.rotation[3] + body), load(work.rotation[6] + body)};
    const Lanes3 y{load(work.rotation[1] + body), load(work.rotation[4] + body), load(work.rotation[7] + body)};
    pins.arm_W[b] = bearers[b].ahead * x + aside * y;
    pins.from_base_W = pins.from_base_W + bearers[b].share * (load3(state.position, body) + pins.arm_W[b]);
  }
  pins.place = wheel.to_sprocket(pins.from_base_W - wheel.frame.origin_W);
  pins.radius = (pins.place.x * pins.place.x + pins.place.z * pins.place.z).sqrt();
  return pins;
}

/// Velocity against the sprocket, in S.
Lanes3 relative_velocity(const Wheel& wheel, const Pins& pins, const State& state, const Workspace& work) {
  Lanes3 velocity = -(wheel.frame.velocity.linear + cross(wheel.frame.velocity.angular, pins.from_base_W));
  for (std::size_t b = 0; b < pins.bearers.size(); ++b) {
    const int body = pins.first + pins.bearers[b].from_joint;
    velocity = velocity + pins.bearers[b].share * (load3(state.velocity, body) +
                                                   cross(load3(work.angular_velocity_W, body), pins.arm_W[b]));
  }
  return wheel.to_sprocket(velocity);
}

/// Slopes of forces in the sprocket's plane: a symmetric tensor.
struct PlaneSlopes {
  Lanes xx = 0.0, zz = 0.0, xz = 0.0;
  /// Along the unit vector (x, z).
  void add(const Lanes& slope, const Lanes& x, const Lanes& z) {
    xx += slope * x * x;
    zz += slope * z * z;
    xz += slope * x * z;
  }
  [[nodiscard]] Lanes between(const Lanes3& u, const Lanes3& v) const {
    return u.x * (xx * v.x + xz * v.z) + u.z * (xz * v.x + zz * v.z);
  }
};

/// Forces on pins in S, and their slopes for the stability bound.
struct PinForce {
  Lanes3 force = in_all_lanes(Vector3d::Zero());
  Lanes3 lost = force;  ///< part of it that energy is lost by
  PlaneSlopes stiffness{}, damping{};
  Lanes normal_stiffness = 0.0, normal_damping = 0.0, friction = 0.0;  ///< what the tensors are made of
  Lanes side_stiffness = 0.0, side_damping = 0.0;                      ///< of tooth sides
};

/// Slopes on one of the bearers, to the blocks of eight bodies from `body` on.
void add_slopes(const Wheel& wheel, const Bearer& bearer, int body, const PinForce& pushed, Workspace& work) {
  const CompiledSprocket& sprocket = wheel.track.sprocket;
  const auto axis = [&](int c) {
    const auto r = [&](int row) { return load(work.rotation[3 * row + c] + body); };
    return wheel.to_sprocket({r(0), r(1), r(2)});
  };
  const Lanes3 x = axis(0), z = axis(2);
  const double ahead = bearer.ahead, share = bearer.share * sprocket.share.link;
  const auto block = [&](const PlaneSlopes& s) {
    const Lanes xx = s.between(x, x), zz = s.between(z, z), xz = s.between(x, z);
    return PlaneBlock{xx, zz, ahead * ahead * zz, xz, -ahead * xz, -ahead * zz};
  };
  add_block(work.plane_stiffness, body, block(pushed.stiffness), share);
  add_block(work.plane_damping, body, block(pushed.damping), share);

  const Vector3d& inertia = bearer.kind.inertia;
  const double ring = sprocket.ring_offset, moving = 1.0 / bearer.kind.mass, arm2 = ahead * ahead;
  const double turning = ring * ring / std::min(inertia.x(), inertia.z());  // by what acts in the plane of a ring
  const double any = moving + arm2 / inertia.y() + ring * ring / inertia.x();
  add_to(work.stability[0] + body, (share * any) * pushed.side_stiffness);
  add_to(work.stability[1] + body, (share * any) * pushed.side_damping);
  add_to(work.side_stiffness[1] + body, (share * turning) * pushed.normal_stiffness);
  add_to(work.side_damping[1] + body, (share * turning) * (pushed.normal_damping + pushed.friction));
  add_side(work.side_damping, body, {moving, arm2 / inertia.z()}, share * pushed.friction);
}

/// Books the forces on bearers and sprocket, each pair at one common point, and towards the step's bound.
void push_pins(const Wheel& wheel, const Pins& pins, const PinForce& pushed, Workspace& work) {
  const CompiledTrack& track = wheel.track;
  const Lanes3 force = wheel.to_world(pushed.force), lost = wheel.to_world(pushed.lost);
  work.chassis.add_force(track.sprocket.body, {-cross(pins.from_base_W, force), -force});
  for (std::size_t b = 0; b < pins.bearers.size(); ++b) {
    const Bearer& bearer = pins.bearers[b];
    const int body = pins.first + bearer.from_joint;
    note_losses(work, body, LinkLoads::at(pins.arm_W[b], bearer.share * lost));
    push_links(work, body, LinkLoads::at(pins.arm_W[b], bearer.share * force), Partner::sprocket);
    if (wheel.slopes) add_slopes(wheel, bearer, body, pushed, work);
  }
  if (wheel.slopes) work.rim[static_cast<std::size_t>(track.sprocket.body)].spin += pushed.friction.sum();
}

/// Of what the sprocket's contacts put on links.
void close_seams(const CompiledTrack& track, Workspace& work) {
  for (Field* field : {&work.loss_force_W, &work.loss_torque_W, &work.force_W, &work.torque_W,
                       &work.contact_force_W[static_cast<std::size_t>(Partner::sprocket)]}) {
    close_seam(track, *field);
  }
}

/// A surface with `normal` (S, in its plane) that pins are `depth` deep in; 0 where they are not.
void touch_surface(const Wheel& wheel, const Lanes& depth, const Lanes& normal_x, const Lanes& normal_z,
                   const Lanes3& velocity, PinForce& pushed, Sums& sums) {
  const CompiledContact& law = wheel.track.sprocket.contact;
  const Lanes elastic = wheel.stiffness * depth, closing = -(velocity.x * normal_x + velocity.z * normal_z);
  const Lanes factor = normal_factor(law, closing), force = elastic * factor;
  const Lanes3 slip{velocity.x + closing * normal_x, velocity.y, velocity.z + closing * normal_z};
  const Lanes slip2 = dot(slip, slip), q = sliding_friction(law, force, slip2);
  const Lanes3 normal{normal_x, 0.0, normal_z}, lost = (force - elastic) * normal - q * slip;
  pushed.force = pushed.force + elastic * normal + lost;
  pushed.lost = pushed.lost + lost;
  sums.energy += 0.5 * elastic * depth;
  sums.contact_power += elastic * (factor - 1.0) * closing;
  sums.friction_power += q * slip2;
  if (!wheel.slopes) return;
  const LaneMask touching = 0.0 < depth;
  const Lanes stiffness = choose(touching, wheel.stiffness * factor.max(1.0), 0.0), damping = law.rate * elastic;
  const Lanes friction = steepest_friction(law, force);
  pushed.stiffness.add(stiffness, normal_x, normal_z);
  pushed.damping.add(damping, normal_x, normal_z);
  pushed.damping.add(friction, normal_z, -normal_x);
  pushed.normal_stiffness += stiffness;
  pushed.normal_damping += damping;
  pushed.friction += friction;
}

/// Unit vector (x, z) in S to the middle of the gap that is nearest to each pin.
struct GapDirection {
  Lanes x = 1.0, z = 0.0;
};

GapDirection nearest_gap(const CompiledSprocket& sprocket, const Lanes3& place) {
  GapDirection nearest;
  Lanes furthest_along = place.x;  // gap 0 stands along x
  for (const auto& [x, z] : std::span(sprocket.gaps).subspan(1)) {
    const Lanes along = x * place.x + z * place.z;
    const LaneMask nearer = furthest_along < along;
    furthest_along = furthest_along.max(along);
    nearest.x = choose(nearer, x, nearest.x);
    nearest.z = choose(nearer, z, nearest.z);
  }
  return nearest;
}

/// Tooth sides: lateral play used up while the pin is below the tips, met at the middle of the pin. The stiffness fades
/// over 20 mm below the tip circle so that a pin entering sideways is met gradually; its gradient pushes the pin
/// outwards.
void meet_sides(const Wheel& wheel, const Pins& pins, const State& state, Sums& sums, Workspace& work) {
  constexpr double k_fade = 0.02;  // m
  const CompiledSprocket& sprocket = wheel.track.sprocket;
  const Lanes zero = 0.0, deep = pins.place.y.abs() - sprocket.side_clearance;
  const Lanes fade = ((sprocket.tip_radius - pins.radius) / k_fade).min(1.0);
  const LaneMask touching = pins.near & (zero < deep) & (zero < fade), to_left = zero < pins.place.y;
  const unsigned touched = bits_of(touching);
  if (touched == 0) return;
  const Lanes depth = choose(touching, deep, zero), k = sprocket.side_stiffness * fade, normal = k * depth;
  const Lanes outwards =
      choose(fade < 1.0, (0.5 * sprocket.side_stiffness / k_fade) * depth * depth / pins.radius, zero);
  const Lanes3 elastic{outwards * pins.place.x, choose(to_left, -normal, normal), outwards * pins.place.z};
  const Lanes magnitude = dot(elastic, elastic).sqrt();
  const Lanes closing = -dot(elastic, relative_velocity(wheel, pins, state, work)) / magnitude.max(k_least_force);
  const Lanes factor = normal_factor(sprocket.contact, closing);
  PinForce pushed;
  pushed.force = factor * elastic;
  pushed.lost = (factor - 1.0) * elastic;
  pushed.side_stiffness = choose(touching, k, zero);
  pushed.side_damping = sprocket.contact.rate * magnitude;
  push_pins(wheel, pins, pushed, work);
  sums.energy += 0.5 * normal * depth;
  sums.contact_power += magnitude * (factor - 1.0) * closing;
  count_case(work, ContactCase::sprocket_side_left, touched & bits_of(to_left));
  count_case(work, ContactCase::sprocket_side_right, touched & ~bits_of(to_left));
}

/// The pins at one ring of teeth: tooth surfaces and base circle.
void meet_ring(const Wheel& wheel, const Pins& pins, const State& state, Sums& sums, Workspace& work) {
  const CompiledSprocket& sprocket = wheel.track.sprocket;
  const Lanes zero = 0.0;
  const LaneMask in_reach = pins.near & (pins.radius <= sprocket.tip_radius + sprocket.pin_radius);
  if (bits_of(in_reach) == 0) return;
  const GapDirection gap = nearest_gap(sprocket, pins.place);
  const Lanes x = gap.x * pins.place.x + gap.z * pins.place.z, y = gap.x * pins.place.z - gap.z * pins.place.x;
  const ToothContact tooth = touch_tooth(sprocket, x, y);
  const Lanes tooth_depth = choose(in_reach, tooth.penetration, zero).max(0.0);
  const Lanes base_depth = choose(in_reach, sprocket.pin_radius + sprocket.base_radius - pins.radius, zero).max(0.0);
  const unsigned on_tooth = bits_of(zero < tooth_depth), on_base = bits_of(zero < base_depth);
  if ((on_tooth | on_base) == 0) return;

  const Lanes3 velocity = relative_velocity(wheel, pins, state, work);
  PinForce pushed;
  touch_surface(wheel, tooth_depth, tooth.normal_x * gap.x - tooth.normal_y * gap.z,
                tooth.normal_x * gap.z + tooth.normal_y * gap.x, velocity, pushed, sums);
  if (on_base != 0) {
    touch_surface(wheel, base_depth, pins.place.x / pins.radius, pins.place.z / pins.radius, velocity, pushed, sums);
  }
  push_pins(wheel, pins, pushed, work);
  const unsigned on_tip = bits_of(tooth.on_tip), braking = bits_of(y < zero);
  count_case(work, ContactCase::sprocket_top, on_tooth & on_tip);
  count_case(work, ContactCase::sprocket_flank_braking, on_tooth & ~on_tip & braking);
  count_case(work, ContactCase::sprocket_flank_driving, on_tooth & ~on_tip & ~braking);
  count_case(work, ContactCase::sprocket_base, on_base);
}

}  // namespace

ToothContact touch_tooth(const CompiledSprocket& sprocket, const Lanes& x, const Lanes& y) {
  const Lanes zero = 0.0, height = y.abs(), from_seat = x - sprocket.seat_center;
  const Lanes radius = (x * x + y * y).sqrt(), above_tip = radius - sprocket.tip_radius;
  const double pin = sprocket.pin_radius, sine = sprocket.flank_sin, cosine = sprocket.flank_cos;
  // The flank's direction; the fillet ends where this is 0, the flank at the corner.
  const Lanes along = from_seat * cosine + height * sine;
  const double corner = (sprocket.corner_x - sprocket.seat_center) * cosine + sprocket.corner_y * sine;
  const LaneMask before_corner = (along < corner) & (above_tip < 0.5 * pin);

  const Lanes from_center = (from_seat * from_seat + height * height).sqrt().max(1e-12);
  const Lanes fillet_depth = from_center + (pin - sprocket.seat_radius);
  const Lanes flank_depth = (pin - sprocket.seat_radius) - from_seat * sine + height * cosine;
  const Lanes tip_depth = pin - above_tip;
  const Lanes dx = x - sprocket.corner_x, dy = height - sprocket.corner_y, distance = (dx * dx + dy * dy).sqrt();

  const LaneMask in_fillet = along <= zero;
  const LaneMask tip_is_nearer = (tip_depth < flank_depth) & (sprocket.corner_y < height);
  const LaneMask on_flank = before_corner & !tip_is_nearer;
  const LaneMask beyond_corner = x * sprocket.corner_y < height * sprocket.corner_x;  // as seen from the axle
  const LaneMask on_circle = before_corner | beyond_corner;                           // unless on the flank

  const Lanes inverse_radius = radius.inverse(), inverse_distance = distance.max(1e-12).inverse();
  const auto pick = [&](const Lanes& fillet, const Lanes& flank, const Lanes& circle, const Lanes& at_corner) {
    return choose(in_fillet, fillet, choose(on_flank, flank, choose(on_circle, circle, at_corner)));
  };
  const Lanes normal_y = pick(-height / from_center, -cosine, height * inverse_radius, dy * inverse_distance);
  return {pick(fillet_depth, flank_depth, tip_depth, pin - distance),
          pick(-from_seat / from_center, sine, x * inverse_radius, dx * inverse_distance),
          choose(y < zero, -normal_y, normal_y), !(in_fillet | on_flank)};
}

void sprocket_contacts(const System& system, const AssemblyKnobs& knobs, const State& state, Workspace& work) {
  for (const CompiledTrack& track : system.tracks) {
    const CompiledSprocket& sprocket = track.sprocket;
    const Wheel wheel{track, knobs.stiffness_scale * sprocket.contact.stiffness,
                      work.chassis.spread_frame(sprocket.body), work.bounds_step};
    const LinkBodies &links = track.bodies.front(), &connectors = track.bodies.back();
    const std::array<Bearer, 2> shoes{Bearer{links, 1, -track.groove, 0.5}, Bearer{links, 0, track.groove, 0.5}};
    const std::array<Bearer, 1> link{Bearer{links, 1, -track.groove, 1.0}};
    const std::array<Bearer, 1> connector{Bearer{connectors, connectors.offset - track.offset, 0.0, 1.0}};
    const std::span<const Bearer> bearers = track.joint == JointForm::single_pin   ? std::span<const Bearer>(link)
                                            : track.joint == JointForm::double_pin ? std::span<const Bearer>(shoes)
                                                                                   : connector;
    const double reach = sprocket.tip_radius + sprocket.pin_radius + 0.5 * track.pitch + 0.05;
    const double outwards = track.lateral * sprocket.ring_offset;
    Sums sums;
    const Lanes3 center = in_all_lanes(state.chassis.position) + wheel.frame.origin_W;
    const auto near = [&](int first) {  // joints whose link ahead is near
      const Lanes3 apart = load3(state.position, first + 1) - center;
      return dot(apart, apart) <= reach * reach;
    };
    for_windows<k_lanes>(track, blocks_near(track, work, center, reach), near, [&](int first, unsigned bits) {
      const LaneMask counted = LaneMask::of_bits(bits);
      const auto pins = [&](double aside) { return place_pins(wheel, bearers, state, work, first, counted, aside); };
      const Pins inner = pins(-outwards), outer = pins(outwards);
      for (const Pins* ring : {&inner, &outer}) meet_ring(wheel, *ring, state, sums, work);
      const Lanes aside = 0.5 * (inner.place.y + outer.place.y).abs();  // of the pins' middles
      if (bits_of(counted & (sprocket.side_clearance < aside)) != 0) meet_sides(wheel, pins(0.0), state, sums, work);
    });
    close_seams(track, work);
    work.energy.contact += sums.energy.sum();
    work.energy.contact_power += sums.contact_power.sum();
    work.energy.friction_power += sums.friction_power.sum();
  }
}

}  // namespace grouser
