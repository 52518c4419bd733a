#include "simulator/tree.h"

#include "simulator/lane_trigonometry.h"

namespace grouser {
namespace {

/// R times the rotation about `axis` by an angle (Rodrigues); axis_W = R axis.
LaneMatrix turned(const LaneMatrix& R, const Lanes3& axis, const Lanes3& axis_W, const SineCosine& of_angle) {
  const auto& [s, c] = of_angle;
  const Lanes3 along = (1.0 - c) * axis_W, across = s * axis;
  return {c * R.x + across.z * R.y - across.y * R.z + axis.x * along,
          c * R.y + across.x * R.z - across.z * R.x + axis.y * along,
          c * R.z + across.y * R.x - across.x * R.y + axis.z * along};
}

/// The same about y.
LaneMatrix turned_about_y(const LaneMatrix& R, const SineCosine& of_angle) {
  const auto& [s, c] = of_angle;
  return {c * R.x - s * R.z, R.y, s * R.x + c * R.z};
}

/// What place_tree finds for one block.
void place_block(const TreeBlock& block, const BlockFrame& parent, const Lanes& angle, const Lanes& rate,
                 const Lanes3& gravity_W, BlockState& state) {
  const LaneMatrix R_WP = parent.rotation;
  const Lanes3 axis = block.about_y ? R_WP.y : R_WP * block.axis, origin = parent.origin_W + R_WP * block.origin;
  const SineCosine turn = sine_cosine(angle);
  const LaneMatrix rotation = block.about_y ? turned_about_y(R_WP, turn) : turned(R_WP, block.axis, axis, turn);
  const Lanes3 center = origin + rotation * block.center_of_mass, weight = block.mass * gravity_W;
  const LaneSpatial axis_W{axis, cross(origin, axis)}, joint_velocity = rate * axis_W,
                                                       velocity = parent.velocity + joint_velocity;
  state.frame = {rotation, origin, velocity};
  state.center_W = center;
  state.axis_W = axis_W;
  state.bias = cross_motion(velocity, joint_velocity);
  state.force = {cross(center, weight), weight};
}

/// A block's bodies by themselves: I = [J - m c~ c~, m c~; -m c~, m 1] and v x* I v - f. Adds to `energy`.
void rigid_bodies(const TreeBlock& block, const BlockState& state, ArticulatedLoad& load, Lanes& energy) {
  const Lanes3 c = state.center_W, mc = block.mass * c;
  const Lanes xx = mc.x * c.x, yy = mc.y * c.y, zz = mc.z * c.z, zero = 0.0;
  LaneTensor about_base = turned(state.frame.rotation, block.inertia);
  about_base += {{yy + zz, zz + xx, xx + yy}, {-mc.y * c.z, -mc.x * c.z, -mc.x * c.y}};
  const LaneSpatial velocity = state.frame.velocity;
  const Lanes3 v = velocity.linear, w = velocity.angular;
  const LaneSpatial momentum{about_base * w + cross(mc, v), block.mass * v + cross(w, mc)};
  energy += 0.5 * dot(velocity, momentum);
  load.inertia.rotation = about_base;
  load.inertia.coupling = {{zero, mc.z, -mc.y}, {-mc.z, zero, mc.x}, {mc.y, -mc.x, zero}};
  load.inertia.translation = {{block.mass, block.mass, block.mass}, {zero, zero, zero}};
  load.bias = cross_force(velocity, momentum) - state.force;
}

/// Adds what a block and those that it bears put on what it hangs on: I^a and p^a. `given` is S q'' of prescribed
/// joints.
void fold(const TreeBlock& block, const ArticulatedLoad& own, const Lanes& torque, const LaneSpatial& given,
          BlockState& state, ArticulatedLoad& parent) {
  const LaneSpatial axis = state.axis_W, projected = own.inertia * axis;
  // A joint of given motion yields nothing; 1 in place of the 0 of a lane without a body keeps the quotient finite.
  const Lanes compliance = block.free / (dot(axis, projected) + (1.0 - block.free));
  const Lanes axis_force = torque - dot(axis, own.bias);
  const LaneSpatial yielding = compliance * projected;
  state.projected = projected;
  state.compliance = compliance;
  state.axis_force = axis_force;
  const LaneInertia left = less_product(own.inertia, yielding, projected);
  parent.bias = parent.bias + (own.bias + left * (state.bias + given) + axis_force * yielding);
  parent.inertia += left;
}

/// Prescribed accelerations of a block's joints, 0 for those that are free.
Lanes given_motion(const TreeBlock& block, std::span<const double> prescribed_acceleration) {
  if (!block.prescribes) return 0.0;
  return choose(0.5 < block.free, 0.0, gather(prescribed_acceleration.data(), block.body));
}

/// By stores of lanes: for a value so large the compiler would call memset, which takes longer.
void clear(ArticulatedLoad& load) {
  const Lanes3 none{0.0, 0.0, 0.0};
  auto& [rotation, coupling, translation] = load.inertia;
  coupling = {none, none, none};
  rotation = translation = {none, none};
  load.bias = {none, none};
}

using BaseLoads = std::array<ArticulatedLoad, 2>;  ///< of the base's children, by mirror group

/// From the leaves to the base: what each body and those it carries put on its parent. Adds to `energy`.
BaseLoads fold_to_base(std::span<const double> prescribed_acceleration, TreeWorkspace& work, Lanes& energy) {
  BaseLoads base;
  for (ArticulatedLoad& load : base) clear(load);
  for (std::size_t b = 0; b < work.blocks.size(); ++b) {
    if (work.blocks[b].bears) clear(work.states[b].borne);
  }
  for (std::size_t b = work.blocks.size(); b-- > 0;) {
    const TreeBlock& block = work.blocks[b];
    BlockState& state = work.states[b];
    ArticulatedLoad own;
    rigid_bodies(block, state, own, energy);
    if (block.bears) {
      own.inertia += state.borne.inertia;
      own.bias = own.bias + state.borne.bias;
    }
    const LaneSpatial given = given_motion(block, prescribed_acceleration) * state.axis_W;
    ArticulatedLoad& parent = block.parent < 0 ? base[static_cast<std::size_t>(block.mirror_group)]
                                               : work.states[static_cast<std::size_t>(block.parent)].borne;
    fold(block, own, gather(work.joint_torque.data(), block.body), given, state, parent);
  }
  return base;
}

using Matrix6d = Eigen::Matrix<double, 6, 6>;
struct BaseEquation {
  Matrix6d inertia;
  Vector6d bias;
};

/// A group's load summed over lanes: rotation and moment (x, y); coupling but for zz; translation, zz, moment z; force.
std::array<Lanes, 4> sums_of_lanes(const ArticulatedLoad& load) {
  const auto& [rotation, coupling, translation] = load.inertia;
  const auto& [d, b] = rotation;
  const auto& [x, y, z] = coupling;
  const auto& [e, f] = translation;
  const auto& [moment, force] = load.bias;
  return {grouser::sums_of_lanes({d.x, d.y, d.z, b.x, b.y, b.z, moment.x, moment.y}),
          grouser::sums_of_lanes({x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y}),
          grouser::sums_of_lanes({e.x, e.y, e.z, f.x, f.y, f.z, z.z, moment.z}),
          grouser::sums_of_lanes({force.x, force.y, force.z, 0.0, 0.0, 0.0, 0.0, 0.0})};
}

/// Both groups summed over lanes, then together.
BaseEquation sum_of_groups(const BaseLoads& groups) {
  const std::array<Lanes, 4> left = sums_of_lanes(groups[0]), right = sums_of_lanes(groups[1]);
  const Lanes r = left[0] + right[0], c = left[1] + right[1], t = left[2] + right[2], f = left[3] + right[3];
  BaseEquation sum;
  sum.inertia << r[0], r[5], r[4], c[0], c[3], c[6],  //
      r[5], r[1], r[3], c[1], c[4], c[7],             //
      r[4], r[3], r[2], c[2], c[5], t[6],             //
      c[0], c[1], c[2], t[0], t[5], t[4],             //
      c[3], c[4], c[5], t[5], t[1], t[3],             //
      c[6], c[7], t[6], t[4], t[3], t[2];
  sum.bias << r[6], r[7], t[7], f[0], f[1], f[2];
  return sum;
}

/// x of A x = b for a positive definite A = L D L^T, its pivots taken as they come, so that zeros that symmetry puts
/// into A and b stay zeros.
Vector6d solve(Matrix6d A, Vector6d x) {
  Vector6d inverse;
  for (int k = 0; k < 6; ++k) {
    inverse[k] = 1.0 / A(k, k);
    for (int i = k + 1; i < 6; ++i) {
      const double factor = A(i, k) * inverse[k];
      for (int j = i; j < 6; ++j) A(j, i) -= factor * A(j, k);
      x[i] -= factor * x[k];
    }
  }
  for (int k = 5; k >= 0; --k) {
    for (int i = k + 1; i < 6; ++i) x[k] -= A(i, k) * x[i];
    x[k] *= inverse[k];
  }
  return x;
}

/// Spatial acceleration of the base; its parts go to `acceleration`.
Vector6d accelerate_base(const Tree& tree, const TreeState& state, const BaseLoads& children, TreeWorkspace& work,
                         TreeAcceleration& acceleration) {
  const Matrix3d &R = work.base_rotation, inertia = R * tree.base_inertia * R.transpose();
  const Vector3d &w = work.base_angular_velocity_W, angular_momentum = inertia * w;
  work.kinetic_energy += 0.5 * (w.dot(angular_momentum) + tree.base_mass * state.velocity.squaredNorm());
  acceleration.linear.setZero();
  acceleration.angular.setZero();
  if (tree.base_fixed) return Vector6d::Zero();
  auto [total, bias] = sum_of_groups(children);
  total.topLeftCorner<3, 3>() += inertia;
  total.diagonal().tail<3>().array() += tree.base_mass;
  bias.head<3>() += w.cross(angular_momentum);
  bias.tail<3>() += tree.base_mass * w.cross(state.velocity);
  const Vector6d spatial = solve(total, work.base_force - bias);
  // The spatial acceleration's linear part is that of the point fixed in space; the centre of mass moves through it.
  acceleration.linear = spatial.tail<3>() + w.cross(state.velocity);
  acceleration.angular = R.transpose() * spatial.head<3>();
  return spatial;
}

/// From the base to the leaves: joint accelerations, torques of prescribed joints.
void unfold(std::span<const double> prescribed_acceleration, const Vector6d& base_acceleration, TreeWorkspace& work,
            TreeAcceleration& acceleration) {
  const LaneSpatial base{in_all_lanes(base_acceleration.head<3>()), in_all_lanes(base_acceleration.tail<3>())};
  for (std::size_t b = 0; b < work.blocks.size(); ++b) {
    const TreeBlock& block = work.blocks[b];
    BlockState& state = work.states[b];
    const LaneSpatial& parent =
        block.parent < 0 ? base : work.states[static_cast<std::size_t>(block.parent)].acceleration;
    const LaneSpatial carried = parent + state.bias;
    state.joint_acceleration = (state.axis_force - dot(state.projected, carried)) * state.compliance +
                               given_motion(block, prescribed_acceleration);
    state.acceleration = carried + state.joint_acceleration * state.axis_W;
    if (!block.prescribes) continue;
    // S . p^A is what u lacks of the torque that was put in.
    const Lanes torque =
        dot(state.projected, state.acceleration) + gather(work.joint_torque.data(), block.body) - state.axis_force;
    for (int lane = 0; lane < k_lanes; ++lane) {
      const int body = block.body[static_cast<std::size_t>(lane)];
      if (block.free[lane] == 0.0 && lane == work.place[static_cast<std::size_t>(body)].lane) {
        work.joint_torque[body] = torque[lane];
      }
    }
  }
  for (std::size_t i = 0; i < work.place.size(); ++i) {
    const auto [block, lane] = work.place[i];
    acceleration.joint[static_cast<Eigen::Index>(i)] = work.states[block].joint_acceleration[lane];
  }
}

}  // namespace

TreeState make_state(const Tree& tree) {
  TreeState state;
  state.angle = state.rate = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(tree.bodies.size()));
  return state;
}

void place_tree(const Tree& tree, const TreeState& state, const Vector3d& gravity_W, TreeWorkspace& work) {
  const Matrix3d R = state.orientation.toRotationMatrix();
  work.base_rotation = R;
  work.base_angular_velocity_W = R * state.angular_velocity;
  work.base_force << Vector3d::Zero(), tree.base_mass * gravity_W;
  work.joint_torque.setZero();
  const BlockFrame base{{in_all_lanes(R.col(0)), in_all_lanes(R.col(1)), in_all_lanes(R.col(2))},
                        in_all_lanes(Vector3d::Zero()),
                        {in_all_lanes(work.base_angular_velocity_W), in_all_lanes(state.velocity)}};
  const Lanes3 gravity = in_all_lanes(gravity_W);
  for (std::size_t b = 0; b < work.blocks.size(); ++b) {
    const TreeBlock& block = work.blocks[b];
    const BlockFrame& parent = block.parent < 0 ? base : work.states[static_cast<std::size_t>(block.parent)].frame;
    place_block(block, parent, gather(state.angle.data(), block.body), gather(state.rate.data(), block.body), gravity,
                work.states[b]);
  }
}

void tree_accelerations(const Tree& tree, const TreeState& state, std::span<const double> prescribed_acceleration,
                        TreeWorkspace& work, TreeAcceleration& acceleration) {
  Lanes energy = 0.0;
  const BaseLoads children = fold_to_base(prescribed_acceleration, work, energy);
  work.kinetic_energy = energy.sum();
  const Vector6d base_acceleration = accelerate_base(tree, state, children, work, acceleration);
  unfold(prescribed_acceleration, base_acceleration, work, acceleration);
}

double gravity_energy(const Tree& tree, const TreeState& state, const Vector3d& gravity_W, const TreeWorkspace& work) {
  const Lanes3 gravity = in_all_lanes(gravity_W);
  const Lanes of_base = gravity_W.dot(state.position);
  Lanes work_done = 0.0;
  for (std::size_t b = 0; b < work.blocks.size(); ++b) {
    work_done += work.blocks[b].mass * (of_base + dot(gravity, work.states[b].center_W));
  }
  return -tree.base_mass * of_base[0] - work_done.sum();
}

Vector6d joint_reaction(const TreeWorkspace& work, int body) {
  // Newton and Euler for the body and all that it carries: I a + v x* I v - f.
  std::vector<LaneSpatial> force(work.blocks.size(), LaneSpatial{});
  for (std::size_t b = work.blocks.size(); b-- > 0;) {
    Lanes energy = 0.0;
    ArticulatedLoad own;
    rigid_bodies(work.blocks[b], work.states[b], own, energy);
    force[b] = force[b] + own.inertia * work.states[b].acceleration + own.bias;
    if (work.blocks[b].parent < 0) continue;
    LaneSpatial& on_parent = force[static_cast<std::size_t>(work.blocks[b].parent)];
    on_parent = on_parent + force[b];
  }
  const auto [block, lane] = work.place[static_cast<std::size_t>(body)];
  Vector6d reaction = in_lane(lane, force[block]);
  reaction.head<3>() -= work.origin_W(body).cross(reaction.tail<3>());
  return reaction;
}

}  // namespace grouser
