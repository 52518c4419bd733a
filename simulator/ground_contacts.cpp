#include "simulator/contacts.h"

namespace grouser {
namespace {

/// One point of a link against one body of the ground.
struct GroundPoint {
  const CompiledTrack& track;
  double friction;
  double h;  ///< since the last accepted state [s]
  int row;   ///< in the history's anchor fields
  int link;
};

/// Contact frame C on level ground: W itself.
struct LevelFrame {
  [[nodiscard]] const Vector3d& to_contact(const Vector3d& v_W) const { return v_W; }
  [[nodiscard]] const Vector3d& to_world(const Vector3d& v_C) const { return v_C; }
};

/// Contact frame C with z along the ground's normal.
struct TiltedFrame {
  explicit TiltedFrame(const Vector3d& normal) {
    const Vector3d along = Vector3d(normal.z(), 0.0, -normal.x()).normalized();
    R_WC << along, normal.cross(along), normal;
  }
  [[nodiscard]] Vector3d to_contact(const Vector3d& v_W) const { return R_WC.transpose() * v_W; }
  [[nodiscard]] Vector3d to_world(const Vector3d& v_C) const { return R_WC * v_C; }
  Matrix3d R_WC;
};

/// Tangential force of a bristle: a spring from the anchor that yields at mu N, where the anchor is drawn along, and a
/// damper beside it that gets what the spring leaves of mu N. Nothing is integrated, so a rejected step costs nothing
/// and a parked vehicle does not creep. Turned down: a limit on the sum of both, with the anchor drawn until the spring
/// alone carries it. While N rises the damper then makes the bristle slide where it sticks, the more often the shorter
/// the step: that law has no limit for h -> 0.
struct Bristle {
  double stretch_x, stretch_y;  ///< point less anchor, the spring's
  double force_x, force_y;      ///< on the point
  bool drawn;                   ///< the anchor moved
};

/// Where the bristle's spring was free: its anchor or, for a point that came down since the last accepted state, the
/// place where it touched. Without that a step that overshoots the touch-down takes away the stretch of its overshoot:
/// the spring's error would be of first order.
template <typename Frame>
Vector3d anchor_before(const GroundPoint& g, const Frame& frame, const History& before, const Vector3d& point,
                       const Vector3d& velocity_C, double depth) {
  const int row = g.row, i = g.link;
  if (before.anchored[row][i] != 0.0)
    return {before.anchor_x[row][i], before.anchor_y[row][i], before.anchor_z[row][i]};
  const double closing = -velocity_C.z(), since_touch = closing * g.h > depth ? depth / closing : g.h;
  return point - frame.to_world(since_touch * Vector3d(velocity_C.x(), velocity_C.y(), 0.0));
}

/// x, y: from the old anchor to the point, in C; vx, vy: the point's velocity there.
Bristle bend(const GroundPoint& g, double x, double y, double vx, double vy, double normal) {
  const double k = g.track.bristle_stiffness, c = g.track.bristle_damping, limit = g.friction * normal;
  Bristle b{x, y, 0.0, 0.0, false};
  const double spring = k * std::sqrt(x * x + y * y);
  if (spring > limit) {
    b.stretch_x *= limit / spring;
    b.stretch_y *= limit / spring;
    b.drawn = true;
  }
  b.force_x = -k * b.stretch_x - c * vx;
  b.force_y = -k * b.stretch_y - c * vy;
  const double wanted = std::sqrt(b.force_x * b.force_x + b.force_y * b.force_y);
  if (wanted > limit) {
    b.force_x *= limit / wanted;
    b.force_y *= limit / wanted;
  }
  return b;
}

/// A bristle let go gives up what it had stored.
void release(const GroundPoint& g, const History& before, Workspace& work) {
  if (before.anchored[g.row][g.link] == 0.0) return;
  const double sx = before.stretch_x[g.row][g.link], sy = before.stretch_y[g.row][g.link];
  work.energy.ground_step_loss += 0.5 * g.track.bristle_stiffness * (sx * sx + sy * sy);
}

/// Stiffness and damping of the contact over the link's inertia, for the stable step.
void add_stability(const GroundPoint& g, const Vector3d& point_L, double elastic, Workspace& work) {
  const CompiledTrack& track = g.track;
  const double mobility_t = 1.0 / track.mass + track.ground_depth * track.ground_depth / track.inertia.y();
  const double mobility_n =
      1.0 / track.mass + point_L.x() * point_L.x() / track.inertia.y() + point_L.y() * point_L.y() / track.inertia.x();
  work.stability[0][g.link] += track.ground.stiffness * mobility_n + track.bristle_stiffness * mobility_t;
  work.stability[1][g.link] += elastic * track.ground.rate / track.mass + track.bristle_damping * mobility_t;
}

/// A `point` `depth` [m] below the ground's surface along the normal of `frame`, at `arm` from the link's centre (both
/// W).
template <typename Frame>
void press(const GroundPoint& g, const Frame& frame, double depth, const LinkView& link, const Vector3d& point_L,
           const Vector3d& arm, const Vector3d& point, const History& before, History& after, LinkLoad& load,
           Workspace& work) {
  const CompiledTrack& track = g.track;
  const int row = g.row, i = g.link;
  const Vector3d velocity = frame.to_contact(link.velocity_at(arm));
  const double closing = -velocity.z(), elastic = track.ground.stiffness * depth;
  const double factor = normal_factor(track.ground, closing), normal = elastic * factor;
  const bool held = before.anchored[row][i] != 0.0;
  const Vector3d old_anchor = anchor_before(g, frame, before, point, velocity, depth);
  const Vector3d from_anchor = frame.to_contact(point - old_anchor);
  const Bristle b = bend(g, from_anchor.x(), from_anchor.y(), velocity.x(), velocity.y(), normal);
  const double k = track.bristle_stiffness, sx = b.stretch_x, sy = b.stretch_y;
  const Vector3d anchor = b.drawn ? point - frame.to_world(Vector3d(sx, sy, 0.0)) : old_anchor;
  after.anchor_x[row][i] = anchor.x();
  after.anchor_y[row][i] = anchor.y();
  after.anchor_z[row][i] = anchor.z();
  after.stretch_x[row][i] = sx;
  after.stretch_y[row][i] = sy;
  after.anchored[row][i] = 1.0;
  load.add(arm, frame.to_world(Vector3d(b.force_x, b.force_y, normal)));
  ++work.case_count[static_cast<std::size_t>(ContactCase::ground_point)];
  add_stability(g, point_L, elastic, work);

  work.energy.contact += 0.5 * (elastic * depth + k * (sx * sx + sy * sy));
  work.energy.contact_power += elastic * (factor - 1.0) * closing;
  // The damper's share. Not negative: mu N is a disc, the sum is scaled back to it and the spring lies inside.
  work.energy.ground_power -= (b.force_x + k * sx) * velocity.x() + (b.force_y + k * sy) * velocity.y();
  if (!b.drawn) return;
  // Mean spring force over the step times the way of the anchor: with the stored energy's change this is the work,
  // exactly.
  const Vector3d way = frame.to_contact(anchor - old_anchor);
  const double old_sx = held ? before.stretch_x[row][i] : 0.0;
  const double old_sy = held ? before.stretch_y[row][i] : 0.0;
  work.energy.ground_step_loss += 0.5 * k * ((sx + old_sx) * way.x() + (sy + old_sy) * way.y());
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

void touch_level(const GroundPoint& g, const LinkView& link, const Vector3d& point_L, const History& before,
                 History& after, LinkLoad& load, Workspace& work) {
  const Vector3d arm = link.rotation * point_L, point = link.position + arm;
  if (point.z() >= 0.0) return release(g, before, work);
  press(g, LevelFrame{}, -point.z(), link, point_L, arm, point, before, after, load, work);
}

void touch_uneven(const GroundSurface& ground, const GroundPoint& g, const LinkView& link, const Vector3d& point_L,
                  const History& before, History& after, LinkLoad& load, Workspace& work) {
  const Vector3d arm = link.rotation * point_L, point = link.position + arm;
  const auto meet = [&](const Touch& touch, const GroundPoint& own) {
    if (touch.depth <= 0.0) return release(own, before, work);
    press(own, TiltedFrame(touch.normal), touch.depth, link, point_L, arm, point, before, after, load, work);
  };
  meet(touch_surface(ground, point), g);
  if (ground.half_rounds().empty()) return;
  GroundPoint on_round = g;
  on_round.row += static_cast<int>(g.track.ground_points.size());
  meet(touch_half_rounds(ground, point), on_round);
}

}  // namespace

void ground_contacts(const System& system, const History& before, double h, State& state, Workspace& work) {
  const GroundSurface& ground = system.ground;
  state.history.anchored.fill(0.0);
  for (const CompiledTrack& track : system.tracks) {
    const double near = std::hypot(track.ground_depth, 0.5 * track.pitch) + 0.02;
    for (int first = 0; first < track.num_links; ++first) {
      const int i = track.offset + first;
      const double reach = near + track.half_width * std::abs(work.rotation[7][i]);
      const double highest = ground.level() ? 0.0 : ground.highest_near(state.position[0][i], state.position[1][i]);
      if (state.position[2][i] > highest + reach) continue;
      const LinkView link = view_link(state, work, i);
      const double friction = ground.friction(link.position.x(), link.position.y());
      LinkLoad load;
      for (std::size_t p = 0; p < track.ground_points.size(); ++p) {
        const Vector3d& point_L = track.ground_points[p];
        const GroundPoint point{track, friction, h, static_cast<int>(p), i};
        if (ground.level()) {
          touch_level(point, link, point_L, before, state.history, load, work);
        } else {
          touch_uneven(ground, point, link, point_L, before, state.history, load, work);
        }
      }
      push_link(work, i, load, Partner::ground);
    }
  }
}

}  // namespace grouser
