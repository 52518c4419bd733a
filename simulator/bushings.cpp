#include "simulator/bushings.h"

#include <algorithm>

#include "simulator/connector.h"

namespace grouser {
namespace {

Lanes lane_mask(int valid) { return choose(LaneMask::first(valid), 1.0, 0.0); }

/// What the output and the stability bound take from eight bushings.
void store_bushings(const RubberLoad& rubber, int joint, double scale, Workspace& work) {
  for (std::size_t a = 0; a < k_num_axes && work.bounds_step; ++a) {
    const int row = static_cast<int>(a);
    store(work.joint_stiffness[row] + joint, scale * rubber.stiffness[a]);
    store(work.joint_damping[row] + joint, scale * rubber.damping[a]);
  }
  const auto& f = rubber.force;
  store3(work.bushing_force, joint, {scale * f[0], scale * f[1], scale * f[2]});
  store3(work.bushing_torque, joint, {scale * f[3], scale * f[4], scale * f[5]});
}

void store_torques(const ElementWrench& wrench, int joint, Workspace& work) {
  store3(work.joint_torque_next_W, joint, wrench.torque_next);
  store3(work.joint_torque_own_W, joint, wrench.torque_own);
}

Lanes3 one_behind(const Lanes3& before, const Lanes3& now) {
  return {one_behind(before.x, now.x), one_behind(before.y, now.y), one_behind(before.z, now.z)};
}

/// Begins the links' sums with the wrenches of the joints around them, while those are at hand.
class LinkSums {
 public:
  LinkSums(const CompiledTrack& track, Workspace& work) : track_(track), work_(work) {}

  /// Joints from `joint` on, block by block in their order, each link's own ahead of it.
  void add(const ElementWrench& wrench, int joint) {
    store3(work_.joint_force_W, joint, wrench.force);
    if (work_.keeps_joint_torques) store_torques(wrench, joint, work_);
    const Lanes3 none{0.0, 0.0, 0.0};
    const LaneMask valid = LaneMask::first(track_.offset + track_.num_links - joint);
    store3(work_.force_W, joint, choose(valid, one_behind(force_, wrench.force) - wrench.force, none));
    store3(work_.torque_W, joint, choose(valid, one_behind(torque_, wrench.torque_next) - wrench.torque_own, none));
    force_ = wrench.force;
    torque_ = wrench.torque_next;
  }
  /// The first link lacks the last joint behind it; the copy behind the last link begins with nothing.
  void close() {
    const int first = track_.offset, end = first + track_.num_links, last = (track_.num_links + k_lanes - 1) % k_lanes;
    const Vector3d force = in_lane(last, force_), torque = in_lane(last, torque_);
    for (int c = 0; c < 3; ++c) {
      work_.force_W[c][first] += force[c];
      work_.torque_W[c][first] += torque[c];
      work_.force_W[c][end] = work_.torque_W[c][end] = 0.0;
    }
  }

 private:
  const CompiledTrack& track_;
  Workspace& work_;
  Lanes3 force_{0.0, 0.0, 0.0}, torque_{0.0, 0.0, 0.0};  ///< on the link ahead, of the joints before
};

/// What a track's bushings hold and lose, summed over lanes at its end.
class EnergySums {
 public:
  void add(const ElementEnergy& energy, const Lanes& mask) {
    sums_.stored += mask * energy.stored;
    sums_.power += mask * energy.power;
    sums_.step_loss += mask * energy.step_loss;
  }
  void book(EnergyTerms& terms) const {
    terms.bushing += sums_.stored.sum();
    terms.bushing_power += sums_.power.sum();
    terms.bushing_step_loss += sums_.step_loss.sum();
  }

 private:
  ElementEnergy sums_;
};

AxisLanes scaled(double scale, AxisLanes force) {
  for (Lanes& f : force) f *= scale;
  return force;
}

ElementWrench scaled(double scale, const ElementWrench& wrench) {
  return {scale * wrench.force, scale * wrench.torque_next, scale * wrench.torque_own};
}

/// Asks for the lines that hold eight bodies. Inline by force: a function that only asks is taken for one without
/// effect.
[[gnu::always_inline]] inline void ask_for_bodies(const State& state, const Workspace& work, int i) {
  const auto ask = [i](const Field& field, int components) {
    for (int c = 0; c < components; ++c) __builtin_prefetch(field[c] + i);
  };
  for (const Field* field : {&state.position, &state.velocity, &work.angular_velocity_W}) ask(*field, 3);
  ask(state.orientation, 4);
  ask(work.rotation, 9);
}

/// Single pin: the bore in link i, the pin in link i+1.
void single_pins(const RubberStep& step, const State& state, double scale, Workspace& work) {
  const CompiledTrack& track = step.track;
  const ElementShape shape{track.groove, -track.groove};
  LinkSums sums(track, work);
  EnergySums energy;
  for (int first = 0; first < track.num_links; first += k_lanes) {
    const int i = track.offset + first;
    ask_for_bodies(state, work, i + 2 * k_lanes);  // those of the next block reach into that one
    const BodyLanes own = load_bodies(state, work, i), next = load_bodies(state, work, i + 1);
    const ElementKinematics k = element_kinematics(own, next, shape);
    const RubberLoad rubber = rubber_load(step, k, i);
    store_bushings(rubber, i, scale, work);
    sums.add(element_wrench(own, next, k, scaled(scale, rubber.force)), i);
    energy.add(rubber.energy, scale * lane_mask(track.num_links - first));
  }
  sums.close();
  energy.book(work.energy);
}

/// Lanes from `valid` on repeat the last valid one: the padding behind a track's last joint is no joint.
void repeat_last(int valid, Lanes& lanes) {
  for (int lane = valid; lane < k_lanes; ++lane) lanes.set(lane, lanes[valid - 1]);
}
void repeat_last(int valid, BodyLanes& bodies) {
  for (Lanes3* v : {&bodies.position, &bodies.x, &bodies.y, &bodies.z, &bodies.velocity, &bodies.angular_velocity}) {
    repeat_last(valid, v->x);
    repeat_last(valid, v->y);
    repeat_last(valid, v->z);
  }
  for (Lanes& q : bodies.orientation) repeat_last(valid, q);
}

/// Two in series: a b / (a + b), 0 where both are.
Lanes in_series(const Lanes& a, const Lanes& b) {
  constexpr double k_nothing = 1e-30;
  return a * b / (a + b + k_nothing);
}

/// The joint's own tangents, for the stability bound. Across the connector it gives way by swinging too: T / l and the
/// hinges' (k + k) / l^2.
void condense_tangents(const CompiledTrack& track, const DoublePinRows& rows, Workspace& work) {
  const double l = track.connector_length;
  const auto condense = [&](Field& field, const Lanes& pull) {
    const auto at = [&](int axis, int row) { return load(field[axis] + row); };
    const Lanes swing = pull / l + (at(4, rows.front) + at(4, rows.rear)) / (l * l);
    for (int a = 0; a < k_num_axes; ++a) store(field[a] + rows.front, in_series(at(a, rows.front), at(a, rows.rear)));
    store(field[2] + rows.front, in_series(at(2, rows.front), swing));
  };
  condense(work.joint_stiffness, load(work.bushing_force[0] + rows.front).max(0.0));
  condense(work.joint_damping, 0.0);
}

/// What reaches the two shoes. The connector has no mass: what its wrenches lack of cancelling, within the tolerance of
/// the balance, is shared by the shoes, so that they still get equal and opposite wrenches.
ElementWrench wrench_between_shoes(const DoublePinJoints& joints, const BodyLanes& link, const BodyLanes& next) {
  const ElementWrench &front = joints.front.wrench, &rear = joints.rear.wrench;
  const Lanes3 left_over = 0.5 * (front.force + rear.force);
  const Lanes3 left_over_torque = 0.5 * (front.torque_next + rear.torque_next);
  const Lanes3& c = joints.connector.position;
  return {0.5 * (front.force - rear.force), cross(c - next.position, left_over) + left_over_torque - rear.torque_own,
          front.torque_own - cross(c - link.position, left_over) - left_over_torque};
}

/// Double pin with massless connectors.
void condensed_double_pins(const RubberStep& step, const State& state, double scale, Workspace& work) {
  const CompiledTrack& track = step.track;
  LinkSums sums(track, work);
  EnergySums energy;
  for (int first = 0; first < track.num_links; first += k_lanes) {
    const DoublePinRows rows{track.offset + first, track.connector_offset + first};
    const int valid = std::min(k_lanes, track.num_links - first);
    BodyLanes link = load_bodies(state, work, rows.front), next = load_bodies(state, work, rows.front + 1);
    repeat_last(valid, link);
    repeat_last(valid, next);
    const DoublePinJoints joints = balance_connectors(step, link, next, rows, valid);
    store_bushings(joints.front.rubber, rows.front, scale, work);
    store_bushings(joints.rear.rubber, rows.rear, scale, work);
    if (work.bounds_step) condense_tangents(track, rows, work);
    sums.add(scaled(scale, wrench_between_shoes(joints, link, next)), rows.front);
    const Lanes mask = scale * lane_mask(valid);
    energy.add(joints.front.rubber.energy, mask);
    energy.add(joints.rear.rubber.energy, mask);
  }
  sums.close();
  energy.book(work.energy);
}

/// The wrenches of both bushings of every joint on shoes and connectors.
void sum_connector_forces(const CompiledTrack& track, Workspace& work) {
  const int n = track.num_links;
  for (int c = 0; c < 3; ++c) {
    double* force = work.force_W[c];
    double* torque = work.torque_W[c];
    const double* on_next = work.joint_force_W[c];
    const double* next = work.joint_torque_next_W[c];
    const double* own = work.joint_torque_own_W[c];
    for (int k = 0; k < n; ++k) {
      const int link = track.offset + k, rear = track.connector_offset + k;
      const int behind = track.connector_offset + (k + n - 1) % n;  // the rear bushing of the joint before
      force[link] = -(on_next[link] + on_next[behind]);
      torque[link] = -(own[link] + own[behind]);
      force[rear] = on_next[link] + on_next[rear];
      torque[rear] = next[link] + next[rear];
    }
    force[track.offset + n] = torque[track.offset + n] = 0.0;  // the copy of the first link
  }
}

/// Double pin whose connectors are bodies of their own.
void double_pins(const RubberStep& step, const State& state, double scale, Workspace& work) {
  const CompiledTrack& track = step.track;
  EnergySums energy;
  for (int first = 0; first < track.num_links; first += k_lanes) {
    const DoublePinRows rows{track.offset + first, track.connector_offset + first};
    const BodyLanes link = load_bodies(state, work, rows.front), next = load_bodies(state, work, rows.front + 1);
    DoublePinJoints joints;
    joints.connector = load_bodies(state, work, rows.rear);
    evaluate_bushings(step, link, next, rows, joints);
    const Lanes mask = scale * lane_mask(track.num_links - first);
    for (const auto& [bushings, row] : {std::pair(&joints.front, rows.front), std::pair(&joints.rear, rows.rear)}) {
      store_bushings(bushings->rubber, row, scale, work);
      const ElementWrench wrench = scaled(scale, bushings->wrench);
      store3(work.joint_force_W, row, wrench.force);
      store_torques(wrench, row, work);
      energy.add(bushings->rubber.energy, mask);
    }
  }
  energy.book(work.energy);
  sum_connector_forces(track, work);
}

void track_bushings(const CompiledTrack& track, const AssemblyKnobs& knobs, const History& before, double h,
                    State& state, Workspace& work) {
  auto& branch_steps = work.branch_step[static_cast<std::size_t>(index_of(track.law))];
  for (std::size_t a = 0; a < k_num_axes && track.law == track.side; ++a) {
    prepare_branches(track.bushing[a], h, branch_steps[a]);
  }
  const RubberStep step{track, branch_steps, before, state.history, h, knobs.rubber_memory};
  switch (track.joint) {
    case JointForm::single_pin:
      return single_pins(step, state, knobs.stiffness_scale, work);
    case JointForm::double_pin:
      return condensed_double_pins(step, state, knobs.stiffness_scale, work);
    case JointForm::connector_bodies:
      return double_pins(step, state, knobs.stiffness_scale, work);
  }
}

/// Boxes around the links of every block of eight and the link ahead of it.
void find_boxes(const System& system, const State& state, Workspace& work) {
  for (const CompiledTrack& track : system.tracks) {
    Field& box = work.box[static_cast<std::size_t>(index_of(track.side))];
    for (int block = 0; k_lanes * block < track.num_links; ++block) {
      const int i = track.offset + k_lanes * block;
      const Lanes x = load(state.position[0] + i), x_ahead = load(state.position[0] + i + 1);
      const Lanes z = load(state.position[2] + i), z_ahead = load(state.position[2] + i + 1);
      box[0][block] = x.min(x_ahead).min_lane();
      box[1][block] = x.max(x_ahead).max_lane();
      box[2][block] = z.min(z_ahead).min_lane();
      box[3][block] = z.max(z_ahead).max_lane();
    }
  }
}

}  // namespace

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
  find_boxes(system, state, work);
}

void bushing_forces(const System& system, const AssemblyKnobs& knobs, const History& before, double h, State& state,
                    Workspace& work) {
  for (const CompiledTrack& track : system.tracks) track_bushings(track, knobs, before, h, state, work);
}

void place_connectors(const System& system, State& state) {
  Workspace work = make_workspace(system);
  place_links(system, state, work);
  for (const CompiledTrack& track : system.tracks) {
    if (track.joint != JointForm::connector_bodies) continue;
    for (int first = 0; first < track.num_links; first += k_lanes) {
      const int i = track.offset + first, to = track.connector_offset + first;
      const BodyLanes own = load_bodies(state, work, i), next = load_bodies(state, work, i + 1);
      const BodyLanes connector = connectors_in_line(track, own, next);
      const Lanes3& w = connector.angular_velocity;
      store3(state.position, to, connector.position);
      for (int c = 0; c < 4; ++c) store(state.orientation[c] + to, connector.orientation[static_cast<std::size_t>(c)]);
      store3(state.velocity, to, connector.velocity);
      store3(state.angular_velocity, to, {dot(connector.x, w), dot(connector.y, w), dot(connector.z, w)});
    }
  }
  close_chains(system, state);
}

}  // namespace grouser
