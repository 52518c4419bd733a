#include "simulator/contacts.h"

namespace grouser {
namespace {

struct GroundPoint {
  const CompiledTrack& track;
  double friction;
  int row;  ///< in the history's anchor fields
  int link;
};

/// Tangential force of a bristle: a spring from the anchor and a damper; where that exceeds mu N the anchor is drawn
/// along so that the spring alone carries mu N. Nothing is integrated, so a rejected step costs nothing and a parked
/// vehicle does not creep.
struct Bristle {
  double force_x, force_y;
  double anchor_x, anchor_y;
  bool sliding;
};

Bristle stretch(const GroundPoint& g, double x, double y, double vx, double vy, double ax, double ay, double normal) {
  const double k = g.track.bristle_stiffness, c = g.track.bristle_damping;
  Bristle bristle{-k * (x - ax) - c * vx, -k * (y - ay) - c * vy, ax, ay, false};
  const double wanted = std::sqrt(bristle.force_x * bristle.force_x + bristle.force_y * bristle.force_y),
               limit = g.friction * normal;
  if (wanted > limit) {
    const double ratio = limit / wanted;
    bristle.force_x *= ratio;
    bristle.force_y *= ratio;
    bristle.anchor_x = x + bristle.force_x / k;
    bristle.anchor_y = y + bristle.force_y / k;
    bristle.sliding = true;
  }
  return bristle;
}

/// A bristle let go gives up what it had stored.
void release(const GroundPoint& g, const History& before, Workspace& work) {
  if (before.anchored[g.row][g.link] == 0.0) return;
  const double sx = before.stretch_x[g.row][g.link], sy = before.stretch_y[g.row][g.link];
  work.energy.ground_step_loss += 0.5 * g.track.bristle_stiffness * (sx * sx + sy * sy);
}

void touch_ground(const GroundPoint& g, const LinkView& link, const Vector3d& point_L, const History& before,
                  History& after, LinkLoad& load, Workspace& work) {
  const CompiledTrack& track = g.track;
  const Vector3d arm = link.rotation * point_L, point = link.position + arm;
  const int row = g.row, i = g.link;
  if (point.z() >= 0.0) {
    release(g, before, work);
    return;
  }
  const Vector3d velocity = link.velocity_at(arm);
  const double depth = -point.z(), closing = -velocity.z(), elastic = track.ground.stiffness * depth;
  const double factor = normal_factor(track.ground, closing), normal = elastic * factor;
  const bool held = before.anchored[row][i] != 0.0;
  const double ax = held ? before.anchor_x[row][i] : point.x(), ay = held ? before.anchor_y[row][i] : point.y();
  const Bristle b = stretch(g, point.x(), point.y(), velocity.x(), velocity.y(), ax, ay, normal);
  after.anchor_x[row][i] = b.anchor_x;
  after.anchor_y[row][i] = b.anchor_y;
  after.stretch_x[row][i] = point.x() - b.anchor_x;
  after.stretch_y[row][i] = point.y() - b.anchor_y;
  after.anchored[row][i] = 1.0;
  load.add(arm, Vector3d(b.force_x, b.force_y, normal));
  ++work.case_count[static_cast<std::size_t>(ContactCase::ground_point)];

  const double k = track.bristle_stiffness, c = track.bristle_damping;
  const double mobility_t = 1.0 / track.mass + track.ground_depth * track.ground_depth / track.inertia.y();
  const double mobility_n =
      1.0 / track.mass + point_L.x() * point_L.x() / track.inertia.y() + point_L.y() * point_L.y() / track.inertia.x();
  work.stability[0][i] += track.ground.stiffness * mobility_n + k * mobility_t;
  work.stability[1][i] += elastic * track.ground.rate / track.mass + c * mobility_t;

  const double sx = after.stretch_x[row][i], sy = after.stretch_y[row][i];
  work.energy.contact += 0.5 * (elastic * depth + k * (sx * sx + sy * sy));
  work.energy.contact_power += elastic * (factor - 1.0) * closing;
  if (b.sliding) {
    // Mean spring force over the step times the way of the anchor: with the stored energy's change this is the work,
    // exactly.
    const double old_sx = held ? before.stretch_x[row][i] : 0.0;
    const double old_sy = held ? before.stretch_y[row][i] : 0.0;
    work.energy.ground_step_loss += 0.5 * k * ((sx + old_sx) * (b.anchor_x - ax) + (sy + old_sy) * (b.anchor_y - ay));
  } else {
    work.energy.ground_power += c * (velocity.x() * velocity.x() + velocity.y() * velocity.y());
  }
}

}  // namespace

void ground_contacts(const System& system, const History& before, State& state, Workspace& work) {
  state.history.anchored.fill(0.0);
  for (const CompiledTrack& track : system.tracks) {
    const double near = std::hypot(track.ground_depth, 0.5 * track.pitch) + 0.02;
    for (int first = 0; first < track.num_links; ++first) {
      const int i = track.offset + first;
      if (state.position[2][i] > near + track.half_width * std::abs(work.rotation[7][i])) continue;
      const LinkView link = view_link(state, work, i);
      LinkLoad load;
      for (std::size_t p = 0; p < track.ground_points.size(); ++p) {
        touch_ground({track, system.ground_friction, static_cast<int>(p), i}, link, track.ground_points[p], before,
                     state.history, load, work);
      }
      push_link(work, i, load, Partner::ground);
    }
  }
}

}  // namespace grouser
