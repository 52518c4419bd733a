#include "simulator/contacts.h"

namespace grouser {

LinkView view_link(const State& state, const Workspace& work, int i) {
  LinkView link;
  link.index = i;
  link.rotation << work.rotation[0][i], work.rotation[1][i], work.rotation[2][i], work.rotation[3][i],
      work.rotation[4][i], work.rotation[5][i], work.rotation[6][i], work.rotation[7][i], work.rotation[8][i];
  link.position = {state.position[0][i], state.position[1][i], state.position[2][i]};
  link.velocity = {state.velocity[0][i], state.velocity[1][i], state.velocity[2][i]};
  link.angular_velocity = {work.angular_velocity_W[0][i], work.angular_velocity_W[1][i], work.angular_velocity_W[2][i]};
  return link;
}

void push_link(Workspace& work, int i, const LinkLoad& load, Partner partner) {
  Field& booked = work.contact_force_W[static_cast<std::size_t>(partner)];
  for (int c = 0; c < 3; ++c) {
    work.force_W[c][i] += load.force_W[c];
    work.torque_W[c][i] += load.torque_W[c];
    booked[c][i] += load.force_W[c];
  }
}

}  // namespace grouser
