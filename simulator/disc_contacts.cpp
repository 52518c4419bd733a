#include "simulator/contacts.h"

namespace grouser {
namespace {

/// What the contacts of one track leave to be summed over lanes at its end.
struct TrackSums {
  Lanes energy = 0.0, contact_power = 0.0, friction_power = 0.0;
  Lanes guide_offset = 0.0;
};

/// A disc pair met by eight links in a row, each in its own link frame L.
struct Meeting {
  const CompiledTrack& track;
  const CompiledDiscs& discs;
  int first;        ///< link array index of lane 0
  LaneMask near;    ///< lanes that count
  Lanes3 center;    ///< the pair's centre from the link's [m]
  Lanes3 axle;      ///< unit vector
  Lanes3 spin;      ///< angular velocity of the pair against the link [rad/s]
  Lanes3 velocity;  ///< of the pair's centre against the point of the link that stands there [m/s]
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
  const Lanes area = (depth * width - (curvature / 6.0) * cubes).max(0.0);
  const Lanes slope = (0.5 * curvature) * depth * (b2 - a2) - (0.125 * curvature * curvature) * (b2 * b2 - a2 * a2);
  const Lanes energy =
      0.5 * depth * (depth * width - (curvature / 3.0) * cubes) + (0.025 * curvature * curvature) * (b3 * b2 - a3 * a2);
  return {-slope, area, energy, (radius * slope / area.max(k_least_area)).max(a).min(b), width};
}

/// One disc on plate or edge. Returns the lanes that it touches.
unsigned touch_path(const Meeting& m, double stiffness, double lateral, LinkLoads& load, TrackSums& sums,
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
  const Lanes closing = -(fx * rate.x + fz * rate.z) / elastic.max(k_least_force);
  const Lanes factor = normal_factor(law, closing), normal = elastic * factor;

  const Lanes3 place{disc.x + patch.center, disc.y, path};
  const Lanes3 slip = m.velocity + cross(m.spin, place - m.center);
  const Lanes slip2 = slip.x * slip.x + slip.y * slip.y;
  const Lanes q = sliding_friction(law, normal, slip2);
  load.add(disc, {-fx * factor, 0.0, -fz * factor});
  load.add(place, {q * slip.x, q * slip.y, 0.0});

  const double moving = 1.0 / track.mass, pitching = 1.0 / track.inertia.y(), rolling = 1.0 / track.inertia.x();
  const Lanes steepest = steepest_friction(law, normal);
  const Lanes x_mobility = moving + pitching * disc.x * disc.x;
  add_to(work.stability[0] + m.first, stiffness * patch.width * (x_mobility + rolling * disc.y * disc.y));
  add_to(work.stability[1] + m.first, (moving + pitching * path * path) * steepest + law.rate * elastic * x_mobility);
  work.rim_damping[static_cast<std::size_t>(m.discs.body)] += steepest.sum();
  sums.energy += stiffness * patch.energy;
  sums.contact_power += elastic * (factor - 1.0) * closing;
  sums.friction_power += q * slip2;
  return touching;
}

/// Centre guide between the discs: a tapered horn. With s the height of the rims' lowest points above the wheel path,
/// the wall stands at half width t(s); wall penetration delta = |y| + t(s) - half gap, top overlap o = height - s. The
/// energy is k/2 min(delta, o)^2 w(x), with the hat w over one pitch so that neighbouring horns share a wheel; its
/// gradient gives the wall cases and, when a rim rides on the horn (o < delta), the top case. Returns the lanes
/// touched.
unsigned touch_guide(const Meeting& m, LinkLoads& load, TrackSums& sums, Workspace& work) {
  const CompiledTrack& track = m.track;
  const Lanes zero = 0.0, one = 1.0, aside = m.center.y.abs();
  const Lanes weight = 1.0 - (1.0 / track.pitch) * m.center.x.abs();
  const Lanes s = m.center.z - (m.discs.radius + track.wheel_path_height), overlap = track.guide_height - s;
  const LaneMask engaged = m.near & (zero < weight) & (zero < overlap) & (zero <= m.center.z);
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
  load.add(m.center, -factor * force);
  const double arm = 0.1;  // m, of a force aside about the link's long axis
  add_to(work.stability[0] + m.first, choose(touching, (1.0 / track.mass + arm * arm / track.inertia.x()) * k, zero));
  sums.energy += 0.5 * normal * depth;
  sums.contact_power += elastic * (factor - 1.0) * closing;
  count_case(work, ContactCase::guide_top, touched & bits_of(top));
  count_case(work, ContactCase::guide_right_wall, touched & ~bits_of(top) & bits_of(pair_left));
  count_case(work, ContactCase::guide_left_wall, touched & ~bits_of(top) & ~bits_of(pair_left));
  return touched;
}

void push_apart(const Meeting& m, const LinkLoads& load_L, Partner partner, const State& state, BodyLoad& on_pair,
                Workspace& work) {
  const LinkLoads load_W{to_world(work, m.first, load_L.force), to_world(work, m.first, load_L.torque)};
  grouser::push_apart(state, work, m.first, load_W, on_pair, partner);
}

/// Both discs against wheel path and edges.
void meet_path(const Meeting& m, double stiffness, const State& state, BodyLoad& on_pair, TrackSums& sums,
               Workspace& work) {
  const double outwards = m.track.lateral * m.discs.disc_offset;
  LinkLoads load;
  const unsigned inner = touch_path(m, stiffness, -outwards, load, sums, work);
  const unsigned outer = touch_path(m, stiffness, outwards, load, sums, work);
  if ((inner | outer) == 0) return;
  push_apart(m, load, m.discs.partner, state, on_pair, work);
  const unsigned edge = bits_of(0.5 * m.track.pitch < m.center.x.abs());
  count_case(work, ContactCase::one_disc_on_plate, (inner ^ outer) & ~edge);
  count_case(work, ContactCase::two_discs_on_plate, inner & outer & ~edge);
  count_case(work, ContactCase::one_disc_on_edge, (inner ^ outer) & edge);
  count_case(work, ContactCase::two_discs_on_edge, inner & outer & edge);
}

void meet_guide(const Meeting& m, const State& state, BodyLoad& on_pair, TrackSums& sums, Workspace& work) {
  LinkLoads load;
  const unsigned touched = touch_guide(m, load, sums, work);
  count_case(work, ContactCase::guide_none, bits_of(m.near) & ~touched);
  if (touched != 0) push_apart(m, load, Partner::guide, state, on_pair, work);
}

void track_discs(const CompiledTrack& track, double stiffness_scale, const State& state, Workspace& work) {
  // A link can touch while its centre is this much farther from the axle than the rim: half a link and the plate's
  // height.
  const double height = std::max(track.wheel_path_height + track.guide_height, 0.0);
  const double reach = std::sqrt(track.pitch * track.pitch + height * height) + 0.02;
  TrackSums sums;
  for (const CompiledDiscs& discs : track.discs) {
    const auto body = static_cast<std::size_t>(discs.body);
    const Vector3d from_base = work.chassis.origin_W[body], center_W = state.chassis.position + from_base;
    const Lanes3 axle_W = in_all_lanes(work.chassis.rotation[body].col(1));
    const Lanes3 spin_W = in_all_lanes(work.chassis.angular_velocity_W[body]);
    const Lanes3 velocity_W = in_all_lanes(work.chassis.velocity_at(discs.body, from_base));
    BodyLoad on_pair;
    for_links_within(track, state, work, center_W, discs.radius + reach, 0, [&](int first, const LaneMask& near) {
      const Lanes3 center = to_links(work, first, in_all_lanes(center_W) - load3(state.position, first));
      const Lanes3 turn = load3(state.angular_velocity, first);
      const Lanes3 velocity = to_links(work, first, velocity_W - load3(state.velocity, first)) - cross(turn, center);
      const Meeting meeting{
          track,   discs, first, near, center, to_links(work, first, axle_W), to_links(work, first, spin_W) - turn,
          velocity};
      meet_path(meeting, stiffness_scale * discs.contact.stiffness, state, on_pair, sums, work);
      if (track.guide_height > 0.0) meet_guide(meeting, state, on_pair, sums, work);
    });
    push_body(work, discs.body, on_pair);
  }
  work.energy.contact += sums.energy.sum();
  work.energy.contact_power += sums.contact_power.sum();
  work.energy.friction_power += sums.friction_power.sum();
  double& offset = work.lateral_guide_offset[static_cast<std::size_t>(index_of(track.side))];
  offset = std::max(offset, sums.guide_offset.max_lane());
}

}  // namespace

void disc_contacts(const System& system, const AssemblyKnobs& knobs, const State& state, Workspace& work) {
  for (const CompiledTrack& track : system.tracks) track_discs(track, knobs.stiffness_scale, state, work);
}

}  // namespace grouser
