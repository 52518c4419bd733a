#include "simulator/bushings.h"

#include <array>
#include <cmath>

#include "model/bushing_law.h"

namespace grouser {
namespace {

using Axes = std::array<Lanes, k_num_axes>;

/// Deflections and their rates of eight joints, and the lever arms that turn generalised forces into a wrench.
struct JointKinematics {
  Axes deflection, rate;
  Lanes3 axis_x, axis_y, axis_z;       ///< frame i in W
  Lanes3 next_x, next_y, next_z;       ///< frame j in W
  Lanes3 pin_from_own, pin_from_next;  ///< pin less link centre, W
  Lanes3 jacobian_rx, jacobian_ry,
      jacobian_rz;  ///< rate of each angle over the angular velocity of j against i, frame j
};

struct SpringLanes {
  Lanes force, slope, energy;
};

struct SpringPoint {
  double force, slope, energy;
};

SpringPoint evaluate_spring(const CompiledSpring& spring, double x) {
  if (x >= spring.high) {
    const double over = x - spring.high;
    return {spring.high_force + spring.high_slope * over, spring.high_slope,
            spring.high_energy + over * (spring.high_force + 0.5 * spring.high_slope * over)};
  }
  if (!(x > spring.low)) {
    const double over = x - spring.low, force = spring.cubic[0][0];
    return {force + spring.low_slope * over, spring.low_slope,
            spring.energy[0] + over * (force + 0.5 * spring.low_slope * over)};
  }
  auto i = static_cast<std::size_t>(
      spring.cell_interval[static_cast<std::size_t>((x - spring.low) * spring.cells_per_unit)]);
  while (i + 1 < spring.cubic.size() && x >= spring.knot[i + 1]) ++i;
  const auto& c = spring.cubic[i];
  const double u = x - spring.knot[i];
  return {c[0] + u * (c[1] + u * (c[2] + u * c[3])), c[1] + u * (2.0 * c[2] + u * 3.0 * c[3]),
          spring.energy[i] + u * (c[0] + u * (c[1] / 2.0 + u * (c[2] / 3.0 + u * c[3] / 4.0)))};
}

SpringLanes evaluate_spring(const CompiledSpring& spring, const Lanes& x) {
  SpringLanes result;
  for (int lane = 0; lane < k_lanes; ++lane) {
    const double value = x[lane];
    const SpringPoint at = evaluate_spring(spring, spring.odd ? std::abs(value) : value);
    result.force[lane] = spring.odd ? std::copysign(at.force, value) : at.force;
    result.slope[lane] = at.slope;
    result.energy[lane] = at.energy;
  }
  return result;
}

Lanes3 column(const Field& rotation, int c, int i) {
  return {load(rotation[c] + i), load(rotation[3 + c] + i), load(rotation[6 + c] + i)};
}

/// Translation of the pin against the groove in frame i, and its rate there.
void translate(const CompiledTrack& track, const State& state, const Workspace& work, int i, JointKinematics& k) {
  const double half = 0.5 * track.pitch;
  const Lanes3 groove = half * k.axis_x;
  k.pin_from_next = -half * k.next_x;
  const Lanes3 between = load3(state.position, i + 1) - load3(state.position, i);
  k.pin_from_own = between + k.pin_from_next;
  const Lanes3 gap = k.pin_from_own - groove;
  const Lanes3 own_rate = load3(work.angular_velocity_W, i), next_rate = load3(work.angular_velocity_W, i + 1);
  // d/dt of R_i^T gap = R_i^T (v_pin - v_i - w_i x (pin - center_i))
  const Lanes3 gap_rate = load3(state.velocity, i + 1) + cross(next_rate, k.pin_from_next) - load3(state.velocity, i) -
                          cross(own_rate, k.pin_from_own);
  k.deflection[0] = dot(k.axis_x, gap);
  k.deflection[1] = dot(k.axis_y, gap);
  k.deflection[2] = dot(k.axis_z, gap);
  k.rate[0] = dot(k.axis_x, gap_rate);
  k.rate[1] = dot(k.axis_y, gap_rate);
  k.rate[2] = dot(k.axis_z, gap_rate);
}

/// Swing-twist of q = conj(q_i) q_j: q = swing * twist with the twist about y. With n^2 = w^2 + y^2:
///   phi = 2 atan2(y, w),  s_x = 2 (x w + z y) / n,  s_z = 2 (z w - x y) / n   (swing vector in frame i, 2 sin(angle/2)
///   long).
/// Jacobians from q' = q Omega_j / 2.
void rotate(const State& state, const Workspace& work, int i, JointKinematics& k) {
  const Lanes aw = load(state.orientation[0] + i), ax = -load(state.orientation[1] + i);
  const Lanes ay = -load(state.orientation[2] + i), az = -load(state.orientation[3] + i);
  const Lanes bw = load(state.orientation[0] + i + 1), bx = load(state.orientation[1] + i + 1);
  const Lanes by = load(state.orientation[2] + i + 1), bz = load(state.orientation[3] + i + 1);
  Lanes w = aw * bw - ax * bx - ay * by - az * bz;
  Lanes x = aw * bx + ax * bw + ay * bz - az * by;
  Lanes y = aw * by - ax * bz + ay * bw + az * bx;
  Lanes z = aw * bz + ax * by - ay * bx + az * bw;
  const Lanes sign = (w < 0.0).select(Lanes::Constant(-1.0), Lanes::Constant(1.0));
  w *= sign, x *= sign, y *= sign, z *= sign;

  const Lanes n2 = w * w + y * y, n = n2.sqrt(), inverse_n = n.inverse(), inverse_n2 = inverse_n * inverse_n;
  const Lanes quarter = y / (w + n);  // tan(phi / 4)
  k.deflection[4] = 8.0 * arc_tangent(quarter / (1.0 + (1.0 + quarter * quarter).sqrt()));
  const Lanes a = x * w + z * y, b = z * w - x * y;
  k.deflection[3] = 2.0 * a * inverse_n;
  k.deflection[5] = 2.0 * b * inverse_n;

  const Lanes p = w * z + x * y, q = y * z - w * x, zero = Lanes::Zero();
  const Lanes a3 = a * inverse_n2 * inverse_n, b3 = b * inverse_n2 * inverse_n;
  k.jacobian_ry = {p * inverse_n2, Lanes::Ones(), q * inverse_n2};
  k.jacobian_rx = {(w * w - x * x - y * y + z * z) * inverse_n - a3 * q, zero,
                   2.0 * (w * y - x * z) * inverse_n + a3 * p};
  k.jacobian_rz = {-2.0 * (w * y + x * z) * inverse_n - b3 * q, zero,
                   (w * w + x * x - y * y - z * z) * inverse_n + b3 * p};
  const Lanes3 relative = load3(work.angular_velocity_W, i + 1) - load3(work.angular_velocity_W, i);
  const Lanes3 relative_j{dot(k.next_x, relative), dot(k.next_y, relative), dot(k.next_z, relative)};
  k.rate[3] = dot(k.jacobian_rx, relative_j);
  k.rate[4] = dot(k.jacobian_ry, relative_j);
  k.rate[5] = dot(k.jacobian_rz, relative_j);
}

/// What the energy book takes from one block; lanes that are padding are dropped by the caller's mask.
struct BlockEnergy {
  Lanes stored = Lanes::Zero(), power = Lanes::Zero(), step_loss = Lanes::Zero();
};

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

/// Yields of an axis over those at displacement 0, when the step begins and when it ends: 1, or lanes of their own.
template <typename Scale>
struct YieldScales {
  Scale before, after;
};

template <typename Scale>
void add_stops(const AxisStep& step, const Lanes& dx, const YieldScales<Scale>& scales, AxisForce& sum,
               BlockEnergy& energy) {
  for (std::size_t s = 0; s < step.axis.stops.size(); ++s) {
    const int row = step.axis.first_stop + static_cast<int>(s);
    const double k = step.axis.stops[s].stiffness, yield = step.axis.stops[s].yield;
    const Scale yield_before = yield * scales.before, yield_after = yield * scales.after;
    const Lanes old = load(step.before.stop[row] + step.joint);
    const Lanes moved = advance_stop(old, dx, yield_after);
    store(step.after.stop[row] + step.joint, moved);
    sum.force += k * moved;
    sum.stiffness += k;
    energy.stored += 0.5 * k * moved.square();
    energy.step_loss += stop_dissipation(k, old, moved, dx, yield_before, yield_after);
  }
}

/// Stops whose yields grow with the displacement: no stiffer than k, for a stop never rises faster than x. Out of line,
/// so that laws without growth do not carry it.
[[gnu::noinline]] void add_growing_stops(const AxisStep& step, const Lanes& x, const Lanes& dx, AxisForce& sum,
                                         BlockEnergy& energy) {
  const double growth = step.axis.yield_growth;
  add_stops<Lanes>(step, dx, {yield_scale(growth, Lanes(x - dx)), yield_scale(growth, x)}, sum, energy);
}

void add_branches(const AxisStep& step, const Lanes& dx, AxisForce& sum, BlockEnergy& energy) {
  for (std::size_t m = 0; m < step.axis.branches.size(); ++m) {
    const int row = step.axis.first_branch + static_cast<int>(m);
    const MaxwellBranch& branch = step.axis.branches[m];
    const MaxwellStep& constants = step.branch_step[m];
    const Lanes old = load(step.before.branch[row] + step.joint);
    const Lanes moved = constants.decay * old + constants.gain * dx;
    store(step.after.branch[row] + step.joint, moved);
    sum.force += moved;
    sum.stiffness += constants.gain;
    energy.stored += moved.square() / (2.0 * branch.stiffness);
    if (step.h > 0.0) energy.step_loss += maxwell_dissipation(branch, constants, old, moved, dx, step.h);
  }
}

/// Restoring force of one axis for eight joints, its memory moved on by the step.
AxisForce axis_force(const AxisStep& step, const Lanes& x, const Lanes& dx, const Lanes& rate, BlockEnergy& energy) {
  const CompiledAxis& axis = step.axis;
  const SpringLanes spring = evaluate_spring(axis.spring, x);
  AxisForce sum{spring.force, spring.slope, Lanes::Constant(axis.viscous)};
  energy.stored += spring.energy;
  if (!step.memory) {
    constexpr double k_assembly_damping_time = 4e-5;  // s; damper of the relaxed rubber, c = time * tangent
    sum.damping = k_assembly_damping_time * spring.slope;
  } else {
    if (axis.yield_growth > 0.0) {
      add_growing_stops(step, x, dx, sum, energy);
    } else {
      add_stops<double>(step, dx, {1.0, 1.0}, sum, energy);
    }
    add_branches(step, dx, sum, energy);
  }
  sum.force += sum.damping * rate;
  energy.power += sum.damping * rate.square();
  return sum;
}

/// Force on link i+1 at the pin and moments on both links from the generalised forces, all in W.
void store_wrench(const JointKinematics& k, const Axes& f, int i, Workspace& work) {
  const Lanes3 force = -1.0 * (f[0] * k.axis_x + f[1] * k.axis_y + f[2] * k.axis_z);
  const Lanes3 torque_j = -1.0 * (f[3] * k.jacobian_rx + f[4] * k.jacobian_ry + f[5] * k.jacobian_rz);
  const Lanes3 torque = torque_j.x * k.next_x + torque_j.y * k.next_y + torque_j.z * k.next_z;
  store3(work.joint_force_W, i, force);
  store3(work.joint_torque_next_W, i, cross(k.pin_from_next, force) + torque);
  store3(work.joint_torque_own_W, i, cross(k.pin_from_own, force) + torque);
  store3(work.bushing_force, i, {f[0], f[1], f[2]});
  store3(work.bushing_torque, i, {f[3], f[4], f[5]});
}

Lanes lane_mask(int valid) {
  Lanes mask;
  for (int lane = 0; lane < k_lanes; ++lane) mask[lane] = lane < valid ? 1.0 : 0.0;
  return mask;
}

void track_bushings(const CompiledTrack& track, const AssemblyKnobs& knobs, const History& before, double h,
                    State& state, Workspace& work) {
  auto& branch_steps = work.branch_step[static_cast<std::size_t>(index_of(track.side))];
  for (std::size_t a = 0; a < k_num_axes; ++a) {
    for (std::size_t m = 0; m < branch_steps[a].size(); ++m) {
      branch_steps[a][m] = maxwell_step(track.bushing[a].branches[m], h);
    }
  }
  const double share = 1.0 / track.bushings_in_series, scale = knobs.stiffness_scale;
  for (int first = 0; first < track.num_links; first += k_lanes) {
    const int i = track.offset + first;
    JointKinematics k;
    k.axis_x = column(work.rotation, 0, i);
    k.axis_y = column(work.rotation, 1, i);
    k.axis_z = column(work.rotation, 2, i);
    k.next_x = column(work.rotation, 0, i + 1);
    k.next_y = column(work.rotation, 1, i + 1);
    k.next_z = column(work.rotation, 2, i + 1);
    translate(track, state, work, i, k);
    rotate(state, work, i, k);
    Axes force;
    BlockEnergy energy;
    for (int a = 0; a < k_num_axes; ++a) {
      const auto axis = static_cast<std::size_t>(a);
      const double free = a == index_of(Axis::ry) ? track.free_twist : 0.0;
      const Lanes moved = k.deflection[axis] - load(before.deflection[a] + i);
      const AxisStep step{track.bushing[axis], branch_steps[axis], before, state.history, i, h, knobs.rubber_memory};
      const AxisForce sum =
          axis_force(step, share * (k.deflection[axis] - free), share * moved, share * k.rate[axis], energy);
      force[axis] = scale * sum.force;
      store(work.deflection[a] + i, k.deflection[axis]);
      store(state.history.deflection[a] + i, k.deflection[axis]);
      store(work.joint_stiffness[a] + i, (scale * share) * sum.stiffness);
      store(work.joint_damping[a] + i, (scale * share) * sum.damping);
    }
    store_wrench(k, force, i, work);
    const Lanes mask = (scale / share) * lane_mask(track.num_links - first);
    work.energy.bushing += (mask * energy.stored).sum();
    work.energy.bushing_power += (mask * energy.power).sum();
    work.energy.bushing_step_loss += (mask * energy.step_loss).sum();
  }
}

}  // namespace

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

void place_links(const System& system, const State& state, Workspace& work) {
  for (int i = 0; i < system.link_array_length; i += k_lanes) {
    const Lanes w = load(state.orientation[0] + i), x = load(state.orientation[1] + i);
    const Lanes y = load(state.orientation[2] + i), z = load(state.orientation[3] + i);
    const std::array<Lanes, 9> r{1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z),       2.0 * (x * z + w * y),
                                 2.0 * (x * y + w * z),       1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x),
                                 2.0 * (x * z - w * y),       2.0 * (y * z + w * x),       1.0 - 2.0 * (x * x + y * y)};
    for (int c = 0; c < 9; ++c) store(work.rotation[c] + i, r[static_cast<std::size_t>(c)]);
    const Lanes3 rate = load3(state.angular_velocity, i);
    store3(work.angular_velocity_W, i,
           {r[0] * rate.x + r[1] * rate.y + r[2] * rate.z, r[3] * rate.x + r[4] * rate.y + r[5] * rate.z,
            r[6] * rate.x + r[7] * rate.y + r[8] * rate.z});
  }
}

void bushing_forces(const System& system, const AssemblyKnobs& knobs, const History& before, double h, State& state,
                    Workspace& work) {
  for (const CompiledTrack& track : system.tracks) track_bushings(track, knobs, before, h, state, work);
}

void sum_joint_forces(const System& system, Workspace& work) {
  for (const CompiledTrack& track : system.tracks) {
    const int first = track.offset, last = track.offset + track.num_links - 1;
    for (int c = 0; c < 3; ++c) {
      double* force = work.force_W[c];
      double* torque = work.torque_W[c];
      const double* joint = work.joint_force_W[c];
      const double* next = work.joint_torque_next_W[c];
      const double* own = work.joint_torque_own_W[c];
      force[first] += joint[last] - joint[first];
      torque[first] += next[last] - own[first];
      for (int i = first + 1; i <= last; ++i) {
        force[i] += joint[i - 1] - joint[i];
        torque[i] += next[i - 1] - own[i];
      }
    }
  }
}

}  // namespace grouser
