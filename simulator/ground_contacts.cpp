#include "simulator/contacts.h"

namespace grouser {
namespace {

/// One point of eight links in a row against one body of the ground.
struct GroundPoint {
  const CompiledTrack& track;
  double h;   ///< since the last accepted state [s]
  int row;    ///< in the history's anchor fields
  int first;  ///< link array index of lane 0
  Lanes friction;
  Vector3d place_L;   ///< in the link frame
  Lanes3 arm, point;  ///< from the link's centre and from the origin, W
  Lanes3 velocity;    ///< W
};

/// What the contacts of one track leave to be summed over lanes at its end.
struct Sums {
  Lanes energy = 0.0, contact_power = 0.0, ground_power = 0.0;
  Lanes step_loss = 0.0;
};

/// Contact frame C on level ground: W itself.
struct LevelFrame {
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
  [[nodiscard]] Lanes3 to_contact(const Lanes3& v_W) const { return {dot(x, v_W), dot(y, v_W), dot(z, v_W)}; }
  [[nodiscard]] Lanes3 to_world(const Lanes3& v_C) const { return v_C.x * x + v_C.y * y + v_C.z * z; }
  Lanes3 x, y, z;  ///< axes of C in W
};

/// Where the bristles' springs were free: their anchors or, for points that came down since the last accepted state,
/// the places where they touched. Without that a step that overshoots the touch-down takes away the stretch of its
/// overshoot: the spring's error would be of first order.
template <typename Frame>
Lanes3 anchor_before(const GroundPoint& g, const Frame& frame, const History& before, const LaneMask& held,
                     const Lanes3& velocity_C, const Lanes& depth) {
  const Lanes closing = -velocity_C.z;
  const Lanes since_touch = choose(depth < closing * g.h, depth / closing, g.h);
  const Lanes3 way = frame.to_world(Lanes3{since_touch * velocity_C.x, since_touch * velocity_C.y, 0.0});
  const Lanes3 anchor{load(before.anchor_x[g.row] + g.first), load(before.anchor_y[g.row] + g.first),
                      load(before.anchor_z[g.row] + g.first)};
  return choose(held, anchor, g.point - way);
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

/// x, y: from the old anchor to the point, in C; v: the point's velocity there; limit: mu N.
Bristle bend(const CompiledTrack& track, const Lanes& x, const Lanes& y, const Lanes3& v, const Lanes& limit) {
  const double k = track.bristle_stiffness, c = track.bristle_damping;
  const Lanes spring = k * (x * x + y * y).sqrt();
  const LaneMask drawn = limit < spring;
  const Lanes left = choose(drawn, limit / spring, 1.0);
  const Lanes sx = left * x, sy = left * y, fx = -k * sx - c * v.x, fy = -k * sy - c * v.y;
  const Lanes wanted = (fx * fx + fy * fy).sqrt();
  const Lanes granted = choose(limit < wanted, limit / wanted, 1.0);
  return {sx, sy, granted * fx, granted * fy, drawn};
}

/// Stiffness and damping of the contact over the link's inertia, for the stable step.
void add_stability(const GroundPoint& g, const LaneMask& touching, const Lanes& elastic, Workspace& work) {
  const CompiledTrack& track = g.track;
  const double pitching = 1.0 / track.inertia.y(), rolling = 1.0 / track.inertia.x();
  const double mobility_t = 1.0 / track.mass + track.ground_depth * track.ground_depth * pitching;
  const double mobility_n =
      1.0 / track.mass + g.place_L.x() * g.place_L.x() * pitching + g.place_L.y() * g.place_L.y() * rolling;
  const double stiffness = track.ground.stiffness * mobility_n + track.bristle_stiffness * mobility_t;
  const Lanes zero = 0.0;
  add_to(work.stability[0] + g.first, choose(touching, stiffness, zero));
  add_to(work.stability[1] + g.first,
         (track.ground.rate / track.mass) * elastic + choose(touching, track.bristle_damping * mobility_t, zero));
}

/// Points `depth` [m] below the ground's surface along the normal of `frame`, 0 where they are not.
template <typename Frame>
void press(const GroundPoint& g, const Frame& frame, const Lanes& depth, const History& before, History& after,
           LinkLoads& load_W, Sums& sums, Workspace& work) {
  const CompiledTrack& track = g.track;
  const Lanes zero = 0.0, half = 0.5;
  const LaneMask touching = zero < depth, held = half < load(before.anchored[g.row] + g.first);
  const double k = track.bristle_stiffness;
  store(after.anchored[g.row] + g.first, choose(touching, 1.0, zero));
  if (bits_of(touching | held) == 0) return;
  const Lanes old_sx = choose(held, load(before.stretch_x[g.row] + g.first), zero);
  const Lanes old_sy = choose(held, load(before.stretch_y[g.row] + g.first), zero);
  // A bristle let go gives up what it had stored.
  const Lanes let_go = choose(touching, zero, 0.5 * k * (old_sx * old_sx + old_sy * old_sy));

  const Lanes3 velocity = frame.to_contact(g.velocity);
  const Lanes closing = -velocity.z, elastic = track.ground.stiffness * depth;
  const Lanes factor = normal_factor(track.ground, closing), normal = elastic * factor;
  const Lanes3 old_anchor = anchor_before(g, frame, before, held, velocity, depth);
  const Lanes3 from_anchor = frame.to_contact(g.point - old_anchor);
  const Bristle b = bend(track, from_anchor.x, from_anchor.y, velocity, g.friction * normal);
  const Lanes sx = b.stretch_x, sy = b.stretch_y;
  const Lanes3 drawn_to = g.point - frame.to_world(Lanes3{sx, sy, zero});
  const Lanes3 anchor = choose(b.drawn, drawn_to, old_anchor);
  store(after.anchor_x[g.row] + g.first, anchor.x);
  store(after.anchor_y[g.row] + g.first, anchor.y);
  store(after.anchor_z[g.row] + g.first, anchor.z);
  store(after.stretch_x[g.row] + g.first, sx);
  store(after.stretch_y[g.row] + g.first, sy);
  load_W.add(g.arm, frame.to_world(Lanes3{b.force_x, b.force_y, normal}));
  count_case(work, ContactCase::ground_point, bits_of(touching));
  add_stability(g, touching, elastic, work);

  sums.energy += 0.5 * (elastic * depth + choose(touching, k * (sx * sx + sy * sy), zero));
  sums.contact_power += elastic * (factor - 1.0) * closing;
  // The damper's share. Not negative: mu N is a disc, the sum is scaled back to it and the spring lies inside.
  sums.ground_power -= choose(touching, (b.force_x + k * sx) * velocity.x + (b.force_y + k * sy) * velocity.y, zero);
  // Mean spring force over the step times the way of the anchor: with the stored energy's change this is the work,
  // exactly.
  const Lanes3 way = frame.to_contact(anchor - old_anchor);
  const Lanes drawing = 0.5 * k * ((sx + old_sx) * way.x + (sy + old_sy) * way.y);
  sums.step_loss += let_go + choose(touching & b.drawn, drawing, zero);
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
void press_uneven(const GroundPoint& g, const LaneMask& near, Find find, const History& before, History& after,
                  LinkLoads& load_W, Sums& sums, Workspace& work) {
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
  press(g, TiltedFrame(normal), depth, before, after, load_W, sums, work);
}

/// Links so low that they may touch.
LaneMask links_near(const GroundSurface& ground, const CompiledTrack& track, int first, const State& state,
                    const Workspace& work) {
  const double near = std::hypot(track.ground_depth, 0.5 * track.pitch) + 0.02;
  Lanes highest = 0.0;
  for (int lane = 0; lane < k_lanes && !ground.level(); ++lane) {
    highest.set(lane, ground.highest_near(state.position[0][first + lane], state.position[1][first + lane]));
  }
  const Lanes reach = near + track.half_width * load(work.rotation[7] + first).abs();
  return (load(state.position[2] + first) <= highest + reach) & LaneMask::first(track.offset + track.num_links - first);
}

/// Of the places of one point on eight links: the edge of a zone may lie under a link.
Lanes friction_at(const GroundSurface& ground, const Lanes3& place) {
  Lanes friction;
  for (int lane = 0; lane < k_lanes; ++lane) friction.set(lane, ground.friction(place.x[lane], place.y[lane]));
  return friction;
}

/// Eight links in a row on all their points.
void meet_ground(const GroundSurface& ground, const CompiledTrack& track, int first, double h, const History& before,
                 State& state, Sums& sums, Workspace& work) {
  const LaneMask near = links_near(ground, track, first, state, work);
  if (bits_of(near) == 0) return;
  const Lanes3 position = load3(state.position, first), velocity = load3(state.velocity, first);
  const Lanes3 turn = load3(work.angular_velocity_W, first);
  const int num_points = static_cast<int>(track.ground_points.size());
  LinkLoads load_W;
  for (int p = 0; p < num_points; ++p) {
    const Vector3d& place_L = track.ground_points[static_cast<std::size_t>(p)];
    const Lanes3 arm = to_world(work, first, in_all_lanes(place_L));
    const Lanes3 at = position + arm;
    GroundPoint point{track, h, p, first, friction_at(ground, at), place_L, arm, at, velocity + cross(turn, arm)};
    if (ground.level()) {
      const Lanes depth = choose(near, -point.point.z, 0.0).max(0.0);
      press(point, LevelFrame{}, depth, before, state.history, load_W, sums, work);
      continue;
    }
    const auto on_surface = [&](const Vector3d& place) { return touch_surface(ground, place); };
    press_uneven(point, near, on_surface, before, state.history, load_W, sums, work);
    if (ground.half_rounds().empty()) continue;
    point.row += num_points;
    const auto on_half_rounds = [&](const Vector3d& place) { return touch_half_rounds(ground, place); };
    press_uneven(point, near, on_half_rounds, before, state.history, load_W, sums, work);
  }
  push_links(work, first, load_W, Partner::ground);
}

}  // namespace

void ground_contacts(const System& system, const History& before, double h, State& state, Workspace& work) {
  state.history.anchored.fill(0.0);
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
