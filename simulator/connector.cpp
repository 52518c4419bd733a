#include "simulator/connector.h"

#include <limits>

namespace grouser {
namespace {

constexpr int k_size = 6;  // unknowns: translation, rotation, in W
// One to three corrections do. A joint that goes to and fro over a corner of its rubber's law, where a stop begins to
// slip, comes in by halves.
constexpr int k_whole_corrections = 8, k_most_corrections = 40;
constexpr double k_position_tolerance = 1e-8;  // m; 1 N of a bushing of 1e8 N/m
constexpr double k_angle_tolerance = 1e-7;     // rad

using Six = std::array<Lanes, k_size>;

/// J = sum of k g g^T, symmetric, and the right-hand sides that belong to it: for the pose the wrench on the connector,
/// for the motion what the wrench would lose in a second if the connector stood still.
struct Balance {
  std::array<Six, k_size> stiffness;
  Six wrench, wrench_rate;
};

Lanes3 in_world(const Lanes3& v, const BodyLanes& body) { return v.x * body.x + v.y * body.y + v.z * body.z; }

void put(Six& to, const Lanes3& force, const Lanes3& torque) {
  to[0] += force.x, to[1] += force.y, to[2] += force.z;
  to[3] += torque.x, to[4] += torque.y, to[5] += torque.z;
}

/// One spring of tangent k along the row g = d(deflection) / d(motion of the connector).
void add_spring(const Lanes3& linear, const Lanes3& angular, const Lanes& k, const Lanes& rate, const Six& motion,
                Balance& balance) {
  const Six g{linear.x, linear.y, linear.z, angular.x, angular.y, angular.z};
  Lanes own_rate = 0.0;
  for (std::size_t i = 0; i < k_size; ++i) own_rate += g[i] * motion[i];
  for (std::size_t i = 0; i < k_size; ++i) {
    const Lanes kg = k * g[i];
    balance.wrench_rate[i] += kg * (own_rate - rate);
    for (std::size_t j = 0; j <= i; ++j) balance.stiffness[i][j] += kg * g[j];
  }
}

/// Geometric stiffness of the force F on the pin at r from the connector's centre: (r F) I - sym(r F^T).
void add_geometric(const Lanes3& r, const Lanes3& f, Balance& balance) {
  const Lanes along = dot(r, f);
  auto& j = balance.stiffness;
  j[3][3] += along - r.x * f.x;
  j[4][4] += along - r.y * f.y;
  j[5][5] += along - r.z * f.z;
  j[4][3] -= 0.5 * (r.x * f.y + r.y * f.x);
  j[5][3] -= 0.5 * (r.x * f.z + r.z * f.x);
  j[5][4] -= 0.5 * (r.y * f.z + r.z * f.y);
}

void add_bushing(const BodyLanes& own, const BodyLanes& connector, const PinBushings& bushing, const AxisLanes& tangent,
                 const Six& motion, Balance& balance) {
  const ElementKinematics& k = bushing.kinematics;
  const ElementWrench& wrench = bushing.wrench;
  const Lanes3& r = k.pin_from_next;
  const Lanes3 still{0.0, 0.0, 0.0};
  add_spring(own.x, cross(r, own.x), tangent[0], k.rate[0], motion, balance);
  add_spring(own.y, cross(r, own.y), tangent[1], k.rate[1], motion, balance);
  add_spring(own.z, cross(r, own.z), tangent[2], k.rate[2], motion, balance);
  add_spring(still, in_world(k.jacobian_rx, connector), tangent[3], k.rate[3], motion, balance);
  add_spring(still, in_world(k.jacobian_ry, connector), tangent[4], k.rate[4], motion, balance);
  add_spring(still, in_world(k.jacobian_rz, connector), tangent[5], k.rate[5], motion, balance);
  add_geometric(r, wrench.force, balance);
  put(balance.wrench, wrench.force, wrench.torque_next);
  const Lanes3 carried = cross(own.angular_velocity, wrench.force);  // the force turns with its shoe
  put(balance.wrench_rate, carried, cross(r, carried));
}

/// L D L^T of eight symmetric matrices in place (D on the diagonal), no pivoting: they are positive definite.
void factorise(std::array<Six, k_size>& a) {
  for (std::size_t j = 0; j < k_size; ++j) {
    Six scaled;
    for (std::size_t k = 0; k < j; ++k) {
      scaled[k] = a[j][k] * a[k][k];
      a[j][j] -= a[j][k] * scaled[k];
    }
    for (std::size_t i = j + 1; i < k_size; ++i) {
      for (std::size_t k = 0; k < j; ++k) a[i][j] -= a[i][k] * scaled[k];
      a[i][j] /= a[j][j];
    }
  }
}

void solve(const std::array<Six, k_size>& factors, Six& x) {
  for (std::size_t i = 0; i < k_size; ++i) {
    for (std::size_t k = 0; k < i; ++k) x[i] -= factors[i][k] * x[k];
  }
  for (std::size_t i = k_size; i-- > 0;) {
    x[i] /= factors[i][i];
    for (std::size_t k = i + 1; k < k_size; ++k) x[i] -= factors[k][i] * x[k];
  }
}

std::array<Lanes, 4> product(const std::array<Lanes, 4>& a, const std::array<Lanes, 4>& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

void set_orientation(const std::array<Lanes, 4>& q, BodyLanes& body) {
  const Lanes scale = (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]).sqrt().inverse();
  const Lanes w = scale * q[0], x = scale * q[1], y = scale * q[2], z = scale * q[3];
  body.orientation = {w, x, y, z};
  body.x = {1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)};
  body.y = {2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)};
  body.z = {2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)};
}

void move(const Six& by, BodyLanes& body) {
  body.position = body.position + Lanes3{by[0], by[1], by[2]};
  const std::array<Lanes, 4> turn{1.0, 0.5 * by[3], 0.5 * by[4], 0.5 * by[5]};
  set_orientation(product(turn, body.orientation), body);
}

/// The balance of the connectors as they are; a floor under the stiffness, far below any rubber's, stands for bushings
/// that are within their play.
Balance balance_of(const RubberStep& step, const BodyLanes& link, const BodyLanes& next, DoublePinRows rows,
                   const DoublePinJoints& joints) {
  constexpr double k_floor = 1e3, k_angular_floor = 1.0;  // N/m, N m/rad
  Balance balance;
  for (std::size_t i = 0; i < k_size; ++i) {
    balance.stiffness[i].fill(0.0);
    balance.stiffness[i][i] = i < 3 ? k_floor : k_angular_floor;
  }
  balance.wrench.fill(0.0);
  balance.wrench_rate.fill(0.0);
  const Lanes3 &v = joints.connector.velocity, &w = joints.connector.angular_velocity;
  const Six motion{v.x, v.y, v.z, w.x, w.y, w.z};
  add_bushing(link, joints.connector, joints.front, slipping_tangent(step, joints.front.rubber, rows.front), motion,
              balance);
  add_bushing(half_turned(next), half_turned(joints.connector), joints.rear,
              slipping_tangent(step, joints.rear.rubber, rows.rear), motion, balance);
  return balance;
}

/// Largest component of every joint's correction, in tolerances.
Lanes size_of(const Six& correction) {
  Lanes largest = 0.0;
  for (std::size_t i = 0; i < k_size; ++i) {
    largest = largest.max(correction[i].abs() / (i < 3 ? k_position_tolerance : k_angle_tolerance));
  }
  return largest;
}

PinBushings evaluate_bushing(const RubberStep& step, const BodyLanes& shoe, const BodyLanes& connector, int row) {
  PinBushings bushing;
  bushing.kinematics = element_kinematics(shoe, connector, {step.track.groove, -0.5 * step.track.connector_length});
  bushing.rubber = rubber_load(step, bushing.kinematics, row);
  bushing.wrench = element_wrench(shoe, connector, bushing.kinematics, bushing.rubber.force);
  return bushing;
}

}  // namespace

BodyLanes connectors_in_line(const CompiledTrack& track, const BodyLanes& link, const BodyLanes& next) {
  const Lanes3 to_bore = track.groove * link.x, to_next_bore = -track.groove * next.x;
  const Lanes3 bore = link.position + to_bore, next_bore = next.position + to_next_bore;
  BodyLanes connector;
  connector.position = 0.5 * (bore + next_bore);
  connector.velocity = 0.5 * (link.velocity + cross(link.angular_velocity, to_bore) + next.velocity +
                              cross(next.angular_velocity, to_next_bore));
  connector.angular_velocity = 0.5 * (link.angular_velocity + next.angular_velocity);

  const auto &p = link.orientation, &q = next.orientation;
  const Lanes cosine = p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3];
  const Lanes sign = choose(cosine < 0.0, -1.0, 1.0);
  set_orientation({p[0] + sign * q[0], p[1] + sign * q[1], p[2] + sign * q[2], p[3] + sign * q[3]}, connector);
  // The turn about the half-way y axis that brings x into line with the bores.
  const Lanes3 line = next_bore - bore;
  const Lanes along = dot(connector.x, line), above = dot(connector.z, line);
  // The floors change no joint that is one: they keep lanes behind a track's last joint, all zeros, free of 0 / 0.
  constexpr double k_least_length = 1e-9 /* m */, k_least_cosine = 1e-9;
  const Lanes length = (along * along + above * above).sqrt().max(k_least_length);
  const Lanes cos_half = (0.5 * (1.0 + along / length)).sqrt().max(k_least_cosine);
  const Lanes sin_half = -0.5 * above / (length * cos_half);
  set_orientation(product(connector.orientation, {cos_half, 0.0, sin_half, 0.0}), connector);
  return connector;
}

void evaluate_bushings(const RubberStep& step, const BodyLanes& link, const BodyLanes& next, DoublePinRows rows,
                       DoublePinJoints& joints) {
  joints.front = evaluate_bushing(step, link, joints.connector, rows.front);
  joints.rear = evaluate_bushing(step, half_turned(next), half_turned(joints.connector), rows.rear);
}

DoublePinJoints balance_connectors(const RubberStep& step, const BodyLanes& link, const BodyLanes& next,
                                   DoublePinRows rows, int valid) {
  DoublePinJoints joints;
  joints.connector = connectors_in_line(step.track, link, next);
  evaluate_bushings(step, link, next, rows, joints);
  for (int corrections = 0;; ++corrections) {
    Balance balance = balance_of(step, link, next, rows, joints);
    factorise(balance.stiffness);
    solve(balance.stiffness, balance.wrench);
    const Lanes off = size_of(balance.wrench);
    if (corrections > 0 && bits_of((off <= 1.0) | !LaneMask::first(valid)) == k_all_lanes) return joints;
    if (corrections == k_most_corrections) {
      constexpr double k_none = std::numeric_limits<double>::quiet_NaN();
      joints.front.wrench.force.x = choose(off <= 1.0, joints.front.wrench.force.x, k_none);
      return joints;
    }
    if (corrections >= k_whole_corrections) {
      for (Lanes& component : balance.wrench) component *= 0.5;
    }
    solve(balance.stiffness, balance.wrench_rate);
    const Six& motion = balance.wrench_rate;
    joints.connector.velocity = {motion[0], motion[1], motion[2]};
    joints.connector.angular_velocity = {motion[3], motion[4], motion[5]};
    move(balance.wrench, joints.connector);
    evaluate_bushings(step, link, next, rows, joints);
  }
}

}  // namespace grouser
