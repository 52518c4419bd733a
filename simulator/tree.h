#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <span>
#include <string>
#include <vector>

#include "model/geometry.h"
#include "simulator/spatial_lanes.h"

/// The chassis subsystem: a base body (floating or fixed) and a tree of revolute joints in relative coordinates.
/// Paper eqs. (1)-(5): q' = B qi', B^T M B qi'' = B^T (Q - M B' qi'), solved by the articulated-body recursion
/// (Featherstone, Rigid Body Dynamics Algorithms, 2008, table 7.1), O(bodies). With S the axis of a joint, c = v x S q'
/// its bias, tau its torque, I the inertia of a body and f the force on it, from the leaves to the base
///   I^A = I + sum of the children's I^a,   p^A = v x* I v - f + sum of the children's p^a,
///   U = I^A S,   D = S . U,   u = tau - S . p^A,   I^a = I^A - U U^T / D,   p^a = p^A + I^a c + U u / D,
/// and from the base, whose a = -(I^A)^-1 p^A, to the leaves, with a' = c + a of the parent,
///   q'' = (u - U . a') / D,   a = a' + S q''.
/// Where q'' is given, 1 / D is taken as 0 and c as c + S q''; then tau = S . (I^A a + p^A).
/// Spatial vectors are (moment or angular; force or linear), world-aligned, about the base's centre of mass at the
/// instant, so that no frame is changed along the tree.
namespace grouser {

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

/// Eight bodies of a tree, constant. The one in lane k hangs on the one in lane k of the parent block, so that what
/// goes along the tree stays in its lane; blocks on the base hold bodies of one mirror group.
struct TreeBlock {
  int parent = -1;  ///< block; -1 is the base
  int mirror_group = 0;
  bool bears = false;               ///< other blocks hang on it
  bool about_y = true;              ///< every joint turns about y, as most of a vehicle do
  bool prescribes = false;          ///< holds a joint of given motion
  std::array<int, k_lanes> body{};  ///< tree bodies; in a lane not in use, which has no mass, one of the others
  Lanes free = 0.0;                 ///< 1 for a joint that moves by its forces, else 0
  Lanes3 axis{0.0, 0.0, 0.0}, origin{0.0, 0.0, 0.0}, center_of_mass{0.0, 0.0, 0.0};  ///< as in TreeBody
  Lanes mass = 0.0;
  LaneTensor inertia{{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
};

/// Where a body stands among the blocks.
struct TreePlace {
  std::size_t block;
  int lane;
};

/// A block's frames: all that the bodies hanging on it need for theirs.
struct BlockFrame {
  LaneMatrix rotation;  ///< body -> W
  Lanes3 origin_W;      ///< joint position less the base's centre of mass, W [m]
  LaneSpatial velocity;
};

/// I^A and p^A of bodies with all that they carry, or I^a and p^a: what they put on the bodies that they hang on.
struct ArticulatedLoad {
  LaneInertia inertia;
  LaneSpatial bias;
};

/// A block at one state.
struct BlockState {
  // by place_tree
  BlockFrame frame;
  Lanes3 center_W;     ///< centre of mass less the base's centre of mass, W [m]
  LaneSpatial axis_W;  ///< S
  LaneSpatial bias;    ///< c
  // by whoever pushes on the bodies; gravity alone by place_tree
  LaneSpatial force;
  // by tree_accelerations
  ArticulatedLoad borne;         ///< sums of I^a and p^a of the blocks that hang on it; only where there are any
  LaneSpatial projected;         ///< U
  Lanes compliance, axis_force;  ///< 1 / D, u
  LaneSpatial acceleration;
  Lanes joint_acceleration;  ///< q''
};

/// Overwritten by every evaluation, but for what make_workspace fills.
struct TreeWorkspace {
  std::vector<TreeBlock> blocks;  ///< parents before children, constant, by make_workspace
  std::vector<TreePlace> place;   ///< of every body, constant, by make_workspace
  std::vector<BlockState> states;
  // by place_tree
  Matrix3d base_rotation;  ///< base -> W
  Vector3d base_angular_velocity_W;
  // by whoever pushes on the bodies; zeroed by place_tree
  Vector6d base_force;           ///< spatial force on the base
  Eigen::VectorXd joint_torque;  ///< applied along each axis by springs and dampers [N m]; prescribed: by
                                 ///< tree_accelerations
  // by tree_accelerations
  double kinetic_energy = 0.0;  ///< J, whole tree

  [[nodiscard]] Matrix3d rotation(int body) const;            ///< body -> W
  [[nodiscard]] Vector3d origin_W(int body) const;            ///< joint position less the base's centre of mass [m]
  [[nodiscard]] Vector3d center_W(int body) const;            ///< centre of mass less the base's centre of mass [m]
  [[nodiscard]] Vector3d angular_velocity_W(int body) const;  ///< rad/s
  [[nodiscard]] Vector6d velocity(int body) const;            ///< spatial
  [[nodiscard]] Vector6d axis_W(int body) const;              ///< spatial joint axis
  [[nodiscard]] Vector6d force(int body) const;               ///< spatial
  /// Velocity in W of the point of a body that stands at `point` (less the base's centre of mass).
  [[nodiscard]] Vector3d velocity_at(int body, const Vector3d& point) const;
  /// A body's frame in all lanes.
  [[nodiscard]] BlockFrame spread_frame(int body) const;
  /// Adds forces, each the sum over its lanes, and their moments about the base's centre of mass to a body.
  void add_force(int body, const LaneSpatial& force_W);

 private:
  [[nodiscard]] const BlockState& state_of(int body) const;
  [[nodiscard]] int lane_of(int body) const { return place[static_cast<std::size_t>(body)].lane; }
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

inline const BlockState& TreeWorkspace::state_of(int body) const {
  return states[place[static_cast<std::size_t>(body)].block];
}
inline Matrix3d TreeWorkspace::rotation(int body) const {
  const LaneMatrix& R = state_of(body).frame.rotation;
  Matrix3d rotation;
  rotation << in_lane(lane_of(body), R.x), in_lane(lane_of(body), R.y), in_lane(lane_of(body), R.z);
  return rotation;
}
inline Vector3d TreeWorkspace::origin_W(int body) const {
  return in_lane(lane_of(body), state_of(body).frame.origin_W);
}
inline Vector3d TreeWorkspace::center_W(int body) const { return in_lane(lane_of(body), state_of(body).center_W); }
inline Vector3d TreeWorkspace::angular_velocity_W(int body) const { return velocity(body).head<3>(); }
inline Vector6d TreeWorkspace::velocity(int body) const {
  return in_lane(lane_of(body), state_of(body).frame.velocity);
}
inline Vector6d TreeWorkspace::axis_W(int body) const { return in_lane(lane_of(body), state_of(body).axis_W); }
inline Vector6d TreeWorkspace::force(int body) const { return in_lane(lane_of(body), state_of(body).force); }
inline Vector3d TreeWorkspace::velocity_at(int body, const Vector3d& point) const {
  const Vector6d v = velocity(body);
  return v.tail<3>() + v.head<3>().cross(point);
}
inline BlockFrame TreeWorkspace::spread_frame(int body) const {
  const auto& [R, origin, velocity] = state_of(body).frame;
  const int lane = lane_of(body);
  return {{spread(lane, R.x), spread(lane, R.y), spread(lane, R.z)},
          spread(lane, origin),
          {spread(lane, velocity.angular), spread(lane, velocity.linear)}};
}
inline void TreeWorkspace::add_force(int body, const LaneSpatial& force_W) {
  const auto [block, lane] = place[static_cast<std::size_t>(body)];
  LaneSpatial& force = states[block].force;
  add_sums_in_lane(lane, force_W.angular, force.angular);
  add_sums_in_lane(lane, force_W.linear, force.linear);
}

}  // namespace grouser
