#include "simulator/tree.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>

#include "simulator/lane_trigonometry.h"

namespace grouser {
namespace {

/// R A R^T for a symmetric A: six numbers.
Matrix3d turned_tensor(const Matrix3d& R, const Matrix3d& A) {
  const Matrix3d RA = R * A;
  Matrix3d result;
  for (int row = 0; row < 3; ++row) {
    for (int column = row; column < 3; ++column) {
      result(row, column) = result(column, row) = RA.row(row).dot(R.row(column));
    }
  }
  return result;
}

/// A rigid body in motion about the reference point: its mass, centre c and rotational inertia about c (all W).
struct RigidBody {
  double mass;
  const Vector3d& center;
  Matrix3d about_center;
};

/// [J - m c~ c~, m c~; -m c~, m 1]
void store_inertia(const RigidBody& body, PaddedMatrix& inertia) {
  const double m = body.mass;
  const Vector3d &c = body.center, mc = m * c;
  const Matrix3d& J = body.about_center;
  const double xx = mc.x() * c.x(), yy = mc.y() * c.y(), zz = mc.z() * c.z();
  const double xy = J(0, 1) - mc.x() * c.y(), xz = J(0, 2) - mc.x() * c.z(), yz = J(1, 2) - mc.y() * c.z();
  inertia.col(0) << J(0, 0) + yy + zz, xy, xz, 0.0, -mc.z(), mc.y(), 0.0, 0.0;
  inertia.col(1) << xy, J(1, 1) + zz + xx, yz, mc.z(), 0.0, -mc.x(), 0.0, 0.0;
  inertia.col(2) << xz, yz, J(2, 2) + xx + yy, -mc.y(), mc.x(), 0.0, 0.0, 0.0;
  inertia.col(3) << 0.0, mc.z(), -mc.y(), m, 0.0, 0.0, 0.0, 0.0;
  inertia.col(4) << -mc.z(), 0.0, mc.x(), 0.0, m, 0.0, 0.0, 0.0;
  inertia.col(5) << mc.y(), -mc.x(), 0.0, 0.0, 0.0, m, 0.0, 0.0;
}

/// v x* (I v) less the applied force: what the body's own motion asks for at no acceleration. Adds to `energy`.
PaddedVector velocity_product(const RigidBody& body, const Vector6d& velocity, const Vector6d& applied,
                              double& energy) {
  const Vector3d w = velocity.head<3>(), v = velocity.tail<3>();
  const Vector3d momentum = body.mass * (v + w.cross(body.center));
  const Vector3d angular = body.about_center * w + body.center.cross(momentum);
  energy += 0.5 * (w.dot(angular) + v.dot(momentum));
  PaddedVector force = PaddedVector::Zero();
  force.head<3>() = w.cross(angular) + v.cross(momentum) - applied.head<3>();
  force.segment<3>(3) = w.cross(momentum) - applied.tail<3>();
  return force;
}

/// R_WP times the rotation about `axis` by an angle of sine s and cosine c (Rodrigues).
Matrix3d turned(const Matrix3d& R_WP, const Vector3d& axis, double s, double c) {
  Matrix3d result;
  if (axis == Vector3d::UnitY()) {  // most joints of a vehicle
    result.col(0) = c * R_WP.col(0) - s * R_WP.col(2);
    result.col(1) = R_WP.col(1);
    result.col(2) = s * R_WP.col(0) + c * R_WP.col(2);
    return result;
  }
  const Matrix3d about_axis = c * Matrix3d::Identity() + s * skew(axis) + (1.0 - c) * axis * axis.transpose();
  return R_WP * about_axis;
}

void find_sines(const Eigen::VectorXd& angle, TreeWorkspace& work) {
  const auto n = static_cast<std::size_t>(angle.size());
  for (std::size_t first = 0; first < n; first += k_lanes) {
    Lanes x = 0.0;
    for (std::size_t i = first; i < std::min(n, first + k_lanes); ++i) {
      x.set(static_cast<int>(i - first), angle[static_cast<Eigen::Index>(i)]);
    }
    const SineCosine of = sine_cosine(x);
    store(&work.sine[first], of.sine);
    store(&work.cosine[first], of.cosine);
  }
}

}  // namespace

TreeWorkspace make_workspace(const Tree& tree) {
  const std::size_t n = tree.bodies.size();
  TreeWorkspace work;
  const std::size_t whole_lanes = (n + k_lanes - 1) / k_lanes * k_lanes;
  work.sine.resize(whole_lanes);
  work.cosine.resize(whole_lanes);
  work.rotation.resize(n);
  work.origin_W.resize(n);
  work.center_W.resize(n);
  work.angular_velocity_W.resize(n);
  work.velocity.resize(n);
  work.axis_W.resize(n);
  work.bias.resize(n);
  work.force.resize(n);
  work.joint_torque = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(n));
  work.articulated.resize(n);
  work.articulated_bias.resize(n);
  work.projected.resize(n);
  work.acceleration.resize(n);
  work.axis_inertia.resize(n);
  work.axis_force.resize(n);
  return work;
}

TreeState make_state(const Tree& tree) {
  TreeState state;
  state.angle = state.rate = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(tree.bodies.size()));
  return state;
}

void place_tree(const Tree& tree, const TreeState& state, const Vector3d& gravity_W, TreeWorkspace& work) {
  work.base_rotation = state.orientation.toRotationMatrix();
  work.base_angular_velocity_W = work.base_rotation * state.angular_velocity;
  Vector6d base_velocity;
  base_velocity << work.base_angular_velocity_W, state.velocity;
  work.base_force << Vector3d::Zero(), tree.base_mass * gravity_W;
  work.joint_torque.setZero();
  find_sines(state.angle, work);
  for (std::size_t i = 0; i < tree.bodies.size(); ++i) {
    const TreeBody& body = tree.bodies[i];
    const bool on_base = body.parent < 0;
    const auto p = static_cast<std::size_t>(on_base ? 0 : body.parent);
    const Matrix3d& R_WP = on_base ? work.base_rotation : work.rotation[p];
    const Vector6d& parent_velocity = on_base ? base_velocity : work.velocity[p];
    const double rate = state.rate[static_cast<Eigen::Index>(i)];

    work.origin_W[i] = R_WP * body.origin;
    if (!on_base) work.origin_W[i] += work.origin_W[p];
    work.rotation[i] = turned(R_WP, body.axis, work.sine[i], work.cosine[i]);
    work.center_W[i] = work.origin_W[i] + work.rotation[i] * body.center_of_mass;
    const Vector3d axis = R_WP * body.axis;
    work.axis_W[i] << axis, work.origin_W[i].cross(axis);
    const Vector6d joint_velocity = work.axis_W[i] * rate;
    work.velocity[i] = parent_velocity + joint_velocity;
    work.angular_velocity_W[i] = work.velocity[i].head<3>();
    const Vector3d w = work.velocity[i].head<3>(), v = work.velocity[i].tail<3>();
    work.bias[i].head<3>() = w.cross(joint_velocity.head<3>());
    work.bias[i].tail<3>() = v.cross(joint_velocity.head<3>()) + w.cross(joint_velocity.tail<3>());
    const Vector3d weight = body.mass * gravity_W;
    work.force[i] << work.center_W[i].cross(weight), weight;
  }
}

namespace {

/// Articulated inertia and bias force that the base's children put on it, by mirror group.
struct BaseLoad {
  std::array<PaddedMatrix, 2> inertia{PaddedMatrix::Zero(), PaddedMatrix::Zero()};
  std::array<PaddedVector, 2> bias{PaddedVector::Zero(), PaddedVector::Zero()};
};

/// From the leaves to the base: what each body and those it carries put on its parent.
BaseLoad fold_to_base(const Tree& tree, std::span<const double> prescribed_acceleration, TreeWorkspace& work) {
  BaseLoad base;
  for (std::size_t i = tree.bodies.size(); i-- > 0;) {
    const TreeBody& body = tree.bodies[i];
    const auto group = static_cast<std::size_t>(body.mirror_group), parent = static_cast<std::size_t>(body.parent);
    PaddedMatrix& parent_inertia = body.parent < 0 ? base.inertia[group] : work.articulated[parent];
    PaddedVector& parent_bias = body.parent < 0 ? base.bias[group] : work.articulated_bias[parent];
    const PaddedMatrix& inertia = work.articulated[i];
    const PaddedVector& bias = work.articulated_bias[i];
    const Vector6d& axis = work.axis_W[i];
    if (body.prescribed) {
      const Vector6d known = work.bias[i] + axis * prescribed_acceleration[i];
      parent_inertia += inertia;
      parent_bias += bias + inertia * known;
      continue;
    }
    PaddedVector& projected = work.projected[i];
    projected.noalias() = inertia * axis;
    work.axis_inertia[i] = axis.dot(projected.head<6>());
    work.axis_force[i] = work.joint_torque[static_cast<Eigen::Index>(i)] - axis.dot(bias.head<6>());
    const double compliance = 1.0 / work.axis_inertia[i];
    const PaddedVector yielding = projected * compliance;
    PaddedMatrix reduced;
    for (int c = 0; c < 6; ++c) reduced.col(c) = inertia.col(c) - yielding * projected[c];
    parent_inertia += reduced;
    parent_bias += bias + reduced * work.bias[i] + yielding * work.axis_force[i];
  }
  return base;
}

/// Spatial acceleration of the base; its parts go to `acceleration`.
Vector6d accelerate_base(const Tree& tree, const TreeState& state, const BaseLoad& children, TreeWorkspace& work,
                         TreeAcceleration& acceleration) {
  Vector6d velocity;
  velocity << work.base_angular_velocity_W, state.velocity;
  const Vector3d at_reference = Vector3d::Zero();
  const RigidBody rigid{tree.base_mass, at_reference, turned_tensor(work.base_rotation, tree.base_inertia)};
  PaddedMatrix own;
  store_inertia(rigid, own);
  const PaddedVector own_bias = velocity_product(rigid, velocity, work.base_force, work.kinetic_energy);
  Vector6d spatial = Vector6d::Zero();
  if (!tree.base_fixed) {
    const Matrix6d inertia = (own + (children.inertia[0] + children.inertia[1])).topRows<6>();
    const Vector6d bias = (own_bias + (children.bias[0] + children.bias[1])).head<6>();
    spatial = -inertia.ldlt().solve(bias);
  }
  // The spatial acceleration's linear part is that of the point fixed in space; the centre of mass moves through it.
  acceleration.linear = spatial.tail<3>();
  if (!tree.base_fixed) acceleration.linear += work.base_angular_velocity_W.cross(state.velocity);
  acceleration.angular = work.base_rotation.transpose() * spatial.head<3>();
  return spatial;
}

/// From the base to the leaves: joint accelerations, torques of prescribed joints.
void unfold(const Tree& tree, std::span<const double> prescribed_acceleration, const Vector6d& base_acceleration,
            TreeWorkspace& work, TreeAcceleration& acceleration) {
  for (std::size_t i = 0; i < tree.bodies.size(); ++i) {
    const TreeBody& body = tree.bodies[i];
    const Vector6d& parent =
        body.parent < 0 ? base_acceleration : work.acceleration[static_cast<std::size_t>(body.parent)];
    const Vector6d carried = parent + work.bias[i];
    const auto joint = static_cast<Eigen::Index>(i);
    if (body.prescribed) {
      acceleration.joint[joint] = prescribed_acceleration[i];
      work.acceleration[i] = carried + work.axis_W[i] * prescribed_acceleration[i];
      const PaddedVector force = work.articulated[i] * work.acceleration[i] + work.articulated_bias[i];
      work.joint_torque[joint] = work.axis_W[i].dot(force.head<6>());
    } else {
      acceleration.joint[joint] =
          (work.axis_force[i] - work.projected[i].head<6>().dot(carried)) / work.axis_inertia[i];
      work.acceleration[i] = carried + work.axis_W[i] * acceleration.joint[joint];
    }
  }
}

}  // namespace

void tree_accelerations(const Tree& tree, const TreeState& state, std::span<const double> prescribed_acceleration,
                        TreeWorkspace& work, TreeAcceleration& acceleration) {
  const std::size_t n = tree.bodies.size();
  work.kinetic_energy = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const TreeBody& body = tree.bodies[i];
    const RigidBody rigid{body.mass, work.center_W[i], turned_tensor(work.rotation[i], body.inertia)};
    store_inertia(rigid, work.articulated[i]);
    work.articulated_bias[i] = velocity_product(rigid, work.velocity[i], work.force[i], work.kinetic_energy);
  }
  const BaseLoad children = fold_to_base(tree, prescribed_acceleration, work);
  const Vector6d base_acceleration = accelerate_base(tree, state, children, work, acceleration);
  unfold(tree, prescribed_acceleration, base_acceleration, work, acceleration);
}

double gravity_energy(const Tree& tree, const TreeState& state, const Vector3d& gravity_W, const TreeWorkspace& work) {
  double energy = -tree.base_mass * gravity_W.dot(state.position);
  for (std::size_t i = 0; i < tree.bodies.size(); ++i) {
    energy -= tree.bodies[i].mass * gravity_W.dot(state.position + work.center_W[i]);
  }
  return energy;
}

Vector6d joint_reaction(const TreeWorkspace& work, int i) {
  const auto body = static_cast<std::size_t>(i);
  Vector6d reaction = (work.articulated[body] * work.acceleration[body] + work.articulated_bias[body]).head<6>();
  reaction.head<3>() -= work.origin_W[body].cross(reaction.tail<3>());
  return reaction;
}

}  // namespace grouser
