#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>
#include <string>
#include <vector>

#include "model/geometry.h"

/// The chassis subsystem: a base body (floating or fixed) and a tree of revolute joints in relative coordinates.
/// Paper eqs. (1)-(5): q' = B qi', B^T M B qi'' = B^T (Q - M B' qi'), solved by the articulated-body recursion
/// (Featherstone 1983), O(bodies). Spatial vectors are (moment or angular; force or linear), world-aligned, about the
/// base's centre of mass at the instant, so that no frame is changed along the tree.
namespace grouser {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
/// Spatial vectors and matrices with two rows of zeros below, so that a column fills the machine's vectors.
using PaddedVector = Eigen::Matrix<double, 8, 1>;
using PaddedMatrix = Eigen::Matrix<double, 8, 6>;

/// One revolute body. Its frame B has its origin on the joint axis and is parallel to the parent's frame P at angle 0.
struct TreeBody {
  std::string name;
  int parent = -1;                     ///< index of the parent body; -1 is the base
  Vector3d axis = Vector3d::UnitY();   ///< joint axis in P (and B), unit
  Vector3d origin = Vector3d::Zero();  ///< joint position in P [m]; for the base P has its origin at the centre of mass
  double mass = 0.0;                   ///< kg
  Vector3d center_of_mass = Vector3d::Zero();  ///< in B [m]
  Matrix3d inertia = Matrix3d::Zero();         ///< about the centre of mass, in B [kg m^2]
  /// 0 or 1. What the base's children put on it is summed by group, then together: a vehicle that is its own mirror
  /// image (left bodies in one group, right ones in the other, in the same order) then moves exactly so, free of
  /// round-off.
  int mirror_group = 0;
  bool prescribed = false;  ///< motion given; its torque is a result
};

/// Constant description; parents come before their children.
struct Tree {
  double base_mass = 0.0;                    ///< kg
  Matrix3d base_inertia = Matrix3d::Zero();  ///< about the base's centre of mass, base frame
  bool base_fixed = false;
  std::vector<TreeBody> bodies;
};

/// Base: position of its centre of mass in W, orientation base -> W, velocity in W, angular velocity in the base frame.
struct TreeState {
  Vector3d position = Vector3d::Zero();
  Quaterniond orientation = Quaterniond::Identity();
  Vector3d velocity = Vector3d::Zero();
  Vector3d angular_velocity = Vector3d::Zero();
  Eigen::VectorXd angle, rate;  ///< joints [rad, rad/s]
};

struct TreeAcceleration {
  Vector3d linear = Vector3d::Zero();   ///< of the base's centre of mass, W [m/s^2]
  Vector3d angular = Vector3d::Zero();  ///< base frame [rad/s^2]
  Eigen::VectorXd joint;                ///< rad/s^2
};

/// Overwritten by every evaluation.
struct TreeWorkspace {
  // by place_tree
  Matrix3d base_rotation;  ///< base -> W
  Vector3d base_angular_velocity_W;
  std::vector<double> sine, cosine;          ///< of the joint angles, padded to whole lanes
  std::vector<Matrix3d> rotation;            ///< body -> W
  std::vector<Vector3d> origin_W;            ///< joint position less the base's centre of mass, W [m]
  std::vector<Vector3d> center_W;            ///< centre of mass less the base's centre of mass, W [m]
  std::vector<Vector3d> angular_velocity_W;  ///< rad/s
  std::vector<Vector6d> velocity;            ///< spatial
  std::vector<Vector6d> axis_W;              ///< spatial joint axes
  std::vector<Vector6d> bias;                ///< velocity-product acceleration across the joint
  // by whoever pushes on the bodies; zeroed by place_tree
  Vector6d base_force;          ///< spatial force on the base
  std::vector<Vector6d> force;  ///< spatial force on each body
  Eigen::VectorXd
      joint_torque;  ///< applied along each axis by springs and dampers [N m]; prescribed: by tree_accelerations
  // by tree_accelerations
  std::vector<PaddedMatrix> articulated;
  std::vector<PaddedVector> articulated_bias, projected;
  std::vector<Vector6d> acceleration;
  std::vector<double> axis_inertia, axis_force;
  double kinetic_energy = 0.0;  ///< J, whole tree

  /// Velocity in W of the point of body i that stands at `point` (less the base's centre of mass).
  [[nodiscard]] Vector3d velocity_at(int i, const Vector3d& point) const {
    const Vector6d& v = velocity[static_cast<std::size_t>(i)];
    return v.tail<3>() + v.head<3>().cross(point);
  }
  /// Adds force f_W at `point` (less the base's centre of mass) to body i.
  void add_force(int i, const Vector3d& point, const Vector3d& f_W) {
    Vector6d& f = force[static_cast<std::size_t>(i)];
    f.head<3>() += point.cross(f_W);
    f.tail<3>() += f_W;
  }
};

[[nodiscard]] TreeWorkspace make_workspace(const Tree& tree);
[[nodiscard]] TreeState make_state(const Tree& tree);

/// Poses and velocities of all bodies; sets forces to gravity alone and joint torques to zero.
void place_tree(const Tree& tree, const TreeState& state, const Vector3d& gravity_W, TreeWorkspace& work);

/// Accelerations from the forces in `work`. prescribed_acceleration: one value a body, read for prescribed joints only.
void tree_accelerations(const Tree& tree, const TreeState& state, std::span<const double> prescribed_acceleration,
                        TreeWorkspace& work, TreeAcceleration& acceleration);

/// Potential energy of gravity, zero at the world origin [J].
[[nodiscard]] double gravity_energy(const Tree& tree, const TreeState& state, const Vector3d& gravity_W,
                                    const TreeWorkspace& work);

/// Force and moment that the parent puts on body i at its joint, in W, moment about the joint origin [N m, N].
/// Valid after tree_accelerations.
[[nodiscard]] Vector6d joint_reaction(const TreeWorkspace& work, int i);

}  // namespace grouser
