#include "simulator/stability.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

#include "simulator/integrator.h"

#include "tests/support/linear_vehicle.h"
#include "tests/support/vehicle_scene.h"

/// The stable step that is known for certain against the exact one.
namespace grouser::test {
namespace {

TEST(StableStep, TakesEigenvaluesNeverTooSmall) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 2000; ++trial) {
    const int rank = 1 + trial % 3;
    Matrix3d m = Matrix3d::Zero();
    for (int r = 0; r < rank; ++r) {
      const Vector3d g(normal(random), normal(random), normal(random));
      m += std::exp(2.0 * normal(random)) * g * g.transpose();
    }
    if (trial % 5 == 0) m = m(0, 0) * Matrix3d::Identity();
    const double exact = Eigen::SelfAdjointEigenSolver<Matrix3d>(m).eigenvalues()[2];
    const double found = largest_eigenvalue({m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(0, 2), m(1, 2)})[0];
    EXPECT_GE(found, exact * (1.0 - 1e-12));  // round-off
    EXPECT_LE(found, exact * 1.005);          // where the two largest are equal a Newton step halves the error
  }
}

/// An endless straight chain, stiffness k along x and z, links of mass m, moment of inertia J and pitch p, has
/// its highest frequency at omega^2 = k max(4 / m, p^2 / J).
TEST(StableStep, IsExactForAStraightChain) {
  const System& system = reference_scene().system;
  const CompiledTrack& track = system.tracks[0];
  Workspace work = make_workspace(system);
  work.largest_stable_step = 1.0;
  const double k = 1e8;
  for (const int axis : {0, 2}) {
    for (const CompiledTrack& each : system.tracks) {
      std::fill_n(work.joint_stiffness[axis] + each.offset, each.num_links, k);
    }
  }
  bound_step(system, false, std::numeric_limits<double>::infinity(), work);
  const double omega2 = k * std::max(4.0 / track.mass, track.pitch * track.pitch / track.inertia.y());
  EXPECT_NEAR(work.largest_stable_step / stable_step(system.scenario.integrator.beta, omega2, 0.0), 1.0, 1e-3);
}

/// The bound of a state, and what the linearised vehicle really bears.
struct Bounds {
  double bound = 0.0, exact = 0.0;
};
Bounds bounds_at(const System& given, const State& state) {
  System system = given;
  system.scenario.integrator.growth_limit = 100.0;  // the bound is looked for no further than the next step may go
  const AssemblyKnobs& knobs = reference_scene().rest.knobs;
  Workspace work = make_workspace(system);
  Acceleration acceleration = make_acceleration(system);
  State at = state;
  close_chains(system, at);
  evaluate(system, knobs, state.history, 1e-4, at, work, acceleration);
  return {work.largest_stable_step,
          largest_stable_step(linearise(system, knobs, state, Side::left), system.scenario.integrator.beta)};
}

TEST(StableStep, IsBelowTheExactOneAtRestAndInMotion) {
  const System system = driven(12.0, 12.0);
  const Bounds rest = bounds_at(system, reference_scene().rest.state);
  EXPECT_LE(rest.bound, rest.exact);
  EXPECT_GE(rest.bound, 0.7 * rest.exact);  // measured 0.79: the idler's spin and its links are taken apart
  const Bounds driving = bounds_at(system, run_for(system, reference_scene().rest.state, 1.0).state);
  EXPECT_LE(driving.bound, driving.exact);
  EXPECT_GE(driving.bound, 0.7 * driving.exact);
}

TEST(StableStep, IsBelowTheExactOneInViolentPoses) {
  const System& system = reference_scene().system;
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 3; ++trial) {
    State state = reference_scene().rest.state;
    for (int i = 0; i < system.link_array_length; ++i) {
      for (int c = 0; c < 3; ++c) {
        state.position[c][i] += 3e-4 * normal(random);         // m: 30 kN in a joint
        state.orientation[c + 1][i] += 2e-3 * normal(random);  // some 4 mrad
        state.velocity[c][i] += 0.5 * normal(random);          // m/s
        state.angular_velocity[c][i] += 5.0 * normal(random);  // rad/s
      }
    }
    const Bounds bounds = bounds_at(system, state);
    EXPECT_LE(bounds.bound, bounds.exact);
    EXPECT_GE(bounds.bound, 0.5 * bounds.exact);
  }
}

}  // namespace
}  // namespace grouser::test
