#include "simulator/stability.h"

#include <algorithm>
#include <cmath>

#include "simulator/integrator.h"

namespace grouser {
namespace {

/// One of the two bodies of a joint: its kind, and the pin's place along its x axis from its centre [m].
struct Jointed {
  const LinkBodies& body;
  double pin;
};

/// Eight joints as one of their bodies feels them: stiffness (or damping) along x, z in the plane of the body, x to z,
/// and about y; aside and about the other axes.
struct JointTangents {
  Lanes xx, zz, xz, hinge, aside, swing;
};

/// The tangents of joints from `joint` on in the frames of their own bodies; lanes behind the last are padding.
JointTangents own_tangents(const Field& k, int joint, const LaneMask& valid) {
  const auto at = [&](int axis) { return choose(valid, load(k[axis] + joint), 0.0); };
  return {at(0), at(2), 0.0, at(4), at(1), at(3).max(at(5))};
}

/// The same in frames turned so that own x has the components (cosine, sine) along x and z.
JointTangents turned(const JointTangents& k, const Lanes& cosine, const Lanes& sine) {
  const Lanes cc = cosine * cosine, ss = sine * sine;
  return {k.xx * cc + k.zz * ss, k.xx * ss + k.zz * cc, (k.xx - k.zz) * cosine * sine, k.hinge, k.aside, k.swing};
}

/// Where stiffness or damping goes.
struct Blocks {
  Field &plane, &side;
};

/// Adds to the blocks of eight bodies what is 2 (e = 1) times their side of each joint.
void add_joint(const JointTangents& k, const Jointed& at, int first, const Blocks& to) {
  const double pin = at.pin;
  add_block(to.plane, first, {k.xx, k.zz, pin * pin * k.zz + k.hinge, k.xz, -pin * k.xz, -pin * k.zz}, 2.0);
  const Vector3d& inertia = at.body.inertia;
  add_side(to.side, first, {1.0 / at.body.mass, pin * pin / inertia.z()}, 2.0 * k.aside, pin > 0.0 ? 1.0 : -1.0);
  add_to(to.side[1] + first, (2.0 / std::min(inertia.x(), inertia.z())) * k.swing);
}

/// `count` joints from `joint` on, between bodies from `own` and from `next` on.
void add_joints(const Field& tangents, int joint, int count, const Jointed& own, int own_first, const Jointed& next,
                int next_first, const Blocks& to, const Workspace& work) {
  for (int k = 0; k < count; k += k_lanes) {
    const auto axis = [&](int c, int first) {
      const auto r = [&](int row) { return load(work.rotation[3 * row + c] + first + k); };
      return Lanes3{r(0), r(1), r(2)};
    };
    const Lanes3 own_x = axis(0, own_first);
    const JointTangents of_own = own_tangents(tangents, joint + k, LaneMask::first(count - k));
    const JointTangents of_next = turned(of_own, dot(own_x, axis(0, next_first)), dot(own_x, axis(2, next_first)));
    add_joint(of_own, own, own_first + k, to);
    add_joint(of_next, next, next_first + k, to);
  }
}

/// The link ahead of the last joint is the first one: what was put on its copy behind the last link is its own.
void close_seam(const CompiledTrack& track, Field& field) {
  const int first = track.offset, copy = track.offset + track.num_links;
  for (int c = 0; c < field.components(); ++c) {
    field[c][first] += field[c][copy];
    field[c][copy] = 0.0;
  }
}

void add_track_joints(const CompiledTrack& track, const Field& tangents, const Blocks& to, const Workspace& work) {
  const int n = track.num_links, first = track.offset;
  const LinkBodies& links = track.bodies.front();
  if (track.joint == JointForm::connector_bodies) {
    const LinkBodies& connectors = track.bodies.back();
    const double half = 0.5 * track.connector_length;
    const int rear = connectors.offset;
    add_joints(tangents, first, n, {links, track.groove}, first, {connectors, -half}, rear, to, work);
    add_joints(tangents, rear, n, {links, -track.groove}, first + 1, {connectors, half}, rear, to, work);
  } else {
    const double half = 0.5 * track.pitch;
    add_joints(tangents, first, n, {links, half}, first, {links, -half}, first + 1, to, work);
  }
}

/// A block over the roots of mass and inertia.
PlaneBlock over_inertia(const Field& blocks, int first, const LinkBodies& body) {
  const double m = 1.0 / body.mass, j = 1.0 / body.inertia.y(), mj = std::sqrt(m * j);
  const auto at = [&](int row) { return load(blocks[row] + first); };
  return {m * at(k_xx), m * at(k_zz), j * at(k_pitch), m * at(k_xz), mj * at(k_x_pitch), mj * at(k_z_pitch)};
}

/// 2 / h from a h^2 s2 + 4 h s1 = 4.
Lanes rate_of(const Lanes& a_s2, const Lanes& s1) { return s1 + (s1 * s1 + a_s2).sqrt(); }

Lanes trace(const PlaneBlock& block) { return block[k_xx] + block[k_zz] + block[k_pitch]; }

/// The larger eigenvalue of a side block.
Lanes largest_of_side(const Field& side, int i) {
  const Lanes across = load(side[0] + i), turning = load(side[1] + i), both = load(side[2] + i);
  const Lanes half = 0.5 * (across - turning);
  return 0.5 * (across + turning) + (half * half + both * both).sqrt();
}

/// 2 / h of eight links.
struct LinkSums {
  PlaneBlock stiffness, damping;
  Lanes s2, s1;          ///< of all motions
  Lanes side_2, side_1;  ///< of motions out of the plane

  LinkSums(const LinkBodies& body, int i, const Workspace& work)
      : stiffness(over_inertia(work.plane_stiffness, i, body)),
        damping(over_inertia(work.plane_damping, i, body)),
        s2(load(work.stability[0] + i)),
        s1(load(work.stability[1] + i)),
        side_2(largest_of_side(work.side_stiffness, i)),
        side_1(largest_of_side(work.side_damping, i)) {}

  [[nodiscard]] Lanes out_of_plane(double a) const { return rate_of(a * (s2 + side_2), s1 + side_1); }
  /// A(h) in the plane.
  [[nodiscard]] PlaneBlock at_step(const Lanes& of_stiffness, const Lanes& of_damping) const {
    const Lanes any = of_stiffness * s2 + of_damping * s1;
    PlaneBlock sum;
    for (std::size_t row = 0; row < sum.size(); ++row) {
      sum[row] = of_stiffness * stiffness[row] + of_damping * damping[row];
    }
    for (const PlaneRow row : {k_xx, k_zz, k_pitch}) sum[row] += any;
    return sum;
  }
  /// Lanes that are stable at h: all leading minors of 4 - A are positive.
  [[nodiscard]] LaneMask stable_at(double a, double h) const {
    const PlaneBlock b = at_step(a * h * h, 4.0 * h);
    const Lanes x = 4.0 - b[k_xx], z = 4.0 - b[k_zz], pitch = 4.0 - b[k_pitch];
    const Lanes two = x * z - b[k_xz].square();
    const Lanes three = pitch * two - x * b[k_z_pitch].square() - z * b[k_x_pitch].square() -
                        2.0 * b[k_xz] * b[k_x_pitch] * b[k_z_pitch];
    return (0.0 < x) & (0.0 < two) & (0.0 < three) & (out_of_plane(a) <= 2.0 / h);
  }
  /// First with the largest eigenvalues of both blocks, as if they shared their vectors; then once with that of A at
  /// the step found, which grows at most with its square: both are safe. Secants in 1 / h make it exact, to round-off
  /// or nearly: which blocks are looked at after one another must not show in the step, for a vehicle has two sides.
  [[nodiscard]] Lanes in_plane(double a) const {
    constexpr int k_secants = 4;
    const auto largest_at = [&](const Lanes& rate) {
      const Lanes h = 2.0 / rate;
      return largest_eigenvalue(at_step(a * h * h, 4.0 * h));
    };
    Lanes last = rate_of(a * (s2 + largest_eigenvalue(stiffness)), s1 + largest_eigenvalue(damping));
    Lanes last_value = largest_at(last), rate = last * (0.25 * last_value.min(4.0)).sqrt();
    for (int n = 0; n < k_secants; ++n) {
      const Lanes value = largest_at(rate), step = rate - last, change = value - last_value;
      if (bits_of((value - 4.0).abs() > 1e-12) == 0) break;
      const LaneMask moved = change.abs() > 1e-12;
      last = rate;
      last_value = value;
      rate = rate + choose(moved, (4.0 - value) * step / choose(moved, change, 1.0), 0.0);
    }
    return rate;
  }
};

/// The shortest stable step, 2 / rate, belongs to the largest rate.
void find_bound(const LinkBodies& bodies, double beta, Workspace& work) {
  const double a = 4.0 * beta - 3.0;
  double largest = 2.0 / work.largest_stable_step;
  for (int k = 0; k < bodies.count; k += k_lanes) {
    const int i = bodies.offset + k;
    const LinkSums sums(bodies, i, work);
    const LaneMask valid = LaneMask::first(bodies.count - k);
    if (std::isfinite(work.largest_stable_step) && bits_of(valid & !sums.stable_at(a, work.largest_stable_step)) == 0) {
      continue;
    }
    const Lanes rate = choose(valid, sums.out_of_plane(a).max(sums.in_plane(a)), 0.0);
    for (int lane = 0; lane < k_lanes; ++lane) {
      if (rate[lane] <= largest) continue;
      largest = rate[lane];
      work.largest_stable_step = 2.0 / largest;
      work.bounding = {i + lane, -1};
    }
  }
}

/// What a push on a wheel moves: its rim by spin, its centre on an arm [1/kg]. Constraints make mobilities smaller, so
/// the arm's mass is left out; a centre on the hull stands still, for the hull is a thousand times heavier than a link.
struct WheelMobility {
  double spin = 0.0, center = 0.0;
};
WheelMobility wheel_mobility(const Tree& tree, int body, double radius) {
  const TreeBody& wheel = tree.bodies[static_cast<std::size_t>(body)];
  return {wheel.prescribed ? 0.0 : radius * radius / wheel.axis.dot(wheel.inertia * wheel.axis),
          wheel.parent < 0 ? 0.0 : 1.0 / wheel.mass};
}

bool has_dampers(const CompiledTrack& track) {
  return std::any_of(track.bushing.begin(), track.bushing.end(), [](const CompiledAxis& a) { return a.viscous > 0.0; });
}

void bound_wheel(const System& system, int body, double radius, const ContactShare& share, Workspace& work) {
  const RimSums& rim = work.rim[static_cast<std::size_t>(body)];
  const WheelMobility m = wheel_mobility(system.tree, body, radius);
  const double spin = m.spin * rim.spin, center = m.center * rim.damping, half = 0.5 * (spin - center),
               both = std::sqrt(m.spin * m.center) * rim.both;
  const double s1 = share.wheel * (0.5 * (spin + center) + std::sqrt(half * half + both * both)),
               s2 = share.wheel * m.center * rim.stiffness;
  const double h = stable_step(system.scenario.integrator.beta, s2, s1);
  if (h >= work.largest_stable_step) return;
  work.largest_stable_step = h;
  work.bounding = {-1, body};
}

}  // namespace

Lanes largest_eigenvalue(const PlaneBlock& a) {
  constexpr double k_least = 1e-100;  // keeps 0 / 0 away from multiples of the unit matrix
  const Lanes mean = (1.0 / 3.0) * trace(a);
  const Lanes x = a[k_xx] - mean, y = a[k_zz] - mean, z = a[k_pitch] - mean;
  const Lanes xy2 = a[k_xz].square(), xz2 = a[k_x_pitch].square(), yz2 = a[k_z_pitch].square();
  // lambda = mean + p r with r^3 - 3 r - 2 d = 0, -1 <= d <= 1 and the largest root r = 2 cos(arccos(d) / 3).
  const Lanes p2 = (1.0 / 6.0) * (x * x + y * y + z * z) + (1.0 / 3.0) * (xy2 + xz2 + yz2);
  const Lanes p = p2.sqrt().max(k_least);
  const Lanes determinant = x * (y * z - yz2) - z * xy2 - y * xz2 + 2.0 * a[k_xz] * a[k_x_pitch] * a[k_z_pitch];
  const Lanes d = (0.5 * determinant / (p * p * p)).max(-1.0).min(1.0);
  Lanes r = (1.7320508075688773 + (1.0 / 3.0) * d).min(2.0);  // the tangent at d = 0 of a concave function
  for (int n = 0; n < 8; ++n) {
    const Lanes next = (2.0 / 3.0) * (r * r * r + d) / (r * r - 1.0);
    if (bits_of(next < r) == 0) break;  // it falls until round-off
    r = r.min(next);
  }
  return mean + p * r;
}

ContactShare contact_share(const Tree& tree, int body, double radius, double link_mobility, double num_links) {
  const double e = num_links * wheel_mobility(tree, body, radius).spin / link_mobility;
  return {1.0 + e, e > 0.0 ? 1.0 + 1.0 / e : 0.0};
}

void bound_step(const System& system, bool relaxed, double longest, Workspace& work) {
  work.largest_stable_step = longest;
  for (const CompiledTrack& track : system.tracks) {
    add_track_joints(track, work.joint_stiffness, {work.plane_stiffness, work.side_stiffness}, work);
    if (relaxed || has_dampers(track)) {
      add_track_joints(track, work.joint_damping, {work.plane_damping, work.side_damping}, work);
    }
    for (Field* field :
         {&work.plane_stiffness, &work.plane_damping, &work.side_stiffness, &work.side_damping, &work.stability}) {
      close_seam(track, *field);
    }
    for (const LinkBodies& bodies : track.bodies) find_bound(bodies, system.scenario.integrator.beta, work);
    for (const CompiledDiscs& discs : track.discs) bound_wheel(system, discs.body, discs.radius, discs.share, work);
    bound_wheel(system, track.sprocket.body, track.sprocket.pitch_radius, track.sprocket.share, work);
  }
}

}  // namespace grouser
