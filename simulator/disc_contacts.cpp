#include <array>
#include <cmath>

#include "simulator/contacts.h"
#include "simulator/stability.h"

namespace grouser {
namespace {

/// What the contacts of one track leave to be summed over lanes at its end.
struct TrackSums {
  Lanes energy = 0.0, contact_power = 0.0, friction_power = 0.0;
  Lanes guide_offset = 0.0;
};

constexpr int k_window = k_lanes / 2;
constexpr unsigned k_one_disc = (1u << k_window) - 1u;  ///< bits of the lanes of one disc

/// Four links in a row, twice: lanes 0 to 3 for the inner disc of a pair, 4 to 7 for the outer one.
struct LinkFrames {
  explicit LinkFrames(const Workspace& work, int first) {
    for (int c = 0; c < 9; ++c) r[static_cast<std::size_t>(c)] = load_twice(work.rotation[c] + first);
  }
  [[nodiscard]] Lanes3 to_links(const Lanes3& v_W) const {
    return {r[0] * v_W.x + r[3] * v_W.y + r[6] * v_W.z, r[1] * v_W.x + r[4] * v_W.y + r[7] * v_W.z,
            r[2] * v_W.x + r[5] * v_W.y + r[8] * v_W.z};
  }
  [[nodiscard]] Lanes3 to_world(const Lanes3& v_L) const {
    return {r[0] * v_L.x + r[1] * v_L.y + r[2] * v_L.z, r[3] * v_L.x + r[4] * v_L.y + r[5] * v_L.z,
            r[6] * v_L.x + r[7] * v_L.y + r[8] * v_L.z};
  }
  std::array<Lanes, 9> r;  ///< link -> W, row-major
};

Lanes3 load_twice3(const Field& field, int first) {
  return {load_twice(field[0] + first), load_twice(field[1] + first), load_twice(field[2] + first)};
}

/// What a unit force moves a link's centre and turns it about x and z by [1/kg, 1/(kg m^2)].
struct Mobility {
  double moving, rolling, yawing;
};

/// A disc pair met by four links in a row, each in its own link frame L.
struct Meeting {
  const CompiledTrack& track;
  const CompiledDiscs& discs;
  const Mobility& mobility;
  int first;      ///< link array index of lane 0
  LaneMask near;  ///< lanes that count
  const LinkFrames& frames;
  Lanes3 center;        ///< the pair's centre from the link's [m]
  Lanes3 axle;          ///< unit vector
  Lanes3 spin;          ///< angular velocity of the pair against the link [rad/s]
  Lanes3 velocity;      ///< of the pair's centre against the point of the link that stands there [m/s]
  const Lanes3& way_W;  ///< unit vector along which the pair's centre can go on its arm; 0 on the hull
};

/// Loads on four links, twice, in their frames: elastic ones, and those that energy is lost by.
struct Loads {
  LinkLoads elastic, lost;
};

/// Contact patch of a disc on the wheel path as an elastic foundation of stiffness k [N/m^2]: energy k/2 int delta^2 dx
/// with delta = depth - x^2 / 2R over the part of the plate below the disc. Closed polynomials; smooth hand-over from
/// link to link.
struct Patch {
  Lanes force_x, force_z;  ///< on the disc, link frame, per unit k; zero where the disc does not touch
  Lanes energy;            ///< per unit k
  Lanes center;            ///< x of the pressure's centroid from the disc centre
  Lanes width;
};

/// depth: 0 where there is none. The plate runs from `from` to `to` about the disc's centre.
Patch foundation(const Lanes& depth, double radius, const Lanes& from, const Lanes& to) {
  constexpr double k_least_area = 1e-200;
  const double curvature = 1.0 / radius;
  const Lanes reach = (2.0 * radius * depth).sqrt();
  const Lanes begin = from.max(-reach), end = to.min(reach), none = 0.0;
  const LaneMask over_plate = begin < end;
  const Lanes a = choose(over_plate, begin, none), b = choose(over_plate, end, none), width = b - a;
  const Lanes a2 = a * a, b2 = b * b, a3 = a2 * a, b3 = b2 * b, cubes = b3 - a3;
  const Lanes area = (depth * width - (1.0 / 6.0) * curvature * cubes).max(0.0);
  const Lanes slope = (0.5 * curvature) * depth * (b2 - a2) - (0.125 * curvature * curvature) * (b2 * b2 - a2 * a2);
  const Lanes energy = 0.5 * depth * (depth * width - (1.0 / 3.0) * curvature * cubes) +
                       (0.025 * curvature * curvature) * (b3 * b2 - a3 * a2);
  return {-slope, area, energy, (radius * slope / area.max(k_least_area)).max(a).min(b), width};
}

/// Slopes of the discs' forces on the links, for the stability bound.
struct DiscSlopes {
  Lanes3 disc;  ///< its centre from the link's
  PlaneDirection normal;
  Lanes width;  ///< of the patch
  Lanes stiffness, damping, friction;
};

void add_plane(Field& blocks, int first, const PlaneBlock& block, double times) {
  for (int row = 0; row < k_plane_rows; ++row) {
    add_halves_to(blocks[row] + first, times * block[static_cast<std::size_t>(row)]);
  }
}

void add_slopes(const Meeting& m, const DiscSlopes& s, Workspace& work) {
  const double path = m.track.wheel_path_height, share = m.discs.share.link;
  PlaneBlock stiffness = along(s.normal, s.stiffness);
  stiffness[k_pitch] += (1.0 / 12.0) * s.stiffness * s.width * s.width;
  PlaneBlock damping = along(s.normal, s.damping);
  damping[k_xx] += s.friction;
  damping[k_pitch] += path * path * s.friction;
  damping[k_x_pitch] += path * s.friction;
  add_plane(work.plane_stiffness, m.first, stiffness, share);
  add_plane(work.plane_damping, m.first, damping, share);

  const auto& [moving, rolling, yawing] = m.mobility;
  const Lanes y2 = s.disc.y.square(), turning = path * path * rolling + yawing * s.disc.x.square();
  add_halves_to(work.side_stiffness[1] + m.first, (share * rolling) * y2 * s.stiffness);
  add_halves_to(work.side_damping[0] + m.first, (share * moving) * s.friction);
  add_halves_to(work.side_damping[1] + m.first,
                share * (rolling * y2 * s.damping + (yawing * y2 + turning) * s.friction));
  add_halves_to(work.side_damping[2] + m.first, share * (moving * turning).sqrt() * s.friction);

  RimSums& rim = work.rim[static_cast<std::size_t>(m.discs.body)];
  const Lanes3 way = m.frames.to_links(m.way_W);
  const Lanes normal_way = s.normal.x * way.x + s.normal.z * way.z;
  const Lanes friction_way = s.friction * way.x;
  rim.spin += s.friction.sum();
  rim.both += friction_way.sum();
  rim.damping += (friction_way * way.x + s.damping * normal_way * normal_way).sum();
  rim.stiffness += (s.stiffness * normal_way * normal_way).sum();
}

/// Loads of a disc that pushes a link with (-x, -z), in the link's plane.
LinkLoads push_down(const Lanes3& disc, const Lanes& x, const Lanes& z) {
  return {{-x, 0.0, -z}, {-(disc.y * z), disc.x * z - disc.z * x, disc.y * x}};
}

/// Both discs on plates or edges, `lateral` from the pair's centre. Returns the lanes that they touch.
unsigned touch_path(const Meeting& m, double stiffness, const Lanes& lateral, Loads& load, TrackSums& sums,
                    Workspace& work) {
  const CompiledTrack& track = m.track;
  const CompiledContact& law = m.discs.contact;
  const double half = 0.5 * track.pitch, radius = m.discs.radius, path = track.wheel_path_height;
  const Lanes3 arm = lateral * m.axle, disc = m.center + arm;
  const LaneMask above = m.near & (0.0 <= disc.z) & (disc.y.abs() <= track.half_width);
  const Lanes depth = choose(above, (path + radius) - disc.z, 0.0).max(0.0);
  const Patch patch = foundation(depth, radius, -half - disc.x, half - disc.x);
  const unsigned touching = bits_of(0.0 < patch.force_z);
  if (touching == 0) return 0;

  const Lanes3 rate = m.velocity + cross(m.spin, arm);
  const Lanes fx = stiffness * patch.force_x, fz = stiffness * patch.force_z;
  const Lanes elastic = (fx * fx + fz * fz).sqrt();
  const Lanes inverse = 1.0 / elastic.max(k_least_force), power = -(fx * rate.x + fz * rate.z);
  const Lanes factor = normal_factor(law, power * inverse), normal = elastic * factor;

  const Lanes3 place{disc.x + patch.center, disc.y, path};
  const Lanes3 slip = m.velocity + cross(m.spin, place - m.center);
  const Lanes slip2 = slip.x * slip.x + slip.y * slip.y;
  const Lanes q = sliding_friction(law, normal, slip2);
  const Lanes damped = 1.0 - factor, rubbed_x = q * slip.x, rubbed_y = q * slip.y;
  load.elastic = push_down(disc, fx, fz);
  const Lanes lost_x = fx * damped, lost_z = fz * damped;
  load.lost = {{lost_x + rubbed_x, rubbed_y, lost_z},
               {disc.y * lost_z - path * rubbed_y, disc.z * lost_x - disc.x * lost_z + path * rubbed_x,
                place.x * rubbed_y - place.y * rubbed_x - disc.y * lost_x}};
  if (work.bounds_step) {
    const Lanes nx = fx * inverse, nz = fz * inverse;
    add_slopes(m,
               {disc,
                {nx, nz, disc.z * nx - disc.x * nz},
                patch.width,
                stiffness * patch.width * factor.max(1.0),
                law.rate * elastic,
                steepest_friction(law, normal)},
               work);
  }
  sums.energy += stiffness * patch.energy;
  sums.contact_power -= damped * power;
  sums.friction_power += q * slip2;
  return touching;
}

/// Centre guide between the discs: a tapered horn. With s the height of the rims' lowest points above the wheel path,
/// the wall stands at half width t(s); wall penetration delta = |y| + t(s) - half gap, top overlap o = height - s. The
/// energy is k/2 min(delta, o)^2 w(x), with the hat w over one pitch so that neighbouring horns share a wheel; its
/// gradient gives the wall cases and, when a rim rides on the horn (o < delta), the top case. Returns the lanes
/// touched.
unsigned touch_guide(const Meeting& m, Loads& load, TrackSums& sums, Workspace& work) {
  const CompiledTrack& track = m.track;
  const Lanes zero = 0.0, one = 1.0, aside = m.center.y.abs();
  const Lanes weight = 1.0 - (1.0 / track.pitch) * m.center.x.abs();
  const Lanes s = m.center.z - (m.discs.radius + track.wheel_path_height), overlap = track.guide_height - s;
  const LaneMask engaged =
      m.near & LaneMask::of_bits(k_one_disc) & (zero < weight) & (zero < overlap) & (zero <= m.center.z);
  sums.guide_offset = sums.guide_offset.max(choose(engaged, aside, zero));

  const double slope = (track.guide_half_base - track.guide_half_top) / track.guide_height;
  const Lanes taper = choose(zero < s, slope * one, zero);
  const Lanes wall = aside + (track.guide_half_base - m.discs.half_gap) - taper * s;
  const LaneMask touching = engaged & (zero < wall), top = overlap < wall, pair_left = zero < m.center.y;
  const unsigned touched = bits_of(touching);
  if (touched == 0) return 0;

  const Lanes depth = choose(touching, overlap.min(wall), zero), k = track.guide.stiffness * weight;
  const Lanes normal = k * depth, along = 0.5 * track.guide.stiffness / track.pitch * depth * depth;
  const Lanes3 force{choose(zero < m.center.x, along, -along), choose(top, zero, choose(pair_left, -normal, normal)),
                     choose(top, normal, taper * normal)};
  const Lanes elastic = dot(force, force).sqrt();
  const Lanes closing = -dot(force, m.velocity) / elastic.max(k_least_force);
  const Lanes factor = normal_factor(track.guide, closing);
  load.elastic = LinkLoads::at(m.center, -force);
  load.lost = LinkLoads::at(m.center, (1.0 - factor) * force);
  const double arm = 0.1;  // m, of a force aside about the link's long axis
  const double mobility = m.mobility.moving + arm * arm * m.mobility.rolling;
  add_halves_to(work.stability[0] + m.first, choose(touching, mobility * k, zero));
  add_halves_to(work.stability[1] + m.first, mobility * track.guide.rate * elastic);
  sums.energy += 0.5 * normal * depth;
  sums.contact_power += elastic * (factor - 1.0) * closing;
  count_case(work, ContactCase::guide_top, touched & bits_of(top));
  count_case(work, ContactCase::guide_right_wall, touched & ~bits_of(top) & bits_of(pair_left));
  count_case(work, ContactCase::guide_left_wall, touched & ~bits_of(top) & ~bits_of(pair_left));
  return touched;
}

/// Loads on four links from `first` on, twice, and their opposite on the pair. Not handed a Meeting, which can then
/// stay in registers.
void push_apart(int first, const Loads& load_L, Partner partner, const State& state, LaneSpatial& on_pair,
                Workspace& work) {
  const LinkFrames frames(work, first);
  const Lanes3 lost = frames.to_world(load_L.lost.force), lost_torque = frames.to_world(load_L.lost.torque);
  const Lanes3 force = frames.to_world(load_L.elastic.force) + lost;
  const Lanes3 torque = frames.to_world(load_L.elastic.torque) + lost_torque;
  const auto add = [&](Field& field, const Lanes3& v) {
    add_halves_to(field[0] + first, v.x);
    add_halves_to(field[1] + first, v.y);
    add_halves_to(field[2] + first, v.z);
  };
  add(work.loss_force_W, lost);
  add(work.loss_torque_W, lost_torque);
  add(work.force_W, force);
  add(work.torque_W, torque);
  add(work.contact_force_W[static_cast<std::size_t>(partner)], force);
  const Lanes3 from_base = load_twice3(state.position, first) - in_all_lanes(state.chassis.position);
  on_pair.linear = on_pair.linear - force;
  on_pair.angular = on_pair.angular - (cross(from_base, force) + torque);
}

/// Both discs against wheel path and edges.
void meet_path(const Meeting& m, double stiffness, const State& state, LaneSpatial& on_pair, TrackSums& sums,
               Workspace& work) {
  const double o = m.track.lateral * m.discs.disc_offset;
  Loads load;
  const unsigned touching = touch_path(m, stiffness, Lanes::Values{-o, -o, -o, -o, o, o, o, o}, load, sums, work);
  if (touching == 0) return;
  push_apart(m.first, load, m.discs.partner, state, on_pair, work);
  const unsigned inner = touching & k_one_disc, outer = touching >> k_window;
  const unsigned edge = bits_of(0.5 * m.track.pitch < m.center.x.abs());
  count_case(work, ContactCase::one_disc_on_plate, (inner ^ outer) & ~edge);
  count_case(work, ContactCase::two_discs_on_plate, inner & outer & ~edge);
  count_case(work, ContactCase::one_disc_on_edge, (inner ^ outer) & edge);
  count_case(work, ContactCase::two_discs_on_edge, inner & outer & edge);
}

/// The horn stands once between the discs: the lanes of one disc count.
void meet_guide(const Meeting& m, const State& state, LaneSpatial& on_pair, TrackSums& sums, Workspace& work) {
  Loads load;
  const unsigned touched = touch_guide(m, load, sums, work);
  count_case(work, ContactCase::guide_none, bits_of(m.near) & k_one_disc & ~touched);
  if (touched != 0) push_apart(m.first, load, Partner::guide, state, on_pair, work);
}

/// Unit vector along which the centre of a wheel can go on its arm, in W; 0 on the hull.
Vector3d way_of_center(const Tree& tree, int body, const TreeWorkspace& work) {
  const int carrier = tree.bodies[static_cast<std::size_t>(body)].parent;
  if (carrier < 0) return Vector3d::Zero();
  const Vector3d arm = work.origin_W(body) - work.origin_W(carrier);
  return work.rotation(body).col(1).cross(arm).normalized();
}

void track_discs(const Tree& tree, const CompiledTrack& track, double stiffness_scale, const State& state,
                 Workspace& work) {
  const Mobility mobility{1.0 / track.mass, 1.0 / track.inertia.x(), 1.0 / track.inertia.z()};
  const Lanes3 base_W = in_all_lanes(state.chassis.position);
  TrackSums sums;
  for (const CompiledDiscs& discs : track.discs) {
    const BlockFrame wheel = work.chassis.spread_frame(discs.body);
    const Lanes3 center_W = base_W + wheel.origin_W, axle_W = wheel.rotation.y, spin_W = wheel.velocity.angular;
    const Lanes3 velocity_W = wheel.velocity.linear + cross(spin_W, wheel.origin_W);
    const Lanes3 way_W =
        in_all_lanes(work.bounds_step ? way_of_center(tree, discs.body, work.chassis) : Vector3d::Zero());
    const auto near = [&](int first) {
      const Lanes3 apart = center_W - load3(state.position, first);
      const Lanes z = dot(load_axis(work, 2, first), apart);
      return (dot(load_axis(work, 0, first), apart).abs() <= discs.reach_along) & (0.0 <= z) & (z <= discs.reach_up);
    };
    LaneSpatial on_pair{{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    const std::uint64_t blocks = blocks_near(track, work, center_W, discs.reach);
    for_windows<k_window>(track, blocks, near, [&](int first, unsigned bits) {
      const LinkFrames frames(work, first);
      const Lanes3 center = frames.to_links(center_W - load_twice3(state.position, first));
      const Lanes3 turn = load_twice3(state.angular_velocity, first);
      const Lanes3 velocity = frames.to_links(velocity_W - load_twice3(state.velocity, first)) - cross(turn, center);
      const Meeting meeting{track,
                            discs,
                            mobility,
                            first,
                            LaneMask::of_bits(bits | bits << k_window),
                            frames,
                            center,
                            frames.to_links(axle_W),
                            frames.to_links(spin_W) - turn,
                            velocity,
                            way_W};
      meet_path(meeting, stiffness_scale * discs.contact.stiffness, state, on_pair, sums, work);
      if (track.guide_height > 0.0) meet_guide(meeting, state, on_pair, sums, work);
    });
    work.chassis.add_force(discs.body, on_pair);
  }
  work.energy.contact += sums.energy.sum();
  work.energy.contact_power += sums.contact_power.sum();
  work.energy.friction_power += sums.friction_power.sum();
  double& offset = work.lateral_guide_offset[static_cast<std::size_t>(index_of(track.side))];
  offset = std::max(offset, sums.guide_offset.max_lane());
}

}  // namespace

void disc_contacts(const System& system, const AssemblyKnobs& knobs, const State& state, Workspace& work) {
  for (const CompiledTrack& track : system.tracks) track_discs(system.tree, track, knobs.stiffness_scale, state, work);
}

}  // namespace grouser
