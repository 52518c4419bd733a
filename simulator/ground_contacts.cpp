#include "simulator/contacts.h"

namespace grouser {
namespace {

/// What the ground puts on eight links in a row over all their points, kept in registers until they are done.
struct BlockLoad {
  LinkLoads on_links = LinkLoads::none();  ///< W
  LinkLoads lost = LinkLoads::none();      ///< part of it that damps across the ground
  Lanes stiffness = 0.0, damping = 0.0;    ///< towards the step's bound
  Lanes energy = 0.0, contact_power = 0.0, ground_power = 0.0, step_loss = 0.0;
  unsigned touches = 0;  ///< points that touch
};

/// What the contacts of one track leave to be summed over lanes at its end.
struct Sums {
  Lanes energy = 0.0, contact_power = 0.0, ground_power = 0.0, step_loss = 0.0;
};

/// What forces at a point of a link move it by.
struct PointMobility {
  double moving, pitching, rolling, tangential;
  explicit PointMobility(const CompiledTrack& track)
      : moving(1.0 / track.mass),
        pitching(1.0 / track.inertia.y()),
        rolling(1.0 / track.inertia.x()),
        tangential(moving + track.ground_depth * track.ground_depth * pitching) {}
  [[nodiscard]] double along_normal(const Vector3d& place_L) const {
    return moving + place_L.x() * place_L.x() * pitching + place_L.y() * place_L.y() * rolling;
  }
};

/// What one point's bristles on eight links in a row remember: a place in the history's anchor fields, which are alike.
class BristleRow {
 public:
  BristleRow(const History& before, History& after, int row, int first)
      : before_(before), after_(after), at_(before.anchored[row] + first - before.anchored[0]) {}
  [[nodiscard]] Lanes old(Field History::*field) const { return load((before_.*field)[0] + at_); }
  void keep(Field History::*field, const Lanes& value) const { store((after_.*field)[0] + at_, value); }

 private:
  const History& before_;
  History& after_;
  std::ptrdiff_t at_;
};

/// Which bristles touch now, which the history is told, and which were held at the last accepted state.
struct Grip {
  LaneMask touching, held;
  /// depth: 0 where there is none.
  Grip(const BristleRow& row, const Lanes& depth) : touching(0.0 < depth), held(0.5 < row.old(&History::anchored)) {
    row.keep(&History::anchored, choose(touching, 1.0, 0.0));
  }
  [[nodiscard]] bool any() const { return bits_of(touching | held) != 0; }
};

/// One point of eight links in a row against one body of the ground.
struct GroundPoint {
  const CompiledTrack& track;
  double h;  ///< since the last accepted state [s]
  Lanes friction;
  double mobility_n, mobility_t;  ///< what a force along the normal and across it moves the point by [1/kg]
  Lanes3 arm, point;              ///< from the link's centre and from the origin, W
  Lanes3 velocity;                ///< W
  bool slopes;                    ///< wanted, for the step's bound
};

/// Contact frame C on level ground: W itself.
struct LevelFrame {
  /// Adds a force along the normal.
  static void add_normal(const Lanes3& arm, const Lanes& force, LinkLoads& load) {
    load.force.z += force;
    load.torque.x += arm.y * force;
    load.torque.y -= arm.x * force;
  }
  [[nodiscard]] const Lanes3& to_contact(const Lanes3& v_W) const { return v_W; }
  [[nodiscard]] const Lanes3& to_world(const Lanes3& v_C) const { return v_C; }
};

/// Contact frame C with z along the ground's normal.
struct TiltedFrame {
  explicit TiltedFrame(const Lanes3& normal) : z(normal) {
    const Lanes scale = (normal.z * normal.z + normal.x * normal.x).sqrt().inverse();
    x = {scale * normal.z, 0.0, -scale * normal.x};
    y = cross(z, x);
  }
  void add_normal(const Lanes3& arm, const Lanes& force, LinkLoads& load) const { load.add(arm, force * z); }
  [[nodiscard]] Lanes3 to_contact(const Lanes3& v_W) const { return {dot(x, v_W), dot(y, v_W), dot(z, v_W)}; }
  [[nodiscard]] Lanes3 to_world(const Lanes3& v_C) const { return v_C.x * x + v_C.y * y + v_C.z * z; }
  Lanes3 x, y, z;  ///< axes of C in W
};

/// Where the bristles of points were free that came down since the last accepted state: the places where they touched.
/// Without that a step that overshoots the touch-down takes away the stretch of its overshoot: the spring's error would
/// be of first order.
template <typename Frame>
Lanes3 place_of_touch(const GroundPoint& g, const Frame& frame, const Lanes3& velocity_C, const Lanes& depth) {
  const Lanes closing = -velocity_C.z;
  const Lanes since_touch = choose(depth < closing * g.h, depth / closing, g.h);
  return g.point - frame.to_world(Lanes3{since_touch * velocity_C.x, since_touch * velocity_C.y, 0.0});
}

/// Tangential force of a bristle: a spring from the anchor that yields at mu N, where the anchor is drawn along, and a
/// damper beside it that gets what the spring leaves of mu N. Nothing is integrated, so a rejected step costs nothing
/// and a parked vehicle does not creep. Turned down: a limit on the sum of both, with the anchor drawn until the spring
/// alone carries it. While N rises the damper then makes the bristle slide where it sticks, the more often the shorter
/// the step: that law has no limit for h -> 0.
struct Bristle {
  Lanes stretch_x, stretch_y;  ///< point less anchor, the spring's
  Lanes force_x, force_y;      ///< on the point
  LaneMask drawn;              ///< the anchor moved
};

/// x, y: from the old anchor to the point, in C; v: the point's velocity there; limit: mu N. Most bristles stick: roots
/// and quotients are for blocks where one that touches does not.
[[gnu::always_inline]] inline Bristle bend(const CompiledTrack& track, const LaneMask& touching, const Lanes& x,
                                           const Lanes& y, const Lanes3& v, const Lanes& limit) {
  const double k = track.bristle_stiffness, c = track.bristle_damping;
  const Lanes limit2 = limit * limit, spring2 = (k * k) * (x * x + y * y);
  Bristle b{x, y, 0.0, 0.0, touching & (limit2 < spring2)};
  if (bits_of(b.drawn) != 0) {
    const Lanes left = choose(b.drawn, limit / spring2.max(k_least_force).sqrt(), 1.0);
    b.stretch_x *= left, b.stretch_y *= left;
  }
  b.force_x = -k * b.stretch_x - c * v.x;
  b.force_y = -k * b.stretch_y - c * v.y;
  const Lanes wanted2 = b.force_x * b.force_x + b.force_y * b.force_y;
  if (const LaneMask too_much = touching & (limit2 < wanted2); bits_of(too_much) != 0) {
    const Lanes granted = choose(too_much, limit / wanted2.max(k_least_force).sqrt(), 1.0);
    b.force_x *= granted, b.force_y *= granted;
  }
  return b;
}

/// Points `depth` [m] below the ground's surface along the normal of `frame`, 0 where they are not.
template <typename Frame>
void press(const GroundPoint& g, const Frame& frame, const Lanes& depth, const Grip& grip, const BristleRow& row,
           BlockLoad& sum) {
  const CompiledTrack& track = g.track;
  const auto& [touching, held] = grip;
  const double k = track.bristle_stiffness;
  const Lanes old_sx = choose(held, row.old(&History::stretch_x), 0.0);
  const Lanes old_sy = choose(held, row.old(&History::stretch_y), 0.0);
  // A bristle let go gives up what it had stored.
  sum.step_loss += choose(touching, 0.0, 0.5 * k * (old_sx * old_sx + old_sy * old_sy));
  if (bits_of(touching) == 0) return;

  const Lanes3 velocity = frame.to_contact(g.velocity);
  const Lanes closing = -velocity.z, elastic = track.ground.stiffness * depth;
  const Lanes factor = normal_factor(track.ground, closing), normal = elastic * factor;
  Lanes3 old_anchor{row.old(&History::anchor_x), row.old(&History::anchor_y), row.old(&History::anchor_z)};
  if (bits_of(touching & !held) != 0) {
    old_anchor = choose(held, old_anchor, place_of_touch(g, frame, velocity, depth));
  }
  const Lanes3 from_anchor = frame.to_contact(g.point - old_anchor);
  const Bristle b = bend(track, touching, from_anchor.x, from_anchor.y, velocity, g.friction * normal);
  const Lanes sx = b.stretch_x, sy = b.stretch_y;
  Lanes3 anchor = old_anchor;
  if (bits_of(b.drawn) != 0) {
    anchor = choose(b.drawn, g.point - frame.to_world(Lanes3{sx, sy, 0.0}), old_anchor);
    // Mean spring force over the step times the way of the anchor: with the stored energy's change this is the work,
    // exactly.
    const Lanes3 way = frame.to_contact(anchor - old_anchor);
    sum.step_loss += choose(b.drawn, 0.5 * k * ((sx + old_sx) * way.x + (sy + old_sy) * way.y), 0.0);
  }
  row.keep(&History::anchor_x, anchor.x);
  row.keep(&History::anchor_y, anchor.y);
  row.keep(&History::anchor_z, anchor.z);
  row.keep(&History::stretch_x, sx);
  row.keep(&History::stretch_y, sy);

  const Lanes fx = choose(touching, b.force_x, 0.0), fy = choose(touching, b.force_y, 0.0);
  const Lanes spring_x = choose(touching, k * sx, 0.0), spring_y = choose(touching, k * sy, 0.0);
  sum.on_links.add(g.arm, frame.to_world(Lanes3{fx, fy, normal}));
  frame.add_normal(g.arm, normal - elastic, sum.lost);
  if (g.slopes) {
    sum.stiffness += choose(touching, track.ground.stiffness * g.mobility_n + k * g.mobility_t, 0.0);
    sum.damping +=
        (track.ground.rate / track.mass) * elastic + choose(touching, track.bristle_damping * g.mobility_t, 0.0);
  }
  sum.energy += 0.5 * (elastic * depth + spring_x * sx + spring_y * sy);
  sum.contact_power += elastic * (factor - 1.0) * closing;
  // The damper's share. Not negative: mu N is a disc, the sum is scaled back to it and the spring lies inside.
  sum.ground_power -= (fx + spring_x) * velocity.x + (fy + spring_y) * velocity.y;
  sum.touches += static_cast<unsigned>(std::popcount(bits_of(touching)));
}

/// Depth of a point below a surface and the surface's normal; no contact where depth <= 0.
struct Touch {
  double depth = 0.0;
  Vector3d normal = Vector3d::UnitZ();
};

/// Distance to the nearest place of a C1 height field. The foot of the normal is found by u <- x + depth n(u), which
/// contracts by depth times curvature (some 1e-2): depth is then the true distance, its gradient the normal, and the
/// elastic force that of an energy.
Touch touch_surface(const GroundSurface& ground, const Vector3d& point) {
  constexpr int k_refinements = 2;
  Touch touch;
  double x = point.x(), y = point.y();
  for (int i = 0;; ++i) {
    const GroundHeight at = ground.at(x, y);
    if (i == 0 && point.z() >= at.z) return touch;
    touch.normal = Vector3d(-at.slope_x, -at.slope_y, 1.0).normalized();
    touch.depth = touch.normal.dot(Vector3d(x, y, at.z) - point);
    if (i == k_refinements) return touch;
    x = point.x() + touch.depth * touch.normal.x();
    y = point.y() + touch.depth * touch.normal.y();
  }
}

/// The deepest of the half rounds.
Touch touch_half_rounds(const GroundSurface& ground, const Vector3d& point) {
  Touch deepest;
  for (const GroundSurface::HalfRound& round : ground.half_rounds()) {
    if (std::abs(point.x() - round.x) >= round.radius || !covers(round.side, side_of(point.y()))) continue;
    const Vector3d axis = Vector3d(0.0, 1.0, round.slope_y).normalized();
    Vector3d from_axis = point - Vector3d(round.x, 0.0, round.z);
    from_axis -= axis.dot(from_axis) * axis;
    const double distance = from_axis.norm();
    if (round.radius - distance > deepest.depth) deepest = {round.radius - distance, from_axis / distance};
  }
  return deepest;
}

/// Finds the touch of every lane that is near.
template <typename Find>
void press_uneven(const GroundPoint& g, const LaneMask& near, Find find, const BristleRow& row, BlockLoad& sum) {
  Lanes depth = 0.0;
  Lanes3 normal = in_all_lanes(Vector3d::UnitZ());
  for (unsigned left = bits_of(near); left != 0; left &= left - 1) {
    const int lane = std::countr_zero(left);
    const Touch touch = find(Vector3d(g.point.x[lane], g.point.y[lane], g.point.z[lane]));
    if (touch.depth <= 0.0) continue;
    depth.set(lane, touch.depth);
    normal.x.set(lane, touch.normal.x());
    normal.y.set(lane, touch.normal.y());
    normal.z.set(lane, touch.normal.z());
  }
  if (const Grip grip(row, depth); grip.any()) press(g, TiltedFrame(normal), depth, grip, row, sum);
}

/// Links so low that they may touch.
LaneMask links_near(const GroundSurface& ground, const CompiledTrack& track, int first, const State& state,
                    const Workspace& work) {
  const double half = 0.5 * track.pitch;
  const double near = std::sqrt(track.ground_depth * track.ground_depth + half * half) + 0.02;
  Lanes highest = 0.0;
  for (int lane = 0; lane < k_lanes && !ground.level(); ++lane) {
    highest.set(lane, ground.highest_near(state.position[0][first + lane], state.position[1][first + lane]));
  }
  const Lanes reach = near + track.half_width * load(work.rotation[7] + first).abs();
  return (load(state.position[2] + first) <= highest + reach) & LaneMask::first(track.offset + track.num_links - first);
}

void book(const BlockLoad& sum, int first, Sums& sums, Workspace& work) {
  sums.energy += sum.energy;
  sums.contact_power += sum.contact_power;
  sums.ground_power += sum.ground_power;
  sums.step_loss += sum.step_loss;
  if (sum.touches == 0) return;
  push_links(work, first, sum.on_links, Partner::ground);
  note_losses(work, first, sum.lost);
  if (work.bounds_step) {
    add_to(work.stability[0] + first, sum.stiffness);
    add_to(work.stability[1] + first, sum.damping);
  }
  work.case_count[static_cast<std::size_t>(ContactCase::ground_point)] += sum.touches;
}

/// Of the places of one point on eight links: the edge of a zone may lie under a link.
Lanes friction_at(const GroundSurface& ground, const Lanes3& place) {
  if (ground.even_friction()) return ground.friction(0.0, 0.0);
  Lanes friction;
  for (int lane = 0; lane < k_lanes; ++lane) friction.set(lane, ground.friction(place.x[lane], place.y[lane]));
  return friction;
}

/// Frees the bristles of eight links in a row. What is not near may have held one that slips out of reach in a step.
void let_go(int first, History& after) {
  for (int row = 0; row < after.anchored.components(); ++row) store(after.anchored[row] + first, 0.0);
}

/// Eight links in a row on all their points.
void meet_ground(const GroundSurface& ground, const CompiledTrack& track, int first, double h, const History& before,
                 State& state, Sums& sums, Workspace& work) {
  const LaneMask near = links_near(ground, track, first, state, work);
  if (bits_of(near) == 0) return let_go(first, state.history);
  const Lanes3 position = load3(state.position, first), velocity = load3(state.velocity, first);
  const Lanes3 turn = load3(work.angular_velocity_W, first);
  const Lanes3 x = load_axis(work, 0, first), y = load_axis(work, 1, first), z = load_axis(work, 2, first);
  const int num_points = static_cast<int>(track.ground_points.size());
  const PointMobility mobility(track);
  BlockLoad sum;
  for (int p = 0; p < num_points; ++p) {
    const Vector3d& place_L = track.ground_points[static_cast<std::size_t>(p)];
    const auto point = [&] {
      const Lanes3 arm = place_L.x() * x + place_L.y() * y + place_L.z() * z, at = position + arm;
      return GroundPoint{track,
                         h,
                         friction_at(ground, at),
                         mobility.along_normal(place_L),
                         mobility.tangential,
                         arm,
                         at,
                         velocity + cross(turn, arm),
                         work.bounds_step};
    };
    const BristleRow row(before, state.history, p, first);
    if (ground.level()) {  // few points touch: the rest of a point is for those
      const Lanes height = position.z + (place_L.x() * x.z + place_L.y() * y.z + place_L.z() * z.z);
      const Lanes depth = choose(near, -height, 0.0).max(0.0);
      if (const Grip grip(row, depth); grip.any()) press(point(), LevelFrame{}, depth, grip, row, sum);
      continue;
    }
    const GroundPoint g = point();
    const auto on_surface = [&](const Vector3d& there) { return touch_surface(ground, there); };
    press_uneven(g, near, on_surface, row, sum);
    if (ground.half_rounds().empty()) continue;
    const auto on_half_rounds = [&](const Vector3d& there) { return touch_half_rounds(ground, there); };
    press_uneven(g, near, on_half_rounds, BristleRow(before, state.history, num_points + p, first), sum);
  }
  book(sum, first, sums, work);
}

}  // namespace

void ground_contacts(const System& system, const History& before, double h, State& state, Workspace& work) {
  for (const CompiledTrack& track : system.tracks) {
    Sums sums;
    for (int first = 0; first < track.num_links; first += k_lanes) {
      meet_ground(system.ground, track, track.offset + first, h, before, state, sums, work);
    }
    work.energy.contact += sums.energy.sum();
    work.energy.contact_power += sums.contact_power.sum();
    work.energy.ground_power += sums.ground_power.sum();
    work.energy.ground_step_loss += sums.step_loss.sum();
  }
}

}  // namespace grouser
