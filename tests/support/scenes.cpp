#include "tests/support/scenes.h"

#include <cmath>

#include "simulator/bushings.h"

namespace grouser::test {
namespace {

void set_vector(Field& field, int i, const Vector3d& v) {
  for (int c = 0; c < 3; ++c) field[c][i] = v[c];
}

}  // namespace

Vector3d get_vector(const Field& field, int i) { return {field[0][i], field[1][i], field[2][i]}; }

void set_link(State& state, int i, const LinkMotion& motion) {
  set_vector(state.position, i, motion.position);
  const Quaterniond& q = motion.orientation;
  const double wxyz[] = {q.w(), q.x(), q.y(), q.z()};
  for (int c = 0; c < 4; ++c) state.orientation[c][i] = wxyz[c];
  set_vector(state.velocity, i, motion.velocity);
  set_vector(state.angular_velocity, i, motion.angular_velocity);
}

LinkMotion get_link(const State& state, int i) {
  const Field& q = state.orientation;
  return {get_vector(state.position, i), Quaterniond(q[0][i], q[1][i], q[2][i], q[3][i]), get_vector(state.velocity, i),
          get_vector(state.angular_velocity, i)};
}

Bushing no_bushing() {
  Bushing bushing;
  bushing.name = "none";
  for (AxisLaw& law : bushing.axes) law.spring = SpringSpline::linear(0.0, 1.0);
  return bushing;
}

Bushing elastic_bushing() {
  Bushing bushing = no_bushing();
  bushing.name = "elastic";
  const double stiffness[] = {1e8, 2e7, 1e8, 4e6, 1500.0, 4e6};
  for (std::size_t a = 0; a < k_num_axes; ++a) bushing.axes[a].spring = SpringSpline::linear(stiffness[a], 1.0);
  return bushing;
}

Bushing viscous_bushing() {
  Bushing bushing = elastic_bushing();
  bushing.name = "viscous";
  SpringSpline& spring = bushing.axis(Axis::x).spring;
  spring = {};
  for (int i = -6; i <= 6; ++i) {  // f = 8e7 x + 1e13 x^3 over +-3 mm: slopes exact, so each piece is the cubic itself
    const double x = 5e-4 * i;
    spring.displacement.push_back(x);
    spring.force.push_back(8e7 * x + 1e13 * x * x * x);
    spring.slope.push_back(8e7 + 3e13 * x * x);
  }
  const double damping[] = {4e3, 2e3, 4e3, 100.0, 2.0, 100.0};
  for (std::size_t a = 0; a < k_num_axes; ++a) bushing.axes[a].viscous = damping[a];
  return bushing;
}

Bushing rubber_bushing() {
  Bushing bushing = viscous_bushing();
  bushing.name = "rubber";
  const double stiffness[] = {1e8, 2e7, 1e8, 4e6, 1500.0, 4e6};
  for (std::size_t a = 0; a < k_num_axes; ++a) {
    const double k = stiffness[a], yield = is_rotation(static_cast<Axis>(a)) ? 5e-3 : 5e-5;
    bushing.axes[a].stops = {{0.04 * k, yield}, {0.02 * k, 4.0 * yield}};
    bushing.axes[a].branches = {{0.05 * k, 2e-3}, {0.03 * k, 5e-2}};
    bushing.axes[a].viscous *= 0.25;
  }
  return bushing;
}

Vehicle reference_vehicle() { return read_vehicle(GROUSER_SOURCE_DIR "/test_data/vehicles/reference.json"); }

Vehicle bare_vehicle(int num_links) {
  Vehicle vehicle = reference_vehicle();
  for (RunningGear& gear : vehicle.sides) {
    gear.stations.clear();
    gear.support_rollers.clear();
    gear.track.num_links = num_links;
    gear.track.pre_torsion = 0.0;
  }
  return vehicle;
}

Scenario parked(const Vehicle& vehicle, const Bushing& bushing, double gravity) {
  Scenario scenario;
  scenario.name = "parked";
  scenario.vehicle = vehicle;
  scenario.bushing = bushing;
  scenario.drive.fill({{0.0}, {0.0}});
  scenario.gravity = gravity;
  return scenario;
}

State strewn_state(const System& system) {
  State state = make_state(system);
  state.chassis.position = system.chassis_center_V;
  for (const CompiledTrack& track : system.tracks) {
    for (int k = 0; k < track.num_links; ++k) {
      set_link(state, track.offset + k, {{10.0 * k, 100.0 * index_of(track.side), 1000.0}});
    }
  }
  close_chains(system, state);
  return state;
}

Momentum momentum(const CompiledTrack& track, const State& state) {
  Momentum sum;
  for (int i = track.offset; i < track.offset + track.num_links; ++i) {
    const LinkMotion link = get_link(state, i);
    const Vector3d p = track.mass * link.velocity;
    sum.linear += p;
    sum.angular += link.position.cross(p) + link.orientation * track.inertia.cwiseProduct(link.angular_velocity);
  }
  return sum;
}

void place_polygon(const CompiledTrack& track, const Vector3d& center, double radius, double spin, State& state) {
  for (int k = 0; k < track.num_links; ++k) {
    // The track's own sense: x of a link forward below, the next joint ahead, wrapping inward (a negative turn about
    // y).
    const double turned = -2.0 * k_pi * k / track.num_links;
    const Quaterniond q(Eigen::AngleAxisd(turned, Vector3d::UnitY()));
    const Vector3d arm = q * Vector3d(0.0, 0.0, -radius), w(0.0, spin, 0.0);
    set_link(state, track.offset + k, {center + arm, q, w.cross(arm), w});
  }
}

void relax_rubber(const System& system, State& state) {
  close_chains(system, state);
  Workspace work = make_workspace(system);
  place_links(system, state, work);
  AssemblyKnobs knobs;
  knobs.rubber_memory = false;
  bushing_forces(system, knobs, state.history, 0.0, state, work);
}

}  // namespace grouser::test
