#include "tests/support/vehicle_run.h"

#include <cmath>

namespace grouser::test {

Scenario shipped_scenario(const std::string& name) {
  return read_scenario(GROUSER_SOURCE_DIR "/test_data/scenarios/" + name + ".json");
}

VehicleScene at_rest(const Scenario& scenario) {
  VehicleScene scene{compile(scenario), {}};
  scene.rest = assemble(scene.system);
  return scene;
}

Bushing linear_bushing() {
  Bushing bushing = elastic_bushing();
  bushing.name = "linear";
  const double damping[] = {4e3, 2e3, 4e3, 100.0, 2.0, 100.0};
  for (std::size_t a = 0; a < k_num_axes; ++a) bushing.axes[a].viscous = damping[a];
  return bushing;
}

Vehicle frictionless(Vehicle vehicle) {
  for (RunningGear& gear : vehicle.sides) {
    for (Station& station : gear.stations) station.wheel.contact.friction = 0.0;
    for (DiscPair& roller : gear.support_rollers) roller.contact.friction = 0.0;
    gear.idler.wheel.contact.friction = 0.0;
    gear.sprocket.contact.friction = 0.0;
  }
  return vehicle;
}

VehicleScene on_ice() {
  Scenario scenario = parked(frictionless(reference_vehicle()), linear_bushing(), 9.81);
  scenario.terrain.friction = 0.0;
  return at_rest(scenario);
}

void set_tensioner(double stiffness, VehicleScene& scene) {
  for (CompiledSuspension& spring : scene.system.suspension) {
    if (spring.kind != JointSpring::tensioner) continue;
    const auto side = static_cast<std::size_t>(index_of(spring.side));
    const Idler& idler = scene.system.scenario.vehicle.side(spring.side).idler;
    const double angle = scene.rest.state.chassis.angle[spring.body];
    double& reference = scene.rest.knobs.tensioner_reference[side];
    const double moment = spring.tensioner_stiffness * (angle - reference);
    spring.tensioner_stiffness = stiffness * (idler.wheel.center - idler.pivot).squaredNorm();
    reference = angle - moment / spring.tensioner_stiffness;
  }
}

CenterOfMass center_of_mass(const System& system, const State& state, const Workspace& work) {
  CenterOfMass sum;
  const auto add = [&](double mass, const Vector3d& position, const Vector3d& velocity) {
    sum.mass += mass;
    sum.position += mass * position;
    sum.velocity += mass * velocity;
  };
  const TreeState& chassis = state.chassis;
  add(system.tree.base_mass, chassis.position, chassis.velocity);
  for (int i = 0; i < system.num_revolute_joints(); ++i) {
    const Vector3d from_base = work.chassis.center_W(i);
    add(system.tree.bodies[static_cast<std::size_t>(i)].mass, chassis.position + from_base,
        work.chassis.velocity_at(i, from_base));
  }
  for (const CompiledTrack& track : system.tracks) {
    for (int i = track.offset; i < track.offset + track.num_links; ++i)
      add(track.mass, get_vector(state.position, i), get_vector(state.velocity, i));
  }
  sum.position /= sum.mass;
  sum.velocity /= sum.mass;
  return sum;
}

GroundPress press_on_ground(const System& system, const State& state) {
  GroundPress press;
  const std::vector<Station>& stations = system.scenario.vehicle.side(Side::left).stations;
  const auto nearest = [&](double x) {
    std::size_t best = 0;
    for (std::size_t s = 1; s < stations.size(); ++s) {
      const double origin = state.chassis.position.x() - system.chassis_center_V.x();
      const auto distance = [&](std::size_t k) { return std::abs(origin + stations[k].wheel.center.x() - x); };
      if (distance(s) < distance(best)) best = s;
    }
    return best;
  };
  press.wheel_forces.assign(stations.size(), 0.0);
  for (const CompiledTrack& track : system.tracks) {
    for (int i = track.offset; i < track.offset + track.num_links; ++i) {
      const LinkMotion link = get_link(state, i);
      double force = 0.0;
      for (const Vector3d& point : track.ground_points) {
        const Vector3d at = link.position + link.orientation * point;
        const double push = track.ground.stiffness * std::max(0.0, -at.z());
        force += push;
        press.moment += push * at.x();
      }
      press.force += force;
      const bool on_ground = link.position.z() < 1.2 * track.ground_depth;
      const double front = stations.front().wheel.center.x(), rear = stations.back().wheel.center.x();
      const double x = link.position.x();
      if (track.side != Side::left || !on_ground) continue;
      const double weight = x < front && x > rear ? track.mass * system.scenario.gravity : 0.0;
      press.wheel_forces[nearest(x)] += force - weight;
    }
  }
  return press;
}

}  // namespace grouser::test
