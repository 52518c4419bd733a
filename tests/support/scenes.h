#pragma once
#include "model/scenario.h"
#include "simulator/step.h"

/// Small systems for the simulator's tests.
namespace grouser::test {

/// Pose and motion of one link.
struct LinkMotion {
  Vector3d position = Vector3d::Zero();               ///< centre, W [m]
  Quaterniond orientation = Quaterniond::Identity();  ///< link -> W
  Vector3d velocity = Vector3d::Zero();               ///< W [m/s]
  Vector3d angular_velocity = Vector3d::Zero();       ///< link frame [rad/s]
};
void set_link(State& state, int i, const LinkMotion& motion);
[[nodiscard]] LinkMotion get_link(const State& state, int i);
[[nodiscard]] Vector3d get_vector(const Field& field, int i);

/// Linear springs and nothing else, P 6: 1e8, 2e7, 1e8 N/m, 4e6 N m/rad in swing, 1500 N m/rad in the hinge.
[[nodiscard]] Bushing elastic_bushing();
/// The same with a stiffening x spring and dampers.
[[nodiscard]] Bushing viscous_bushing();
/// The same with friction stops and Maxwell branches too: everything the law has.
[[nodiscard]] Bushing rubber_bushing();
/// No force at all: every link is a free body.
[[nodiscard]] Bushing no_bushing();

/// The vehicle of test_data/vehicles/reference.json.
[[nodiscard]] Vehicle reference_vehicle();
/// Its chassis, sprockets and idlers alone, with two tracks of `num_links`: a home for chains that touch nothing.
[[nodiscard]] Vehicle bare_vehicle(int num_links);
/// A vehicle with its sprockets locked for ever.
[[nodiscard]] Scenario parked(const Vehicle& vehicle, const Bushing& bushing, double gravity);

/// A state whose chassis stands at design and whose links are strewn 1 km up, far from everything and 10 m apart.
[[nodiscard]] State strewn_state(const System& system);

/// Momentum of one track; angular about W's origin.
struct Momentum {
  Vector3d linear = Vector3d::Zero(), angular = Vector3d::Zero();
};
[[nodiscard]] Momentum momentum(const CompiledTrack& track, const State& state);

/// Regular polygon of links in W's x-z plane about `center`, its link centres at `radius`, turning at `spin` about +y.
void place_polygon(const CompiledTrack& track, const Vector3d& center, double radius, double spin, State& state);

/// The memory of rubber that was put into the state's shape without a force: deflections known, nothing strained.
void relax_rubber(const System& system, State& state);

}  // namespace grouser::test
