#include "simulator/state.h"

#include "simulator/stability.h"
#include "simulator/suspension.h"

namespace grouser {

/// Here, where the compiler knows of no caller's zero: for a few kilobytes of those it would call memset, which takes
/// twice as long.
void Field::fill(double value) {
  const Lanes values = value;
  double* to = data_.data();
  double* const end = to + data_.size();
  for (; to + k_lanes <= end; to += k_lanes) store(to, values);
  std::fill(to, end, value);
}

State make_state(const System& system) {
  const int n = system.link_array_length;
  State state;
  state.chassis = make_state(system.tree);
  state.position = Field(3, n);
  state.orientation = Field(4, n);
  std::fill(state.orientation[0], state.orientation[0] + n, 1.0);
  state.velocity = Field(3, n);
  state.angular_velocity = Field(3, n);
  state.history.deflection = Field(k_num_axes, n);
  state.history.stop = Field(system.num_stop_rows, n);
  state.history.branch = Field(system.num_branch_rows, n);
  state.history.anchor_x = Field(system.num_ground_rows, n);
  state.history.anchor_y = Field(system.num_ground_rows, n);
  state.history.anchor_z = Field(system.num_ground_rows, n);
  state.history.stretch_x = Field(system.num_ground_rows, n);
  state.history.stretch_y = Field(system.num_ground_rows, n);
  state.history.anchored = Field(system.num_ground_rows, n);
  return state;
}

Acceleration make_acceleration(const System& system) {
  Acceleration acceleration;
  acceleration.chassis.joint = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(system.tree.bodies.size()));
  acceleration.linear = Field(3, system.link_array_length);
  acceleration.angular = Field(3, system.link_array_length);
  return acceleration;
}

void close_chains(const System& system, State& state) {
  for (const CompiledTrack& track : system.tracks) {
    for (const LinkBodies& bodies : track.bodies) {
      const int first = bodies.offset, last = first + bodies.count, end = first + padded_length(bodies.count);
      for (Field* field : {&state.position, &state.orientation, &state.velocity, &state.angular_velocity}) {
        for (int c = 0; c < field->components(); ++c) {
          const Lanes repeated = (*field)[c][first];  // what is padded is eight to fifteen long
          store((*field)[c] + last, repeated);
          store((*field)[c] + end - k_lanes, repeated);
        }
      }
    }
  }
}

Workspace make_workspace(const System& system) {
  const int n = system.link_array_length;
  Workspace work;
  work.chassis = make_workspace(system.tree);
  work.suspension = arrange_springs(system.suspension);
  work.rotation = Field(9, n);
  for (const int diagonal : {0, 4, 8}) std::fill(work.rotation[diagonal], work.rotation[diagonal] + n, 1.0);
  work.angular_velocity_W = Field(3, n);
  work.joint_force_W = Field(3, n);
  work.joint_torque_next_W = Field(3, n);
  work.joint_torque_own_W = Field(3, n);
  work.bushing_force = Field(3, n);
  work.bushing_torque = Field(3, n);
  work.joint_stiffness = Field(k_num_axes, n);
  work.joint_damping = Field(k_num_axes, n);
  work.force_W = Field(3, n);
  work.torque_W = Field(3, n);
  work.loss_force_W = Field(3, n);
  work.loss_torque_W = Field(3, n);
  work.plane_stiffness = Field(k_plane_rows, n);
  work.plane_damping = Field(k_plane_rows, n);
  work.side_stiffness = Field(3, n);
  work.side_damping = Field(3, n);
  work.stability = Field(2, n);
  for (Field& box : work.box) box = Field(4, padded_length(n / k_lanes));
  for (Field& field : work.contact_force_W) field = Field(3, n);
  for (const CompiledTrack& track : system.tracks) {
    for (std::size_t a = 0; a < k_num_axes; ++a) {
      work.branch_step[static_cast<std::size_t>(index_of(track.side))][a].branch.resize(
          track.bushing[a].branches.size());
    }
  }
  work.rim.resize(system.tree.bodies.size());
  work.prescribed_acceleration.assign(system.tree.bodies.size(), 0.0);
  return work;
}

}  // namespace grouser
