#include "tests/support/contact_scene.h"

#include "simulator/bushings.h"

namespace grouser::test {

ContactScene::ContactScene()
    : system(compile(parked(reference_vehicle(), elastic_bushing(), 0.0))),
      state(strewn_state(system)),
      work(make_workspace(system)) {}

void ContactScene::put(const Vector3d& position, const Quaterniond& orientation) {
  LinkMotion link = get_link(state, 0);
  link.position = position;
  link.orientation = orientation;
  set_link(state, 0, link);
}

void ContactScene::start() {
  close_chains(system, state);
  work.energy = {};
  work.case_count = {};
  work.force_W.fill(0.0);
  work.torque_W.fill(0.0);
  for (Field& field : work.contact_force_W) field.fill(0.0);
  place_tree(system.tree, state.chassis, Vector3d::Zero(), work.chassis);
  place_links(system, state, work);
}

void ContactScene::touch() {
  start();
  disc_contacts(system, {}, state, work);
  sprocket_contacts(system, {}, state, work);
}

void ContactScene::touch_ground() {
  start();
  const History before = state.history;
  ground_contacts(system, before, 0.0, state, work);
}

void ContactScene::drift(double dt) {
  TreeState& base = state.chassis;
  base.position += dt * base.velocity;
  base.orientation = base.orientation * quaternion_exp(dt * base.angular_velocity);
  base.angle += dt * base.rate;
  LinkMotion link = get_link(state, 0);
  link.position += dt * link.velocity;
  link.orientation = link.orientation * quaternion_exp(dt * link.angular_velocity);
  set_link(state, 0, link);
}

double ContactScene::power() const {
  double sum = get_vector(work.force_W, 0).dot(get_vector(state.velocity, 0)) +
               get_vector(work.torque_W, 0).dot(get_vector(work.angular_velocity_W, 0));
  for (int i = 0; i < system.num_revolute_joints(); ++i) sum += work.chassis.force(i).dot(work.chassis.velocity(i));
  return sum;
}

Vector3d under_wheel(const ContactScene& scene, const DiscPair& wheel, double along, double depth) {
  return wheel.center + Vector3d(along, 0.0, -wheel.radius - scene.system.tracks[0].wheel_path_height + depth);
}

Vector3d with_pin_at(const ContactScene& scene, double x, double z) {
  return scene.left().sprocket.center + Vector3d(x + 0.5 * scene.system.tracks[0].pitch, 0.0, z);
}

}  // namespace grouser::test
