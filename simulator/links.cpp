#include "simulator/links.h"

#include <cmath>

namespace grouser {
namespace {

/// q exp(dtheta), renormalised to first order; series of sin and cos of half an angle below 0.25 rad are exact to
/// round-off.
void turn(const State& now, const Lanes3& angle, int i, State& next) {
  const Lanes u = 0.25 * dot(angle, angle);
  const Lanes c = 1.0 - u * (0.5 - u * (1.0 / 24.0 - u * (1.0 / 720.0 - u * (1.0 / 40320.0 - u * (1.0 / 3628800.0)))));
  const Lanes s = 0.5 * (1.0 - u * (1.0 / 6.0 - u * (1.0 / 120.0 - u * (1.0 / 5040.0 - u * (1.0 / 362880.0)))));
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

/// Accelerations of eight links at both ends of a step and at the beginning of the one before.
struct BlockAccelerations {
  Lanes3 before, now, next;
  BlockAccelerations(const StepEnds& ends, Field Acceleration::*field, int i)
      : before(load3(ends.f_before.*field, i)), now(load3(ends.f_now.*field, i)), next(load3(ends.f_next.*field, i)) {}
};

/// Squares of the links' embedded errors over their tolerances. Rotation counts as the speed of a point `arm` away.
struct LinkErrors {
  double bend2, change2, ratio, arm2;
  LinkErrors(const IntegratorOptions& options, const ErrorWeights& weights, double arm)
      : bend2(square(weights.velocity / options.velocity_tolerance)),
        change2(square(weights.position / options.displacement_tolerance)),
        ratio(weights.ratio),
        arm2(arm * arm) {}
  [[nodiscard]] Lanes squared(const BlockAccelerations& linear, const BlockAccelerations& angular) const {
    return of(linear).max(arm2 * of(angular));
  }

 private:
  static double square(double x) { return x * x; }
  [[nodiscard]] Lanes of(const BlockAccelerations& f) const {
    const Lanes3 change = f.next - f.now, old = f.now - f.before, bend = change - ratio * old;
    const Lanes last = dot(change, change), former = ratio * ratio * dot(old, old);
    return (bend2 * dot(bend, bend)).max(change2 * last.max(former));
  }
};

/// The largest of squared errors, by lanes until the end.
class LargestError {
 public:
  void see(const Lanes& error2, int i, const LaneMask& valid) {
    const LaneMask larger = (error2_ < error2) & valid;
    error2_ = choose(larger, error2, error2_);
    first_ = choose(larger, static_cast<double>(i), first_);
  }
  [[nodiscard]] LocalError found() const {
    LocalError worst;
    for (int lane = 0; lane < k_lanes; ++lane) {
      const double error2 = error2_[lane];
      const int link = static_cast<int>(first_[lane]) + lane;
      if (error2 > worst.ratio || (error2 == worst.ratio && link < worst.link)) worst = {error2, link};
    }
    return {std::sqrt(worst.ratio), worst.link};
  }

 private:
  Lanes error2_ = 0.0, first_ = 0.0;  ///< and the first link of the block that it stands in
};

/// What contacts took from eight links over their ways, less the trapezoid of the powers at both ends.
Lanes contact_loss(const StepWeights& step, const StepEnds& ends, const BlockAccelerations& linear,
                   const BlockAccelerations& angular, int i) {
  const Workspace &now = ends.work_now, &next = ends.work_next;
  // Of the way less h v_n, and of the way less h v_{n+1}.
  const Lanes3 way = step.position_now * linear.now + step.position_before * linear.before;
  const Lanes3 way_back = (step.position_now - step.h * step.velocity_now) * linear.now +
                          (step.position_before - step.h * step.velocity_before) * linear.before;
  const Lanes3 turn_L = step.position_now * angular.now + step.position_before * angular.before;
  const Lanes3 turn =
      turn_L.x * load_axis(now, 0, i) + turn_L.y * load_axis(now, 1, i) + turn_L.z * load_axis(now, 2, i);
  const Lanes3 turn_back = turn - step.h * (load3(next.angular_velocity_W, i) - load3(now.angular_velocity_W, i));
  return -0.5 * (dot(load3(now.loss_force_W, i), way) + dot(load3(now.loss_torque_W, i), turn) +
                 dot(load3(next.loss_force_W, i), way_back) + dot(load3(next.loss_torque_W, i), turn_back));
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

LinkVerdict judge_links(const System& system, const ErrorWeights& errors, const StepWeights& step,
                        const StepEnds& ends) {
  LargestError largest;
  Lanes loss = 0.0;
  for (const CompiledTrack& track : system.tracks) {
    const LinkErrors link_errors(system.scenario.integrator, errors, 0.5 * track.pitch);
    for (const LinkBodies& bodies : track.bodies) {
      for (int first = 0; first < bodies.count; first += k_lanes) {
        const int i = bodies.offset + first;
        const LaneMask valid = LaneMask::first(bodies.count - first);
        const BlockAccelerations linear(ends, &Acceleration::linear, i), angular(ends, &Acceleration::angular, i);
        largest.see(link_errors.squared(linear, angular), i, valid);
        loss += choose(valid, contact_loss(step, ends, linear, angular, i), 0.0);
      }
    }
  }
  return {largest.found(), loss.sum()};
}

}  // namespace grouser
