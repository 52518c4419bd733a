#include "simulator/stability.h"

#include <algorithm>
#include <cmath>

#include "simulator/contacts.h"
#include "simulator/integrator.h"

namespace grouser {
namespace {

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

/// Joints in a row: `joint` in the arrays of joints, between `own` and `next` in those of links.
struct JointRow {
  int joint, own, next;
};

/// One of the two pins that every body of a kind has: the k-th body is own or next body of the k-th joint, or, where
/// the joints stand `behind` the bodies, of the one before.
struct Pin {
  JointRow row;
  bool of_own, behind;
  double place;  ///< along the body's x axis from its centre [m]
};

/// What eight bodies from `i` on are held by: by contacts, then by joints too.
struct Slopes {
  PlaneBlock plane;
  std::array<Lanes, 3> side;
  Slopes(const Field& of_plane, const Field& of_side, int i) {
    for (int row = 0; row < k_plane_rows; ++row) plane[static_cast<std::size_t>(row)] = load(of_plane[row] + i);
    side = {load(of_side[0] + i), load(of_side[1] + i), load(of_side[2] + i)};
  }
};

/// Constants by which a pin's tangents add to the blocks of its bodies, twice (e = 1) their side of each joint.
struct PinShares {
  double pin, across, turning, both, swing;
  PinShares(const LinkBodies& body, const Pin& at)
      : pin(at.place),
        across(2.0 / body.mass),
        turning(2.0 * pin * pin / body.inertia.z()),
        both((pin > 0.0 ? 1.0 : -1.0) * std::sqrt(across * turning)),
        swing(2.0 / std::min(body.inertia.x(), body.inertia.z())) {}
  void add(const JointTangents& k, Slopes& to) const {
    const PlaneBlock block{k.xx, k.zz, pin * pin * k.zz + k.hinge, k.xz, -pin * k.xz, -pin * k.zz};
    for (std::size_t row = 0; row < block.size(); ++row) to.plane[row] += 2.0 * block[row];
    to.side[0] += across * k.aside;
    to.side[1] += turning * k.aside + swing * k.swing;
    to.side[2] += both * k.aside;
  }
};

/// The lanes one place further: the last of `before`, then all of `now` but its last.
JointTangents one_behind(const JointTangents& before, const JointTangents& now) {
  return {one_behind(before.xx, now.xx),       one_behind(before.zz, now.zz),
          one_behind(before.xz, now.xz),       one_behind(before.hinge, now.hinge),
          one_behind(before.aside, now.aside), one_behind(before.swing, now.swing)};
}
/// The first lane of all.
JointTangents first_lane(const JointTangents& k) {
  return {k.xx[0], k.zz[0], k.xz[0], k.hinge[0], k.aside[0], k.swing[0]};
}

/// Goes along the joints at one pin of all bodies of a kind, eight after eight.
class JointWalk {
 public:
  JointWalk(const Field& tangents, const Pin& pin, const LinkBodies& body, const Workspace& work)
      : tangents_(tangents), pin_(pin), shares_(body, pin), count_(body.count), work_(work) {
    if (pin.behind && count_ > 0) before_ = first_lane(at(count_ - 1));  // the first body lies ahead of the last joint
  }
  /// Adds the joints of the bodies from the k-th on.
  void add(int k, Slopes& to) {
    const JointTangents now = at(k);
    shares_.add(pin_.behind ? one_behind(before_, now) : now, to);
    before_ = now;
  }

 private:
  [[nodiscard]] JointTangents at(int k) const {
    const JointTangents of_own = own_tangents(tangents_, pin_.row.joint + k, LaneMask::first(count_ - k));
    if (pin_.of_own) return of_own;
    const Lanes3 own_x = load_axis(work_, 0, pin_.row.own + k);
    return turned(of_own, dot(own_x, load_axis(work_, 0, pin_.row.next + k)),
                  dot(own_x, load_axis(work_, 2, pin_.row.next + k)));
  }

  const Field& tangents_;
  const Pin& pin_;
  PinShares shares_;
  int count_;
  const Workspace& work_;
  JointTangents before_{};
};

/// The pins of what is integrated of a track: of its links, or (`connectors`) of bodies between them.
std::array<Pin, 2> pins_of(const CompiledTrack& track, bool connectors) {
  const int first = track.offset, rear = track.connector_offset;
  if (track.joint != JointForm::connector_bodies) {
    const JointRow row{first, first, first + 1};
    const double half = 0.5 * track.pitch;
    return {Pin{row, true, false, half}, Pin{row, false, true, -half}};
  }
  const JointRow front_row{first, first, rear}, rear_row{rear, first + 1, rear};
  const double half = 0.5 * track.connector_length;
  if (connectors) return {Pin{front_row, false, false, -half}, Pin{rear_row, false, false, half}};
  return {Pin{front_row, true, false, track.groove}, Pin{rear_row, true, true, -track.groove}};
}

/// What a body's blocks are taken over: the roots of mass and inertia.
struct InverseInertia {
  double m, j, both;
  explicit InverseInertia(const LinkBodies& body)
      : m(1.0 / body.mass), j(1.0 / body.inertia.y()), both(std::sqrt(m * j)) {}
  [[nodiscard]] PlaneBlock times(const PlaneBlock& b) const {
    return {m * b[k_xx], m * b[k_zz], j * b[k_pitch], m * b[k_xz], both * b[k_x_pitch], both * b[k_z_pitch]};
  }
};

/// 2 / h from a h^2 s2 + 4 h s1 = 4.
Lanes rate_of(const Lanes& a_s2, const Lanes& s1) { return s1 + (s1 * s1 + a_s2).sqrt(); }

Lanes trace(const PlaneBlock& block) { return block[k_xx] + block[k_zz] + block[k_pitch]; }

/// The larger eigenvalue of a side block.
Lanes largest_of_side(const std::array<Lanes, 3>& side) {
  const auto& [across, turning, both] = side;
  const Lanes half = 0.5 * (across - turning);
  return 0.5 * (across + turning) + (half * half + both * both).sqrt();
}

/// 2 / h of eight links.
struct LinkSums {
  PlaneBlock stiffness, damping;
  Lanes s2, s1;          ///< of all motions
  Lanes side_2, side_1;  ///< of motions out of the plane

  LinkSums(const InverseInertia& inertia, const Slopes& k, const Slopes& c, const Lanes& any_2, const Lanes& any_1)
      : stiffness(inertia.times(k.plane)),
        damping(inertia.times(c.plane)),
        s2(any_2),
        s1(any_1),
        side_2(largest_of_side(k.side)),
        side_1(largest_of_side(c.side)) {}

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

/// The shortest stable step, 2 / rate, belongs to the largest rate. `damped`: joints are.
void find_bound(const LinkBodies& bodies, const std::array<Pin, 2>& pins, bool damped, double beta, Workspace& work) {
  const double a = 4.0 * beta - 3.0;
  const InverseInertia inertia(bodies);
  const auto walks = [&](const Field& tangents) {
    return std::array{JointWalk(tangents, pins[0], bodies, work), JointWalk(tangents, pins[1], bodies, work)};
  };
  std::array<JointWalk, 2> springs = walks(work.joint_stiffness), dampers = walks(work.joint_damping);
  double largest = 2.0 / work.largest_stable_step;
  for (int k = 0; k < bodies.count; k += k_lanes) {
    const int i = bodies.offset + k;
    Slopes stiffness(work.plane_stiffness, work.side_stiffness, i);
    for (JointWalk& joints : springs) joints.add(k, stiffness);
    Slopes damping(work.plane_damping, work.side_damping, i);
    if (damped) {
      for (JointWalk& joints : dampers) joints.add(k, damping);
    }
    const LinkSums sums(inertia, stiffness, damping, load(work.stability[0] + i), load(work.stability[1] + i));
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
    for (Field* field :
         {&work.plane_stiffness, &work.plane_damping, &work.side_stiffness, &work.side_damping, &work.stability}) {
      close_seam(track, *field);
    }
    for (const LinkBodies& bodies : track.bodies) {
      const bool connectors = &bodies != &track.bodies.front();
      find_bound(bodies, pins_of(track, connectors), relaxed || has_dampers(track), system.scenario.integrator.beta,
                 work);
    }
    for (const CompiledDiscs& discs : track.discs) bound_wheel(system, discs.body, discs.radius, discs.share, work);
    bound_wheel(system, track.sprocket.body, track.sprocket.pitch_radius, track.sprocket.share, work);
  }
}

}  // namespace grouser
