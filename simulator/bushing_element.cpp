#include "simulator/bushing_element.h"

#include <cmath>

#include "model/bushing_law.h"

namespace grouser {
namespace {

struct SpringLanes {
  Lanes force, slope, energy;
};

SpringLanes evaluate_spring(const CompiledSpring& spring, const Lanes& x) {
  const Lanes at = spring.odd ? x.abs() : x;
  const LaneIndex piece = LaneIndex::of_piece(spring.begin, at);
  const Lanes c0 = piece.in(spring.cubic[0]), c1 = piece.in(spring.cubic[1]);
  const Lanes c2 = piece.in(spring.cubic[2]), c3 = piece.in(spring.cubic[3]);
  const Lanes u = at - piece.in(spring.begin);
  const Lanes force = c0 + u * (c1 + u * (c2 + u * c3));
  return {spring.odd ? choose(x < 0.0, -force, force) : force, c1 + u * (2.0 * c2 + u * (3.0 * c3)),
          piece.in(spring.energy) + u * (c0 + u * (0.5 * c1 + u * ((1.0 / 3.0) * c2 + u * (0.25 * c3))))};
}

/// Translation of the pin against the groove in the frame of own, and its rate there.
void translate(const BodyLanes& own, const BodyLanes& next, const ElementShape& shape, ElementKinematics& k) {
  const Lanes3 groove = shape.groove * own.x;
  k.pin_from_next = shape.pin * next.x;
  const Lanes3 between = next.position - own.position;
  k.pin_from_own = between + k.pin_from_next;
  const Lanes3 gap = k.pin_from_own - groove;
  // d/dt of R_i^T gap = R_i^T (v_pin - v_i - w_i x (pin - center_i))
  const Lanes3 gap_rate = next.velocity + cross(next.angular_velocity, k.pin_from_next) - own.velocity -
                          cross(own.angular_velocity, k.pin_from_own);
  k.deflection[0] = dot(own.x, gap);
  k.deflection[1] = dot(own.y, gap);
  k.deflection[2] = dot(own.z, gap);
  k.rate[0] = dot(own.x, gap_rate);
  k.rate[1] = dot(own.y, gap_rate);
  k.rate[2] = dot(own.z, gap_rate);
}

/// Swing-twist of q = conj(q_i) q_j: q = swing * twist with the twist about y. With n^2 = w^2 + y^2:
///   phi = 2 atan2(y, w),  s_x = 2 (x w + z y) / n,  s_z = 2 (z w - x y) / n   (swing vector in frame i, 2 sin(angle/2)
///   long).
/// Jacobians from q' = q Omega_j / 2.
void rotate(const BodyLanes& own, const BodyLanes& next, ElementKinematics& k) {
  const Lanes aw = own.orientation[0], ax = -own.orientation[1], ay = -own.orientation[2], az = -own.orientation[3];
  const auto& [bw, bx, by, bz] = next.orientation;
  Lanes w = aw * bw - ax * bx - ay * by - az * bz;
  Lanes x = aw * bx + ax * bw + ay * bz - az * by;
  Lanes y = aw * by - ax * bz + ay * bw + az * bx;
  Lanes z = aw * bz + ax * by - ay * bx + az * bw;
  const Lanes sign = choose(w < 0.0, -1.0, 1.0);
  w *= sign, x *= sign, y *= sign, z *= sign;

  const Lanes n2 = w * w + y * y, n = n2.sqrt(), inverse_n = n.inverse(), inverse_n2 = inverse_n * inverse_n;
  const Lanes quarter = y / (w + n);  // tan(phi / 4)
  k.deflection[4] = 8.0 * arc_tangent(quarter / (1.0 + (1.0 + quarter * quarter).sqrt()));
  const Lanes a = x * w + z * y, b = z * w - x * y;
  k.deflection[3] = 2.0 * a * inverse_n;
  k.deflection[5] = 2.0 * b * inverse_n;

  const Lanes p = w * z + x * y, q = y * z - w * x, zero = 0.0;
  const Lanes a3 = a * inverse_n2 * inverse_n, b3 = b * inverse_n2 * inverse_n;
  k.jacobian_ry = {p * inverse_n2, 1.0, q * inverse_n2};
  k.jacobian_rx = {(w * w - x * x - y * y + z * z) * inverse_n - a3 * q, zero,
                   2.0 * (w * y - x * z) * inverse_n + a3 * p};
  k.jacobian_rz = {-2.0 * (w * y + x * z) * inverse_n - b3 * q, zero,
                   (w * w + x * x - y * y - z * z) * inverse_n + b3 * p};
  const Lanes3 relative = next.angular_velocity - own.angular_velocity;
  const Lanes3 relative_j{dot(next.x, relative), dot(next.y, relative), dot(next.z, relative)};
  k.rate[3] = dot(k.jacobian_rx, relative_j);
  k.rate[4] = dot(k.jacobian_ry, relative_j);
  k.rate[5] = dot(k.jacobian_rz, relative_j);
}

/// One axis of eight joints over a step from `before` to `after`, whose rows it writes.
struct AxisStep {
  const CompiledAxis& axis;
  const std::vector<MaxwellStep>& branch_step;  ///< one per branch of the axis
  const History& before;
  History& after;
  int joint;  ///< the first of the eight
  double h;
  bool memory;
};

struct AxisForce {
  Lanes force, stiffness, damping;  ///< restoring force, its dynamic tangents
};

void add_stops(const AxisStep& step, const Lanes& dx, AxisForce& sum, ElementEnergy& energy) {
  const double* before = step.before.stop[step.axis.first_stop] + step.joint;
  double* after = step.after.stop[step.axis.first_stop] + step.joint;
  Lanes force = 0.0, twice_stored = 0.0, lost = 0.0;
  double stiffness = 0.0;
  for (const FrictionStop& stop : step.axis.stops) {
    const Lanes old = load(before), moved = advance_stop(old, dx, stop.yield), f = stop.stiffness * moved;
    store(after, moved);
    force += f;
    stiffness += stop.stiffness;
    twice_stored += f * moved;
    lost += f * stop_slip(old, moved, dx);
    before += step.before.stop.length();
    after += step.after.stop.length();
  }
  sum.force += force;
  sum.stiffness += stiffness;
  energy.stored += 0.5 * twice_stored;
  energy.step_loss += lost;
}

/// Stops whose yields grow with the displacement: no stiffer than k, for a stop never rises faster than x. Out of line,
/// so that laws without growth do not carry it.
[[gnu::noinline]] void add_growing_stops(const AxisStep& step, const Lanes& x, const Lanes& dx, AxisForce& sum,
                                         ElementEnergy& energy) {
  const double growth = step.axis.yield_growth;
  const Lanes scale_before = yield_scale(growth, x - dx), scale_after = yield_scale(growth, x);
  for (std::size_t s = 0; s < step.axis.stops.size(); ++s) {
    const FrictionStop& stop = step.axis.stops[s];
    const int row = step.axis.first_stop + static_cast<int>(s);
    const Lanes yield = stop.yield * scale_after, mean_yield = 0.5 * stop.yield * (scale_before + scale_after);
    const Lanes old = load(step.before.stop[row] + step.joint), moved = advance_stop(old, dx, yield);
    store(step.after.stop[row] + step.joint, moved);
    sum.force += stop.stiffness * moved;
    sum.stiffness += stop.stiffness;
    energy.stored += (0.5 * stop.stiffness) * moved.square();
    energy.step_loss += stop.stiffness * mean_yield * stop_slip(old, moved, dx).abs();
  }
}

void add_branches(const AxisStep& step, const Lanes& dx, AxisForce& sum, ElementEnergy& energy) {
  const double* before = step.before.branch[step.axis.first_branch] + step.joint;
  double* after = step.after.branch[step.axis.first_branch] + step.joint;
  Lanes force = 0.0, carried = 0.0, stored = 0.0, stored_before = 0.0;
  double stiffness = 0.0, work_per_way = 0.0;
  for (const MaxwellStep& branch : step.branch_step) {
    const Lanes old = load(before), moved = branch.decay * old + branch.gain * dx;
    store(after, moved);
    force += moved;
    stiffness += branch.gain;
    work_per_way += branch.work_per_way;
    carried += branch.gain_share * old;
    stored += branch.compliance * moved.square();
    stored_before += branch.compliance * old.square();
    before += step.before.branch.length();
    after += step.after.branch.length();
  }
  sum.force += force;
  sum.stiffness += stiffness;
  energy.stored += stored;
  if (step.h > 0.0) energy.step_loss += dx * (work_per_way * dx + carried) - (stored - stored_before);
}

/// Restoring force of one axis for eight joints, its memory moved on by the step.
AxisForce axis_force(const AxisStep& step, const Lanes& x, const Lanes& dx, const Lanes& rate, ElementEnergy& energy) {
  const CompiledAxis& axis = step.axis;
  const SpringLanes spring = evaluate_spring(axis.spring, x);
  AxisForce sum{spring.force, spring.slope, axis.viscous};
  energy.stored += spring.energy;
  if (!step.memory) {
    constexpr double k_assembly_damping_time = 4e-5;  // s; damper of the relaxed rubber, c = time * tangent
    sum.damping = k_assembly_damping_time * spring.slope;
  } else {
    if (axis.yield_growth > 0.0) {
      add_growing_stops(step, x, dx, sum, energy);
    } else {
      add_stops(step, dx, sum, energy);
    }
    add_branches(step, dx, sum, energy);
  }
  sum.force += sum.damping * rate;
  energy.power += sum.damping * rate.square();
  return sum;
}

/// A pin with radial play: what of its deflection the rubber feels, and how the rubber's forces act back on it.
struct Play {
  Lanes engaged;  ///< 1 beyond the play
  Lanes share;    ///< d(felt)/d(deflection) across the radius: 1 - c / r, 0 within the play
  Lanes gain;     ///< by what it is larger along the radius, over r^2: c / r^3
  Lanes x, z;     ///< pin less groove [m]

  Play(double clearance, const Lanes& pin_x, const Lanes& pin_z) : x(pin_x), z(pin_z) {
    const Lanes r = (x * x + z * z).sqrt();
    engaged = choose(r > clearance, 1.0, 0.0);
    const Lanes over = engaged / r.max(clearance);
    share = engaged - clearance * over;
    gain = clearance * over * over * over;
  }
  /// Jacobian of the felt deflection (symmetric) times (a, b): rates forth, forces back.
  void apply(Lanes& a, Lanes& b) const {
    const Lanes along = gain * (x * a + z * b);
    a = share * a + along * x;
    b = share * b + along * z;
  }
};

/// The law of every axis for the deflections and rates that the rubber feels.
void add_rubber(const RubberStep& step, const AxisLanes& felt, const AxisLanes& rate, int joint, RubberLoad& rubber) {
  for (std::size_t a = 0; a < k_num_axes; ++a) {
    const AxisStep axis_step{
        step.track.bushing[a], step.branch_step[a], step.before, step.after, joint, step.h, step.memory};
    const double free = a == static_cast<std::size_t>(Axis::ry) ? step.track.free_twist : 0.0;
    const AxisForce sum = axis_force(axis_step, felt[a] - free, rubber.moved[a], rate[a], rubber.energy);
    rubber.force[a] = sum.force;
    rubber.stiffness[a] = sum.stiffness;
    rubber.damping[a] = sum.damping;
  }
}

/// The same with radial play.
void add_worn_rubber(const RubberStep& step, const ElementKinematics& k, int joint, RubberLoad& rubber) {
  const double clearance = step.track.clearance;
  const Lanes last_x = load(step.before.deflection[0] + joint), last_z = load(step.before.deflection[2] + joint);
  const Play play(clearance, k.deflection[0], k.deflection[2]), last(clearance, last_x, last_z);
  AxisLanes felt = k.deflection, rate = k.rate;
  felt[0] *= play.share;
  felt[2] *= play.share;
  rubber.moved[0] = felt[0] - last.share * last_x;
  rubber.moved[2] = felt[2] - last.share * last_z;
  play.apply(rate[0], rate[2]);
  add_rubber(step, felt, rate, joint, rubber);
  play.apply(rubber.force[0], rubber.force[2]);
  for (const std::size_t a : {0, 2}) {
    rubber.stiffness[a] *= play.engaged;
    rubber.damping[a] *= play.engaged;
  }
}

/// Back-bending beyond the stop: the links' own steel, an elastic stop without loss.
void add_hinge_stop(const CompiledTrack& track, const Lanes& angle, RubberLoad& rubber) {
  const Lanes over = (angle - track.stop_angle).max(0.0);
  rubber.force[4] += track.stop_stiffness * over;
  rubber.stiffness[4] += choose(over > 0.0, track.stop_stiffness, 0.0);
  rubber.energy.stored += 0.5 * track.stop_stiffness * over.square();
}

}  // namespace

BodyLanes load_bodies(const State& state, const Workspace& work, int i) {
  const auto axis = [&](int c) {
    return Lanes3{load(work.rotation[c] + i), load(work.rotation[3 + c] + i), load(work.rotation[6 + c] + i)};
  };
  return {load3(state.position, i),
          axis(0),
          axis(1),
          axis(2),
          {load(state.orientation[0] + i), load(state.orientation[1] + i), load(state.orientation[2] + i),
           load(state.orientation[3] + i)},
          load3(state.velocity, i),
          load3(work.angular_velocity_W, i)};
}

BodyLanes half_turned(const BodyLanes& bodies) {
  BodyLanes turned = bodies;
  turned.x = -1.0 * bodies.x;
  turned.y = -1.0 * bodies.y;
  const auto& [w, x, y, z] = bodies.orientation;
  turned.orientation = {-z, y, -x, w};  // q (0, 0, 0, 1)
  return turned;
}

ElementKinematics element_kinematics(const BodyLanes& own, const BodyLanes& next, const ElementShape& shape) {
  ElementKinematics k;
  translate(own, next, shape, k);
  rotate(own, next, k);
  return k;
}

RubberLoad rubber_load(const RubberStep& step, const ElementKinematics& k, int joint) {
  RubberLoad rubber;
  for (std::size_t a = 0; a < k_num_axes; ++a) {
    const int row = static_cast<int>(a);
    rubber.moved[a] = k.deflection[a] - load(step.before.deflection[row] + joint);
    store(step.after.deflection[row] + joint, k.deflection[a]);
  }
  if (step.track.clearance > 0.0) {
    add_worn_rubber(step, k, joint, rubber);
  } else {
    add_rubber(step, k.deflection, k.rate, joint, rubber);
  }
  if (std::isfinite(step.track.stop_angle)) add_hinge_stop(step.track, k.deflection[4], rubber);
  return rubber;
}

AxisLanes slipping_tangent(const RubberStep& step, const RubberLoad& rubber, int joint) {
  AxisLanes tangent = rubber.stiffness;
  if (!step.memory) return tangent;
  for (std::size_t a = 0; a < k_num_axes; ++a) {
    const CompiledAxis& axis = step.track.bushing[a];
    for (std::size_t s = 0; s < axis.stops.size(); ++s) {
      const int row = axis.first_stop + static_cast<int>(s);
      const Lanes trial = load(step.before.stop[row] + joint) + rubber.moved[a];
      const Lanes advanced = load(step.after.stop[row] + joint);
      tangent[a] -= choose((advanced < trial) | (trial < advanced), axis.stops[s].stiffness, 0.0);
    }
  }
  return tangent;
}

ElementWrench element_wrench(const BodyLanes& own, const BodyLanes& next, const ElementKinematics& k,
                             const AxisLanes& f) {
  const Lanes3 force = -1.0 * (f[0] * own.x + f[1] * own.y + f[2] * own.z);
  const Lanes3 torque_j = -1.0 * (f[3] * k.jacobian_rx + f[4] * k.jacobian_ry + f[5] * k.jacobian_rz);
  const Lanes3 torque = torque_j.x * next.x + torque_j.y * next.y + torque_j.z * next.z;
  return {force, cross(k.pin_from_next, force) + torque, cross(k.pin_from_own, force) + torque};
}

Lanes arc_tangent(const Lanes& x) {
  const Lanes z = x * x;
  const Lanes p = (((-8.750608600031904122785e-1 * z - 1.615753718733365076637e1) * z - 7.500855792314704667340e1) * z -
                   1.228866684490136173410e2) *
                      z -
                  6.485021904942025371773e1;
  const Lanes q =
      ((((z + 2.485846490142306297962e1) * z + 1.650270098316988542046e2) * z + 4.328810604912902668951e2) * z +
       4.853903996359136964868e2) *
          z +
      1.945506571482613964425e2;
  return x + x * z * p / q;
}

}  // namespace grouser
