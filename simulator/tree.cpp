#include "simulator/tree.h"

#include <Eigen/Cholesky>
#include <array>

namespace grouser {
namespace {

/// Spatial inertia of a rigid body about the reference point, from its mass, centre c and rotational inertia about c
/// (all W).
Matrix6d spatial_inertia(double mass, const Vector3d& c, const Matrix3d& about_center) {
  const Matrix3d mc = mass * skew(c);
  Matrix6d inertia;
  inertia.topLeftCorner<3, 3>() = about_center - mc * skew(c);
  inertia.topRightCorner<3, 3>() = mc;
  inertia.bottomLeftCorner<3, 3>() = -mc;
  inertia.bottomRightCorner<3, 3>() = mass * Matrix3d::Identity();
  return inertia;
}

/// v x* (I v), the velocity-product force; returns kinetic energy through `energy`.
Vector6d velocity_product(const Matrix6d& inertia, const Vector6d& v, double& energy) {
  const Vector6d momentum = inertia * v;
  energy += 0.5 * v.dot(momentum);
  Vector6d force;
  force.head<3>() = v.head<3>().cross(momentum.head<3>()) + v.tail<3>().cross(momentum.tail<3>());
  force.tail<3>() = v.head<3>().cross(momentum.tail<3>());
  return force;
}

Matrix3d rotation_about(const Vector3d& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

}  // namespace

TreeWorkspace make_workspace(const Tree& tree) {
  const std::size_t n = tree.bodies.size();
  TreeWorkspace work;
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
  for (std::size_t i = 0; i < tree.bodies.size(); ++i) {
    const TreeBody& body = tree.bodies[i];
    const bool on_base = body.parent < 0;
    const auto p = static_cast<std::size_t>(on_base ? 0 : body.parent);
    const Matrix3d& R_WP = on_base ? work.base_rotation : work.rotation[p];
    const Vector6d& parent_velocity = on_base ? base_velocity : work.velocity[p];
    const double rate = state.rate[static_cast<Eigen::Index>(i)];

    work.origin_W[i] = R_WP * body.origin;
    if (!on_base) work.origin_W[i] += work.origin_W[p];
    work.rotation[i] = R_WP * rotation_about(body.axis, state.angle[static_cast<Eigen::Index>(i)]);
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

void tree_accelerations(const Tree& tree, const TreeState& state, std::span<const double> prescribed_acceleration,
                        TreeWorkspace& work, TreeAcceleration& acceleration) {
  const std::size_t n = tree.bodies.size();
  work.kinetic_energy = 0.0;
  Vector6d base_velocity;
  base_velocity << work.base_angular_velocity_W, state.velocity;
  Matrix6d base_inertia = spatial_inertia(tree.base_mass, Vector3d::Zero(),
                                          work.base_rotation * tree.base_inertia * work.base_rotation.transpose());
  Vector6d base_bias = velocity_product(base_inertia, base_velocity, work.kinetic_energy) - work.base_force;

  for (std::size_t i = 0; i < n; ++i) {
    const TreeBody& body = tree.bodies[i];
    const Matrix3d about_center = work.rotation[i] * body.inertia * work.rotation[i].transpose();
    work.articulated[i] = spatial_inertia(body.mass, work.center_W[i], about_center);
    work.articulated_bias[i] =
        velocity_product(work.articulated[i], work.velocity[i], work.kinetic_energy) - work.force[i];
  }
  std::array<Matrix6d, 2> group_inertia{Matrix6d::Zero(), Matrix6d::Zero()};
  std::array<Vector6d, 2> group_bias{Vector6d::Zero(), Vector6d::Zero()};
  for (std::size_t i = n; i-- > 0;) {
    const TreeBody& body = tree.bodies[i];
    const auto group = static_cast<std::size_t>(body.mirror_group);
    Matrix6d& parent_inertia =
        body.parent < 0 ? group_inertia[group] : work.articulated[static_cast<std::size_t>(body.parent)];
    Vector6d& parent_bias =
        body.parent < 0 ? group_bias[group] : work.articulated_bias[static_cast<std::size_t>(body.parent)];
    const Matrix6d& inertia = work.articulated[i];
    const Vector6d& axis = work.axis_W[i];
    if (body.prescribed) {
      const Vector6d known = work.bias[i] + axis * prescribed_acceleration[i];
      parent_inertia += inertia;
      parent_bias += work.articulated_bias[i] + inertia * known;
      continue;
    }
    Vector6d& projected = work.projected[i];
    projected.noalias() = inertia * axis;
    work.axis_inertia[i] = axis.dot(projected);
    work.axis_force[i] = work.joint_torque[static_cast<Eigen::Index>(i)] - axis.dot(work.articulated_bias[i]);
    const Matrix6d reduced = inertia - (projected / work.axis_inertia[i]) * projected.transpose();
    parent_inertia += reduced;
    parent_bias +=
        work.articulated_bias[i] + reduced * work.bias[i] + projected * (work.axis_force[i] / work.axis_inertia[i]);
  }
  base_inertia += group_inertia[0] + group_inertia[1];
  base_bias += group_bias[0] + group_bias[1];

  Vector6d base_acceleration = Vector6d::Zero();
  if (!tree.base_fixed) base_acceleration = -base_inertia.ldlt().solve(base_bias);
  for (std::size_t i = 0; i < n; ++i) {
    const TreeBody& body = tree.bodies[i];
    const Vector6d& parent =
        body.parent < 0 ? base_acceleration : work.acceleration[static_cast<std::size_t>(body.parent)];
    const Vector6d carried = parent + work.bias[i];
    const auto joint = static_cast<Eigen::Index>(i);
    if (body.prescribed) {
      acceleration.joint[joint] = prescribed_acceleration[i];
      work.acceleration[i] = carried + work.axis_W[i] * prescribed_acceleration[i];
      work.joint_torque[joint] =
          work.axis_W[i].dot(work.articulated[i] * work.acceleration[i] + work.articulated_bias[i]);
    } else {
      acceleration.joint[joint] = (work.axis_force[i] - work.projected[i].dot(carried)) / work.axis_inertia[i];
      work.acceleration[i] = carried + work.axis_W[i] * acceleration.joint[joint];
    }
  }
  // The spatial acceleration's linear part is that of the point fixed in space; the centre of mass moves through it.
  acceleration.linear = base_acceleration.tail<3>();
  if (!tree.base_fixed) acceleration.linear += work.base_angular_velocity_W.cross(state.velocity);
  acceleration.angular = work.base_rotation.transpose() * base_acceleration.head<3>();
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
  Vector6d reaction = work.articulated[body] * work.acceleration[body] + work.articulated_bias[body];
  reaction.head<3>() -= work.origin_W[body].cross(reaction.tail<3>());
  return reaction;
}

}  // namespace grouser
