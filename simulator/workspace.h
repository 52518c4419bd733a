#pragma once
#include <array>
#include <limits>
#include <vector>

#include "model/bushing_law.h"
#include "simulator/spring_block.h"
#include "simulator/state.h"

namespace grouser {

/// Contact cases of the paper's section 5, counted at every evaluation that asks for it.
enum class ContactCase {
  one_disc_on_plate,
  two_discs_on_plate,
  one_disc_on_edge,
  two_discs_on_edge,
  guide_left_wall,
  guide_right_wall,
  guide_top,
  guide_none,
  sprocket_top,
  sprocket_flank_driving,
  sprocket_flank_braking,
  sprocket_side_left,
  sprocket_side_right,
  sprocket_base,
  ground_point
};
inline constexpr int k_num_contact_cases = 15;
inline constexpr std::array<const char*, k_num_contact_cases> k_contact_case_names{"one_disc_on_plate",
                                                                                   "two_discs_on_plate",
                                                                                   "one_disc_on_edge",
                                                                                   "two_discs_on_edge",
                                                                                   "guide_left_wall",
                                                                                   "guide_right_wall",
                                                                                   "guide_top",
                                                                                   "guide_none",
                                                                                   "sprocket_top",
                                                                                   "sprocket_flank_driving",
                                                                                   "sprocket_flank_braking",
                                                                                   "sprocket_side_left",
                                                                                   "sprocket_side_right",
                                                                                   "sprocket_base",
                                                                                   "ground_point"};

/// Energies and powers at one state. Losses of elements with memory are energies of the step that led here.
struct EnergyTerms {
  double kinetic = 0.0, gravity = 0.0, bushing = 0.0, suspension = 0.0, contact = 0.0;  ///< J
  double input_power = 0.0;                                                             ///< W, at the sprockets' joints
  double bushing_power = 0.0, contact_power = 0.0, friction_power = 0.0, ground_power = 0.0;  ///< W lost, >= 0
  double suspension_power = 0.0, tensioner_power = 0.0, assembly_power = 0.0;                 ///< W lost, >= 0
  double bushing_step_loss = 0.0, ground_step_loss = 0.0, contact_step_loss = 0.0;            ///< J lost in the step
  [[nodiscard]] double stored() const { return kinetic + gravity + bushing + suspension + contact; }
};

/// A part of the vehicle: a link, a body of the tree or, where both are -1, the chassis itself.
struct Part {
  int link = -1;  ///< link array index
  int body = -1;  ///< tree body
};

/// Slopes of the contacts on a wheel's rims, summed for the stability bound.
struct RimSums {
  double spin = 0.0, both = 0.0;  ///< friction on the wheel's spin, and between that and its centre [N s/m]
  double damping = 0.0;           ///< friction and damping along the way that the wheel's centre can go [N s/m]
  double stiffness = 0.0;         ///< ditto [N/m]
};

/// Knobs that only assembly turns.
struct AssemblyKnobs {
  double stiffness_scale = 1.0;  ///< of bushings, discs and sprocket
  double mass_damping = 0.0;     ///< 1/s, on every body
  bool rubber_memory = true;     ///< false: springs and a plain damper, the rubber is taken as fully relaxed
  std::array<double, k_num_sides> tensioner_reference{};  ///< rad, idler arm angle at which the tensioner is free
};

/// Constants of an axis' Maxwell branches for one step, and their sums.
struct AxisBranches {
  std::vector<MaxwellStep> branch;
  double gain = 0.0, work_per_way = 0.0;
  double h = std::numeric_limits<double>::quiet_NaN();  ///< s, the step's length; no number: not yet found
};

/// Overwritten by every evaluation; each array says its shape, unit, frame and which stage writes it.
struct Workspace {
  TreeWorkspace chassis;                ///< by place_bodies, chassis_accelerations
  std::vector<SpringBlock> suspension;  ///< joint springs in lanes; constant, by make_workspace

  Field rotation;             ///< link -> W, row-major (9 x links), by place_bodies
  Field angular_velocity_W;   ///< rad/s, W (3 x links), by place_bodies
  Field joint_force_W;        ///< bushing force on link i+1 at the pin [N], W (3 x joints), by bushing_forces
  Field joint_torque_next_W;  ///< its moment about link i+1's centre [N m], W (3 x joints), by bushing_forces, where
                              ///< keeps_joint_torques or connectors are bodies
  Field joint_torque_own_W;   ///< its moment about link i's centre, to be subtracted [N m], W, by the same, ditto
  Field bushing_force;        ///< in frame i, on link i, +x = tension [N] (3 x joints), by bushing_forces
  Field bushing_torque;       ///< moments dual to the deflection's angles [N m] (3 x joints), by bushing_forces
  Field joint_stiffness;  ///< dynamic tangent of x, y, z, swing axes rx, rz, hinge ry (6 x joints), by bushing_forces
                          ///< where bounds_step
  Field joint_damping;    ///< ditto, viscous (6 x joints)

  /// Around each block of eight links and the link ahead: least and largest x, least and largest z, W [m] (4 x blocks
  /// of a track), by place_links.
  std::array<Field, k_num_sides> box;
  Field force_W;          ///< total on each link [N], W (3 x links), by bushing_forces and contacts
  Field torque_W;         ///< about its centre [N m], W (3 x links)
  Field loss_force_W;     ///< part of force_W that contacts lose energy by: damping, friction [N], W (3 x links)
  Field loss_torque_W;    ///< ditto of torque_W [N m]
  Field plane_stiffness;  ///< blocks of x, z and pitch, by contacts; no joints' (rows of PlaneRow x links)
  Field plane_damping;    ///< ditto
  Field side_stiffness;   ///< over inertia: aside, about x and z, both [1/s^2] (3 x links), by the same
  Field side_damping;     ///< ditto [1/s]
  Field stability;        ///< sums of k/m and c/m of contacts in any direction [1/s^2, 1/s] (2 x links), by contacts
  std::array<Field, k_num_partners> contact_force_W;  ///< by partner [N], W (3 x links)
  std::vector<RimSums> rim;                           ///< (tree bodies), by disc_contacts and sprocket_contacts

  /// Maxwell constants for the step's length, by side and axis, by bushing_forces.
  std::array<std::array<AxisBranches, k_num_axes>, k_num_sides> branch_step;
  std::vector<double> prescribed_acceleration;  ///< by drive (tree bodies)
  double sum_of_accelerations = 0.0;  ///< of all links, no number where one of them is none, by link_accelerations
  EnergyTerms energy;
  std::array<double, k_num_sides>
      lateral_guide_offset{};  ///< largest |y| of a link engaged with a wheel [m], by guide_contacts
  std::array<long, k_num_contact_cases> case_count{};  ///< this evaluation
  bool keeps_joint_torques = true;                     ///< wanted: no step needs those of joints that links share
  bool bounds_step = true;  ///< wanted of this evaluation: the slopes of all forces, and largest_stable_step from them
  double largest_stable_step = 0.0;  ///< s, by bound_step, below the true one
  Part bounding;                     ///< what set it
  int bottomed_unit = -1;            ///< tree body of an arm whose gas unit has no volume left, by suspension_forces
};

/// Axis 0, 1 or 2 of eight links in a row, W.
[[nodiscard]] inline Lanes3 load_axis(const Workspace& work, int axis, int first) {
  return {load(work.rotation[axis] + first), load(work.rotation[3 + axis] + first),
          load(work.rotation[6 + axis] + first)};
}

[[nodiscard]] Workspace make_workspace(const System& system);

}  // namespace grouser
