#include "simulator/links.h"

#include <cmath>

namespace grouser {
namespace {

/// What a unit force or moment at a joint, `arm` from the centre, accelerates; the two joints of a body move against
/// each other in the worst mode, hence the factor 2 on each (P 3).
struct Mobility {
  double tx, ty, tz, rx, ry, rz;
  Mobility(double mass, const Vector3d& inertia, double arm)
      : tx(2.0 / mass),
        ty(2.0 * (1.0 / mass + arm * arm / inertia.z())),
        tz(2.0 * (1.0 / mass + arm * arm / inertia.y())),
        rx(2.0 / inertia.x()),
        ry(2.0 / inertia.y()),
        rz(2.0 / inertia.z()) {}
  /// Eight joints from j on.
  [[nodiscard]] Lanes of(const Field& k, int j) const {
    const auto at = [&](int axis) { return load(k[axis] + j); };
    return (tx * at(0)).max(tz * at(2) + ry * at(4)).max(ty * at(1) + rz * at(5)).max(rx * at(3));
  }
};

/// What eight joints put into the sums of the bodies from `first` on; lanes behind the last joint are padding.
void add_joints(const Mobility& body, const Workspace& work, int joint, int valid, int first, Field& stability) {
  const LaneMask joints = LaneMask::first(valid);
  add_to(stability[0] + first, choose(joints, body.of(work.joint_stiffness, joint), 0.0));
  add_to(stability[1] + first, choose(joints, body.of(work.joint_damping, joint), 0.0));
}

/// The link ahead of the last joint is the first one: what was put on its copy behind the last link is its own.
void close_seam(const CompiledTrack& track, Field& stability) {
  for (const int sum : {0, 1}) stability[sum][track.offset] += stability[sum][track.offset + track.num_links];
}

/// Sums that the joints on both sides put into a link's stability bound: S2 over stiffness, S1 over damping.
void add_joint_stability(const CompiledTrack& track, Workspace& work) {
  const Mobility link(track.mass, track.inertia, 0.5 * track.pitch);
  for (int k = 0; k < track.num_links; k += k_lanes) {
    const int i = track.offset + k;
    add_joints(link, work, i, track.num_links - k, i, work.stability);
    add_joints(link, work, i, track.num_links - k, i + 1, work.stability);
  }
  close_seam(track, work.stability);
}

/// The same for links and connectors, each between two bushings.
void add_connector_stability(const CompiledTrack& track, Workspace& work) {
  const LinkBodies& connectors = track.bodies[1];
  const Mobility link(track.mass, track.inertia, track.groove);
  const Mobility connector(connectors.mass, connectors.inertia, 0.5 * track.connector_length);
  for (int k = 0; k < track.num_links; k += k_lanes) {
    const int valid = track.num_links - k, front = track.offset + k, rear = connectors.offset + k;
    add_joints(link, work, front, valid, front, work.stability);
    add_joints(link, work, rear, valid, front + 1, work.stability);
    add_joints(connector, work, front, valid, rear, work.stability);
    add_joints(connector, work, rear, valid, rear, work.stability);
  }
  close_seam(track, work.stability);
}

/// The shortest stable step, 2 / (s1 + sqrt(s1^2 + a)) with a = (4 beta - 3) s2, belongs to the largest rate.
void find_bound(const LinkBodies& bodies, double beta, Workspace& work) {
  double largest = 2.0 / work.largest_stable_step;
  for (int k = 0; k < bodies.count; k += k_lanes) {
    const int i = bodies.offset + k;
    const Lanes s2 = load(work.stability[0] + i), s1 = load(work.stability[1] + i);
    const Lanes rate = s1 + (s1 * s1 + (4.0 * beta - 3.0) * s2).sqrt();
    if (rate.max_lane() <= largest) continue;
    for (int lane = 0; lane < std::min(k_lanes, bodies.count - k); ++lane) {
      if (rate[lane] <= largest) continue;
      largest = rate[lane];
      work.largest_stable_step = 2.0 / largest;
      work.bounding = {i + lane, -1};
    }
  }
}

/// q exp(dtheta), renormalised to first order; series of sin and cos of half an angle below 0.25 rad are exact to
/// round-off.
void turn(const State& now, const Lanes3& angle, int i, State& next) {
  const Lanes u = 0.25 * dot(angle, angle);
  const Lanes c = 1.0 - u * (0.5 - u * (1.0 / 24.0 - u * (1.0 / 720.0 - u * (1.0 / 40320.0 - u / 3628800.0))));
  const Lanes s = 0.5 * (1.0 - u * (1.0 / 6.0 - u * (1.0 / 120.0 - u * (1.0 / 5040.0 - u / 362880.0))));
  const Lanes ex = s * angle.x, ey = s * angle.y, ez = s * angle.z;
  const Lanes w = load(now.orientation[0] + i), x = load(now.orientation[1] + i);
  const Lanes y = load(now.orientation[2] + i), z = load(now.orientation[3] + i);
  const Lanes rw = w * c - x * ex - y * ey - z * ez;
  const Lanes rx = w * ex + x * c + y * ez - z * ey;
  const Lanes ry = w * ey - x * ez + y * c + z * ex;
  const Lanes rz = w * ez + x * ey - y * ex + z * c;
  const Lanes norm = 1.5 - 0.5 * (rw * rw + rx * rx + ry * ry + rz * rz);
  store(next.orientation[0] + i, norm * rw);
  store(next.orientation[1] + i, norm * rx);
  store(next.orientation[2] + i, norm * ry);
  store(next.orientation[3] + i, norm * rz);
}

void accelerate(const LinkBodies& bodies, const Vector3d& g, double mass_damping, const State& state, Workspace& work,
                Acceleration& acceleration) {
  const Vector3d &inertia = bodies.inertia, per_inertia = inertia.cwiseInverse();
  const double per_mass = 1.0 / bodies.mass;
  Lanes kinetic = 0.0, height = 0.0;
  for (int first = 0; first < bodies.count; first += k_lanes) {
    const int i = bodies.offset + first;
    const Lanes3 v = load3(state.velocity, i), w = load3(state.angular_velocity, i);
    const Lanes3 force = load3(work.force_W, i), torque_W = load3(work.torque_W, i), p = load3(state.position, i);
    const auto r = [&](int c) { return load(work.rotation[c] + i); };
    const Lanes3 torque{r(0) * torque_W.x + r(3) * torque_W.y + r(6) * torque_W.z,
                        r(1) * torque_W.x + r(4) * torque_W.y + r(7) * torque_W.z,
                        r(2) * torque_W.x + r(5) * torque_W.y + r(8) * torque_W.z};
    const double d = mass_damping;
    store3(acceleration.linear, i, per_mass * force + in_all_lanes(g) - d * v);
    store3(acceleration.angular, i,
           {per_inertia.x() * (torque.x - (inertia.z() - inertia.y()) * w.y * w.z) - d * w.x,
            per_inertia.y() * (torque.y - (inertia.x() - inertia.z()) * w.z * w.x) - d * w.y,
            per_inertia.z() * (torque.z - (inertia.y() - inertia.x()) * w.x * w.y) - d * w.z});
    const Lanes energy =
        0.5 * (bodies.mass * dot(v, v) + inertia.x() * w.x * w.x + inertia.y() * w.y * w.y + inertia.z() * w.z * w.z);
    const Lanes lift = -bodies.mass * (g.x() * p.x + g.y() * p.y + g.z() * p.z);
    const LaneMask valid = LaneMask::first(bodies.count - first);
    kinetic += choose(valid, energy, 0.0);
    height += choose(valid, lift, 0.0);
  }
  work.energy.kinetic += kinetic.sum();
  work.energy.gravity += height.sum();
  work.energy.assembly_power += 2.0 * mass_damping * kinetic.sum();
}

}  // namespace

void link_accelerations(const System& system, const AssemblyKnobs& knobs, const State& state, Workspace& work,
                        Acceleration& acceleration) {
  for (const CompiledTrack& track : system.tracks) {
    if (track.joint == JointForm::connector_bodies) {
      add_connector_stability(track, work);
    } else {
      add_joint_stability(track, work);
    }
    for (const LinkBodies& bodies : track.bodies) {
      find_bound(bodies, system.scenario.integrator.beta, work);
      accelerate(bodies, system.gravity_W, knobs.mass_damping, state, work, acceleration);
    }
  }
}

double advance_links(const System& system, const StepWeights& weights, const State& now, const Acceleration& f_now,
                     const Acceleration& f_before, State& next) {
  Lanes largest = 0.0;
  for (int i = 0; i < system.link_array_length; i += k_lanes) {
    const Lanes3 v = load3(now.velocity, i), w = load3(now.angular_velocity, i);
    const Lanes3 a = load3(f_now.linear, i), a0 = load3(f_before.linear, i);
    const Lanes3 b = load3(f_now.angular, i), b0 = load3(f_before.angular, i);
    store3(next.position, i,
           load3(now.position, i) + weights.h * v + weights.position_now * a + weights.position_before * a0);
    store3(next.velocity, i, v + weights.velocity_now * a + weights.velocity_before * a0);
    store3(next.angular_velocity, i, w + weights.velocity_now * b + weights.velocity_before * b0);
    const Lanes3 angle = weights.h * w + weights.position_now * b + weights.position_before * b0;
    largest = largest.max(dot(angle, angle));
    turn(now, angle, i, next);
  }
  return std::sqrt(largest.max_lane());
}

LocalError link_error(const System& system, const ErrorWeights& weights, const Acceleration& next,
                      const Acceleration& now, const Acceleration& before) {
  const IntegratorOptions& options = system.scenario.integrator;
  const double ev = weights.velocity / options.velocity_tolerance,
               ed = weights.position / options.displacement_tolerance;
  const double r = weights.ratio;
  LocalError worst;
  for (const CompiledTrack& track : system.tracks) {
    const double arm = 0.5 * track.pitch;
    for (const LinkBodies& bodies : track.bodies) {
      for (int first = 0; first < bodies.count; first += k_lanes) {
        const int i = bodies.offset + first;
        const auto measure = [&](const Field& fn, const Field& f, const Field& fb) {
          const Lanes3 f1 = load3(f, i), change = load3(fn, i) - f1, old = f1 - load3(fb, i), bend = change - r * old;
          const Lanes last = dot(change, change), former = r * r * dot(old, old);
          return (ev * ev * dot(bend, bend)).max(ed * ed * last.max(former));
        };
        const Lanes linear = measure(next.linear, now.linear, before.linear);
        const Lanes angular = arm * arm * measure(next.angular, now.angular, before.angular);
        const Lanes error2 = linear.max(angular);
        for (int lane = 0; lane < std::min(k_lanes, bodies.count - first); ++lane) {
          if (std::isnan(error2[lane])) return {error2[lane], i + lane};
          if (error2[lane] > worst.ratio) worst = {error2[lane], i + lane};
        }
      }
    }
  }
  worst.ratio = std::sqrt(worst.ratio);
  return worst;
}

}  // namespace grouser
