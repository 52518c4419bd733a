#include "simulator/bushing_element.h"

#include <cmath>

#include "model/bushing_law.h"
#include "simulator/lane_exponential.h"

namespace grouser {
namespace {

constexpr auto k_hinge = static_cast<std::size_t>(Axis::ry);

struct SpringLanes {
  Lanes force, slope, energy;
};

SpringLanes evaluate_spring(const CompiledSpring& spring, const Lanes& x) {
  const Lanes at = spring.odd ? x.abs() : x;
  const auto [begin, c0, c1, c2, c3, energy] = spring.pieces.at(at);
  const Lanes u = at - begin;
  const Lanes force = c0 + u * (c1 + u * (c2 + u * c3));
  return {spring.odd ? choose(x < 0.0, -force, force) : force, c1 + u * (2.0 * c2 + u * (3.0 * c3)),
          energy + u * (c0 + u * (0.5 * c1 + u * ((1.0 / 3.0) * c2 + u * (0.25 * c3))))};
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

/// 4 arctan(x), |x| <= 1: hinges hardly ever turn so far, 2.3 rad, that the argument has to be halved.
Lanes four_arc_tangents(const Lanes& x) {
  if (bits_of(k_largest_tangent < x.abs()) == 0) return 4.0 * arc_tangent(x);
  return 8.0 * arc_tangent(x / (1.0 + (1.0 + x * x).sqrt()));
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
  k.deflection[4] = four_arc_tangents(y / (w + n));
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

/// Goes through the rows that eight joints remember in, one element of the law after the other; the axes follow each
/// other. One number moves, which stays in a register: pairs of pointers went through memory.
struct MemoryRows {
  const double* before;
  double* after;
  std::ptrdiff_t length, at = 0;
  MemoryRows(const Field& from, Field& to, int joint)
      : before(from[0] + joint), after(to[0] + joint), length(from.length()) {}
  [[nodiscard]] Lanes old() const { return load(before + at); }
  /// Stores what becomes of the row, asks for the line that the next block will write there (the rows of a track fill
  /// the first cache several times over) and goes on to the next row.
  void keep(const Lanes& moved) {
    store(after + at, moved);
    __builtin_prefetch(after + at + k_lanes, 1);
    at += length;
  }
};

struct AxisForce {
  Lanes force, stiffness, damping;  ///< restoring force, its dynamic tangents
};

/// dx by value, in a register: for all that the compiler knows, storing a row may change what a reference names.
void add_stops(const CompiledAxis& axis, Lanes dx, MemoryRows& rows, AxisForce& sum, ElementEnergy& energy) {
  Lanes twice_stored = 0.0;
  for (const FrictionStop& stop : axis.stops) {
    const Lanes old = rows.old(), moved = advance_stop(old, dx, stop.yield), f = stop.stiffness * moved;
    rows.keep(moved);
    sum.force += f;
    twice_stored += f * moved;
    energy.step_loss += f * stop_slip(old, moved, dx);
  }
  sum.stiffness += axis.stop_stiffness;
  energy.stored += 0.5 * twice_stored;
}

/// Stops whose yields grow with the displacement: no stiffer than k, for a stop never rises faster than x. Out of line,
/// so that laws without growth do not carry it.
[[gnu::noinline]] void add_growing_stops(const CompiledAxis& axis, const Lanes& x, const Lanes& dx, MemoryRows& rows,
                                         AxisForce& sum, ElementEnergy& energy) {
  const Lanes scale_before = yield_scale(axis.yield_growth, x - dx), scale_after = yield_scale(axis.yield_growth, x);
  for (const FrictionStop& stop : axis.stops) {
    const Lanes yield = stop.yield * scale_after, mean_yield = 0.5 * stop.yield * (scale_before + scale_after);
    const Lanes old = rows.old(), moved = advance_stop(old, dx, yield);
    rows.keep(moved);
    sum.force += stop.stiffness * moved;
    energy.stored += (0.5 * stop.stiffness) * moved.square();
    energy.step_loss += stop.stiffness * mean_yield * stop_slip(old, moved, dx).abs();
  }
  sum.stiffness += axis.stop_stiffness;
}

void add_branches(const AxisBranches& branches, Lanes dx, MemoryRows& rows, AxisForce& sum, ElementEnergy& energy) {
  Lanes carried = branches.work_per_way * dx, stored = 0.0, stored_before = 0.0;
  for (const MaxwellStep& branch : branches.branch) {
    const Lanes old = rows.old(), moved = branch.decay * old + branch.gain * dx;
    rows.keep(moved);
    sum.force += moved;
    carried += branch.gain_share * old;
    stored += branch.compliance * moved.square();
    stored_before += branch.compliance * old.square();
  }
  sum.stiffness += branches.gain;
  energy.stored += stored;
  energy.step_loss += dx * carried - (stored - stored_before);
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

/// The law of every axis for the deflections and rates that the rubber feels. All springs first: their look-ups wait
/// for each other, axis beside axis they do not.
void add_rubber(const RubberStep& step, const AxisLanes& felt, const AxisLanes& rate, int joint, RubberLoad& rubber) {
  constexpr double k_relaxed_damping_time = 4e-5;  // s; damper of the relaxed rubber, c = time * tangent
  AxisLanes x = felt;
  x[k_hinge] -= step.track.free_twist;
  std::array<SpringLanes, k_num_axes> springs;
  for (std::size_t a = 0; a < k_num_axes; ++a) springs[a] = evaluate_spring(step.track.bushing[a].spring, x[a]);
  MemoryRows stop_rows(step.before.stop, step.after.stop, joint);
  MemoryRows branch_rows(step.before.branch, step.after.branch, joint);
  ElementEnergy energy;
  for (std::size_t a = 0; a < k_num_axes; ++a) {
    const CompiledAxis& axis = step.track.bushing[a];
    AxisForce sum{springs[a].force, springs[a].slope, axis.viscous};
    energy.stored += springs[a].energy;
    if (!step.memory) {
      sum.damping = k_relaxed_damping_time * springs[a].slope;
    } else {
      if (axis.yield_growth > 0.0) {
        add_growing_stops(axis, x[a], rubber.moved[a], stop_rows, sum, energy);
      } else {
        add_stops(axis, rubber.moved[a], stop_rows, sum, energy);
      }
      add_branches(step.branch_step[a], rubber.moved[a], branch_rows, sum, energy);
    }
    energy.power += sum.damping * rate[a].square();
    rubber.force[a] = sum.force + sum.damping * rate[a];
    rubber.stiffness[a] = sum.stiffness;
    rubber.damping[a] = sum.damping;
  }
  rubber.energy = energy;
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

void prepare_branches(const CompiledAxis& axis, double h, AxisBranches& branches) {
  if (branches.h == h) return;
  branches.h = h;
  branches.gain = branches.work_per_way = 0.0;
  for (std::size_t block = 0; block < axis.relaxation_rate.size(); ++block) {
    const auto [lost, share, rest] = relaxation(h * axis.relaxation_rate[block]);
    const std::size_t first = k_lanes * block, count = std::min<std::size_t>(k_lanes, axis.branches.size() - first);
    for (std::size_t k = 0; k < count; ++k) {
      const int lane = static_cast<int>(k);
      MaxwellStep& step = branches.branch[first + k];
      step = maxwell_step(axis.branches[first + k].stiffness, {lost[lane], share[lane], rest[lane]});
      branches.gain += step.gain;
      branches.work_per_way += step.work_per_way;
    }
  }
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
