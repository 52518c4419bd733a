#include "simulator/contacts.h"

namespace grouser {

void push_links(Workspace& work, int first, const LinkLoads& load_W, Partner partner) {
  add_to3(work.force_W, first, load_W.force);
  add_to3(work.torque_W, first, load_W.torque);
  add_to3(work.contact_force_W[static_cast<std::size_t>(partner)], first, load_W.force);
}

void push_body(Workspace& work, int body, const Lanes3& force_W, const Lanes3& about_base_W) {
  Vector6d& on_body = work.chassis.force[static_cast<std::size_t>(body)];
  on_body.head<3>() += sum_of_lanes(about_base_W);
  on_body.tail<3>() += sum_of_lanes(force_W);
}

void push_apart(const State& state, Workspace& work, int first, const LinkLoads& load_W, int body, Partner partner) {
  push_links(work, first, load_W, partner);
  const Lanes3 from_base = load3(state.position, first) - in_all_lanes(state.chassis.position);
  push_body(work, body, -load_W.force, -(cross(from_base, load_W.force) + load_W.torque));
}

}  // namespace grouser
