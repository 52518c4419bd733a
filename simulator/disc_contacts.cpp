#include "simulator/contacts.h"

namespace grouser {
namespace {

/// A disc pair met by one link: the pair's centre in the link frame and the relative velocity of the two bodies there.
struct Meeting {
  const CompiledTrack& track;
  const CompiledDiscs& discs;
  const LinkView& link;
  Vector3d center_from_link_W;  ///< pair centre less link centre
  Vector3d center_from_base_W;  ///< pair centre less the base's centre of mass
  Vector3d axle_W;              ///< unit vector along the axle
};

/// Contact patch of a disc on the wheel path as an elastic foundation of stiffness k [N/m^2]: energy k/2 int delta^2 dx
/// with delta = depth - x^2 / 2R over the part of the plate below the disc. Closed polynomials; smooth hand-over from
/// link to link.
struct Patch {
  bool touching = false;
  double force_x = 0.0, force_z = 0.0;  ///< on the disc, link frame, per unit k
  double energy = 0.0;                  ///< per unit k
  double center = 0.0;                  ///< x of the pressure's centroid from the disc centre
  double width = 0.0;
};

Patch foundation(double depth, double radius, double from, double to) {
  Patch patch;
  if (depth <= 0.0) return patch;
  const double reach = std::sqrt(2.0 * radius * depth);
  const double a = std::max(-reach, from), b = std::min(reach, to);
  if (a >= b) return patch;
  const double a3 = a * a * a, b3 = b * b * b;
  const double area = depth * (b - a) - (b3 - a3) / (6.0 * radius);
  if (area <= 0.0) return patch;
  const double slope = depth * (b * b - a * a) / (2.0 * radius) - (b3 * b - a3 * a) / (8.0 * radius * radius);
  patch.touching = true;
  patch.force_x = -slope;
  patch.force_z = area;
  patch.energy = 0.5 * (depth * depth * (b - a) - depth * (b3 - a3) / (3.0 * radius) +
                        (b3 * b * b - a3 * a * a) / (20.0 * radius * radius));
  patch.center = radius * slope / area;
  patch.width = b - a;
  return patch;
}

void add_stability(Workspace& work, const CompiledTrack& track, int i, double stiffness, double damping, double x,
                   double y, double z) {
  const double mobility_n = 1.0 / track.mass + x * x / track.inertia.y() + y * y / track.inertia.x();
  const double mobility_t = 1.0 / track.mass + z * z / track.inertia.y();
  work.stability[0][i] += stiffness * mobility_n;
  work.stability[1][i] += damping * mobility_t;
}

/// One disc on plate or edge. Returns whether it touches.
bool touch_path(const Meeting& m, double stiffness, double lateral, const Vector3d& velocity_W, const Vector3d& spin_W,
                LinkLoad& load, Workspace& work) {
  const CompiledTrack& track = m.track;
  const Vector3d disc_from_link = m.center_from_link_W + lateral * m.axle_W;
  const Vector3d disc = m.link.rotation.transpose() * disc_from_link;
  if (disc.z() < 0.0 || std::abs(disc.y()) > track.half_width) return false;
  const double half = 0.5 * track.pitch, radius = m.discs.radius;
  const Patch patch =
      foundation(track.wheel_path_height - disc.z() + radius, radius, -half - disc.x(), half - disc.x());
  if (!patch.touching) return false;

  const Vector3d disc_velocity = velocity_W + spin_W.cross(lateral * m.axle_W);
  const Vector3d rate = m.link.rotation.transpose() * (disc_velocity - m.link.velocity_at(disc_from_link));
  const double fx = stiffness * patch.force_x, fz = stiffness * patch.force_z, elastic = std::sqrt(fx * fx + fz * fz);
  const double closing = -(fx * rate.x() + fz * rate.z()) / elastic;
  const double factor = normal_factor(m.discs.contact, closing), normal = elastic * factor;

  const Vector3d patch_in_link(disc.x() + patch.center, disc.y(), track.wheel_path_height);
  const Vector3d patch_from_link = m.link.rotation * patch_in_link;
  const Vector3d rim_velocity = disc_velocity + spin_W.cross(patch_from_link - disc_from_link);
  Vector3d slip = m.link.rotation.transpose() * (rim_velocity - m.link.velocity_at(patch_from_link));
  slip.z() = 0.0;
  const double q = sliding_friction(m.discs.contact, normal, slip.squaredNorm());

  const Vector3d push = m.link.rotation * Vector3d(fx * factor, 0.0, fz * factor);
  const Vector3d drag = m.link.rotation * Vector3d(-q * slip);
  const Vector3d base_offset = m.center_from_base_W - m.center_from_link_W;
  work.chassis.add_force(m.discs.body, base_offset + disc_from_link, push);
  work.chassis.add_force(m.discs.body, base_offset + patch_from_link, drag);
  load.add(disc_from_link, -push);
  load.add(patch_from_link, -drag);

  const double steepest = std::min(m.discs.contact.friction_slope_limit,
                                   m.discs.contact.friction * normal / m.discs.contact.friction_speed);
  add_stability(work, track, m.link.index, stiffness * patch.width, 0.0, disc.x(), disc.y(), 0.0);
  add_stability(work, track, m.link.index, 0.0, steepest, 0.0, 0.0, track.wheel_path_height);
  work.stability[1][m.link.index] +=
      elastic * m.discs.contact.rate * (1.0 / track.mass + disc.x() * disc.x() / track.inertia.y());
  work.rim_damping[static_cast<std::size_t>(m.discs.body)] += steepest;
  work.energy.contact += stiffness * patch.energy;
  work.energy.contact_power += elastic * (factor - 1.0) * closing;
  work.energy.friction_power += q * slip.squaredNorm();
  return true;
}

/// Centre guide between the discs: a tapered horn. With s the height of the rims' lowest points above the wheel path,
/// the wall stands at half width t(s); wall penetration delta = |y| + t(s) - half gap, top overlap o = height - s. The
/// energy is k/2 min(delta, o)^2 w(x), with the hat w over one pitch so that neighbouring horns share a wheel; its
/// gradient gives the wall cases and, when a rim rides on the horn (o < delta), the top case.
ContactCase touch_guide(const Meeting& m, const Vector3d& velocity_W, Workspace& work) {
  const CompiledTrack& track = m.track;
  const Vector3d center = m.link.rotation.transpose() * m.center_from_link_W;
  const double weight = 1.0 - std::abs(center.x()) / track.pitch;
  const double s = center.z() - m.discs.radius - track.wheel_path_height, overlap = track.guide_height - s;
  if (weight <= 0.0 || overlap <= 0.0 || center.z() < 0.0) return ContactCase::guide_none;
  const auto side = static_cast<std::size_t>(index_of(track.side));
  work.lateral_guide_offset[side] = std::max(work.lateral_guide_offset[side], std::abs(center.y()));

  const double taper = s > 0.0 ? (track.guide_half_base - track.guide_half_top) / track.guide_height : 0.0;
  const double wall = std::abs(center.y()) + track.guide_half_base - taper * s - m.discs.half_gap;
  if (wall <= 0.0) return ContactCase::guide_none;
  const double sign = center.y() > 0.0 ? 1.0 : -1.0;
  const bool top = overlap < wall;
  const double depth = top ? overlap : wall, k = track.guide.stiffness * weight;
  Vector3d force(0.5 * track.guide.stiffness * depth * depth * (center.x() > 0.0 ? 1.0 : -1.0) / track.pitch, 0.0, 0.0);
  if (top) {
    force.z() = k * depth;
  } else {
    force.y() = -sign * k * depth;
    force.z() = taper * k * depth;
  }
  const double elastic = force.norm();
  const Vector3d rate = m.link.rotation.transpose() * (velocity_W - m.link.velocity_at(m.center_from_link_W));
  const double closing = -force.dot(rate) / elastic;
  const double factor = normal_factor(track.guide, closing);
  const Vector3d push = m.link.rotation * (factor * force);
  work.chassis.add_force(m.discs.body, m.center_from_base_W, push);
  LinkLoad load;
  load.add(m.center_from_link_W, -push);
  push_link(work, m.link.index, load, Partner::guide);
  add_stability(work, track, m.link.index, k, 0.0, 0.0, 0.1, 0.0);
  work.energy.contact += 0.5 * k * depth * depth;
  work.energy.contact_power += elastic * (factor - 1.0) * closing;
  if (top) return ContactCase::guide_top;
  return sign < 0.0 ? ContactCase::guide_left_wall : ContactCase::guide_right_wall;
}

void count(Workspace& work, ContactCase which) { ++work.case_count[static_cast<std::size_t>(which)]; }

void meet(const Meeting& m, double stiffness_scale, Workspace& work) {
  const Vector3d velocity = work.chassis.velocity_at(m.discs.body, m.center_from_base_W);
  const Vector3d spin = work.chassis.angular_velocity_W[static_cast<std::size_t>(m.discs.body)];
  const double stiffness = stiffness_scale * m.discs.contact.stiffness;
  int touching = 0;
  LinkLoad load;
  const double outwards = m.track.lateral * m.discs.disc_offset;
  for (const double lateral : {-outwards, outwards}) {
    touching += touch_path(m, stiffness, lateral, velocity, spin, load, work) ? 1 : 0;
  }
  if (touching > 0) {
    push_link(work, m.link.index, load, m.discs.partner);
    const double along = m.link.rotation.col(0).dot(m.center_from_link_W);
    const bool edge = std::abs(along) > 0.5 * m.track.pitch;
    count(work, edge ? (touching == 2 ? ContactCase::two_discs_on_edge : ContactCase::one_disc_on_edge)
                     : (touching == 2 ? ContactCase::two_discs_on_plate : ContactCase::one_disc_on_plate));
  }
  if (m.track.guide_height > 0.0) count(work, touch_guide(m, velocity, work));
}

}  // namespace

void disc_contacts(const System& system, const AssemblyKnobs& knobs, const State& state, Workspace& work) {
  for (const CompiledTrack& track : system.tracks) {
    // A link can touch while its centre is this much farther from the axle than the rim: half a link and the plate's
    // height.
    const double reach = std::hypot(track.pitch, std::max(track.wheel_path_height + track.guide_height, 0.0)) + 0.02;
    for (const CompiledDiscs& discs : track.discs) {
      const auto body = static_cast<std::size_t>(discs.body);
      const Vector3d center = state.chassis.position + work.chassis.origin_W[body];
      const Vector3d axle = work.chassis.rotation[body].col(1);
      for_links_within(track, state, center, discs.radius + reach, [&](int i) {
        const LinkView link = view_link(state, work, i);
        meet({track, discs, link, center - link.position, work.chassis.origin_W[body], axle}, knobs.stiffness_scale,
             work);
      });
    }
  }
}

}  // namespace grouser
