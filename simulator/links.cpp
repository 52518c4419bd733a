#include "simulator/links.h"

#include <cmath>

namespace grouser {
namespace {

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
  Lanes kinetic = 0.0, height = 0.0, all = 0.0;
  for (int first = 0; first < bodies.count; first += k_lanes) {
    const int i = bodies.offset + first;
    const Lanes3 v = load3(state.velocity, i), w = load3(state.angular_velocity, i);
    const Lanes3 force = load3(work.force_W, i), torque_W = load3(work.torque_W, i), p = load3(state.position, i);
    const auto r = [&](int c) { return load(work.rotation[c] + i); };
    const Lanes3 torque{r(0) * torque_W.x + r(3) * torque_W.y + r(6) * torque_W.z,
                        r(1) * torque_W.x + r(4) * torque_W.y + r(7) * torque_W.z,
                        r(2) * torque_W.x + r(5) * torque_W.y + r(8) * torque_W.z};
    const double d = mass_damping;
    const Lanes3 linear = per_mass * force + in_all_lanes(g) - d * v;
    const Lanes3 angular{per_inertia.x() * (torque.x - (inertia.z() - inertia.y()) * w.y * w.z) - d * w.x,
                         per_inertia.y() * (torque.y - (inertia.x() - inertia.z()) * w.z * w.x) - d * w.y,
                         per_inertia.z() * (torque.z - (inertia.y() - inertia.x()) * w.x * w.y) - d * w.z};
    store3(acceleration.linear, i, linear);
    store3(acceleration.angular, i, angular);
    const Lanes energy =
        0.5 * (bodies.mass * dot(v, v) + inertia.x() * w.x * w.x + inertia.y() * w.y * w.y + inertia.z() * w.z * w.z);
    const Lanes lift = -bodies.mass * (g.x() * p.x + g.y() * p.y + g.z() * p.z);
    const LaneMask valid = LaneMask::first(bodies.count - first);
    all += choose(valid, (linear.x + linear.y + linear.z) + (angular.x + angular.y + angular.z), 0.0);
    kinetic += choose(valid, energy, 0.0);
    height += choose(valid, lift, 0.0);
  }
  work.sum_of_accelerations += all.sum();
  work.energy.kinetic += kinetic.sum();
  work.energy.gravity += height.sum();
  work.energy.assembly_power += 2.0 * mass_damping * kinetic.sum();
}

}  // namespace

void link_accelerations(const System& system, const AssemblyKnobs& knobs, const State& state, Workspace& work,
                        Acceleration& acceleration) {
  work.sum_of_accelerations = 0.0;
  for (const CompiledTrack& track : system.tracks) {
    for (const LinkBodies& bodies : track.bodies) {
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

double contact_step_loss(const System& system, const StepWeights& weights, const State& now, const Workspace& work_now,
                         const Acceleration& f_now, const Acceleration& f_before, const State& next,
                         const Workspace& work_next) {
  Lanes loss = 0.0;
  for (const CompiledTrack& track : system.tracks) {
    for (const LinkBodies& bodies : track.bodies) {
      for (int first = 0; first < bodies.count; first += k_lanes) {
        const int i = bodies.offset + first;
        const auto beyond = [&](const Field& f, const Field& f0) {  // the way less h v_n
          return weights.position_now * load3(f, i) + weights.position_before * load3(f0, i);
        };
        const Lanes3 way = beyond(f_now.linear, f_before.linear);
        const Lanes3 turn_L = beyond(f_now.angular, f_before.angular);
        const Lanes3 turn = turn_L.x * load_axis(work_now, 0, i) + turn_L.y * load_axis(work_now, 1, i) +
                            turn_L.z * load_axis(work_now, 2, i);
        // The same less h v_{n+1}.
        const Lanes3 way_back = way - weights.h * (load3(next.velocity, i) - load3(now.velocity, i));
        const Lanes3 turn_back =
            turn - weights.h * (load3(work_next.angular_velocity_W, i) - load3(work_now.angular_velocity_W, i));
        const Lanes both = dot(load3(work_now.loss_force_W, i), way) + dot(load3(work_now.loss_torque_W, i), turn) +
                           dot(load3(work_next.loss_force_W, i), way_back) +
                           dot(load3(work_next.loss_torque_W, i), turn_back);
        loss -= choose(LaneMask::first(bodies.count - first), 0.5 * both, 0.0);
      }
    }
  }
  return loss.sum();
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
        const LaneMask not_smaller = !(error2 <= worst.ratio);  // also what is no number
        if (bits_of(not_smaller & LaneMask::first(bodies.count - first)) == 0) continue;
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
