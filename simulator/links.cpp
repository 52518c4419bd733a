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
  [[nodiscard]] double of(const Field& k, int j) const {
    return std::max({tx * k[0][j], tz * k[2][j] + ry * k[4][j], ty * k[1][j] + rz * k[5][j], rx * k[3][j]});
  }
};

/// Sums that the joints on both sides put into a link's stability bound: S2 over stiffness, S1 over damping.
void add_joint_stability(const CompiledTrack& track, Workspace& work) {
  const Mobility link(track.mass, track.inertia, 0.5 * track.pitch);
  const int first = track.offset, last = track.offset + track.num_links - 1;
  double s2_before = link.of(work.joint_stiffness, last), s1_before = link.of(work.joint_damping, last);
  for (int i = first; i <= last; ++i) {
    const double s2 = link.of(work.joint_stiffness, i), s1 = link.of(work.joint_damping, i);
    work.stability[0][i] += s2 + s2_before;
    work.stability[1][i] += s1 + s1_before;
    s2_before = s2;
    s1_before = s1;
  }
}

/// The same for links and connectors, each between two bushings.
void add_connector_stability(const CompiledTrack& track, Workspace& work) {
  const LinkBodies& connectors = track.bodies[1];
  const Mobility link(track.mass, track.inertia, track.groove);
  const Mobility connector(connectors.mass, connectors.inertia, 0.5 * track.connector_length);
  const int n = track.num_links;
  for (int k = 0; k < n; ++k) {
    const int front = track.offset + k, rear = connectors.offset + k, behind = connectors.offset + (k + n - 1) % n;
    for (const auto& [field, sum] : {std::pair(&work.joint_stiffness, 0), std::pair(&work.joint_damping, 1)}) {
      work.stability[sum][front] += link.of(*field, front) + link.of(*field, behind);
      work.stability[sum][rear] += connector.of(*field, front) + connector.of(*field, rear);
    }
  }
}

void find_bound(const LinkBodies& bodies, double beta, Workspace& work) {
  for (int i = bodies.offset; i < bodies.offset + bodies.count; ++i) {
    const double h = stable_step(beta, work.stability[0][i], work.stability[1][i]);
    if (h < work.largest_stable_step) {
      work.largest_stable_step = h;
      work.bounding = {i, -1};
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
  const Vector3d& inertia = bodies.inertia;
  Lanes kinetic = Lanes::Zero(), height = Lanes::Zero(), damped = Lanes::Zero();
  for (int first = 0; first < bodies.count; first += k_lanes) {
    const int i = bodies.offset + first;
    const Lanes3 v = load3(state.velocity, i), w = load3(state.angular_velocity, i);
    const Lanes3 force = load3(work.force_W, i), torque_W = load3(work.torque_W, i), p = load3(state.position, i);
    const auto r = [&](int c) { return load(work.rotation[c] + i); };
    const Lanes3 torque{r(0) * torque_W.x + r(3) * torque_W.y + r(6) * torque_W.z,
                        r(1) * torque_W.x + r(4) * torque_W.y + r(7) * torque_W.z,
                        r(2) * torque_W.x + r(5) * torque_W.y + r(8) * torque_W.z};
    const double d = mass_damping;
    store3(acceleration.linear, i,
           {force.x / bodies.mass + g.x() - d * v.x, force.y / bodies.mass + g.y() - d * v.y,
            force.z / bodies.mass + g.z() - d * v.z});
    store3(acceleration.angular, i,
           {(torque.x - (inertia.z() - inertia.y()) * w.y * w.z) / inertia.x() - d * w.x,
            (torque.y - (inertia.x() - inertia.z()) * w.z * w.x) / inertia.y() - d * w.y,
            (torque.z - (inertia.y() - inertia.x()) * w.x * w.y) / inertia.z() - d * w.z});
    Lanes energy =
        0.5 * (bodies.mass * dot(v, v) + inertia.x() * w.x * w.x + inertia.y() * w.y * w.y + inertia.z() * w.z * w.z);
    Lanes lift = -bodies.mass * (g.x() * p.x + g.y() * p.y + g.z() * p.z);
    for (int lane = bodies.count - first; lane < k_lanes; ++lane) energy[lane] = lift[lane] = 0.0;
    kinetic += energy;
    height += lift;
    damped += 2.0 * d * energy;
  }
  work.energy.kinetic += kinetic.sum();
  work.energy.gravity += height.sum();
  work.energy.assembly_power += damped.sum();
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
  Lanes largest = Lanes::Zero();
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
  return std::sqrt(largest.maxCoeff());
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
          return Lanes((ev * ev * dot(bend, bend)).max(ed * ed * last.max(former)));
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
