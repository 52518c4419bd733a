#pragma once
#include <ostream>
#include <string>
#include <vector>

#include "tests/support/trees.h"

/// Trees whose motion is known from elsewhere: published results and independent programs. Joint angles in rad, SI.
namespace grouser::test {

[[nodiscard]] Eigen::VectorXd vector_of(std::initializer_list<double> values);
[[nodiscard]] Eigen::VectorXd no_torque(const TreeState& state);

/// Joint accelerations of the first moment after a release at rest, gravity 9.81 m/s^2 along -y.
struct FallReference {
  std::string name;
  Tree tree;
  Eigen::VectorXd acceleration;
};
/// RBDL, tests/DynamicsTests.cc: published to 15 digits.
[[nodiscard]] std::vector<FallReference> published_falls();

/// The five-body tree at a state where nothing vanishes; fourteen digits from a dense mass matrix (numpy).
struct GenericState {
  Tree tree = five_body_tree();
  TreeState state;
  Vector3d gravity = Vector3d(0.0, -9.81, 0.0);
  Eigen::VectorXd torque, acceleration;
  Eigen::VectorXd mass_matrix_column;  ///< the first one
  double kinetic = 0.0, potential = 0.0;
  GenericState();
};
/// Joint torques that give the tree these joint accelerations: every joint prescribed.
[[nodiscard]] Eigen::VectorXd inverse_dynamics(Tree tree, const TreeState& state, const Vector3d& gravity,
                                               const Eigen::VectorXd& acceleration);

/// A motion known at some times.
struct MotionReference {
  std::string name, source;
  Tree tree;
  TreeState start;
  Vector3d gravity = Vector3d::Zero();
  TorqueLaw torque = no_torque;
  double tolerance = 0.0;  ///< rad; thirty times as much in rad/s for rates
  const char* reason = "";
  struct At {
    double time;
    Eigen::VectorXd angle, rate;
  };
  std::vector<At> known;
};
inline void PrintTo(const MotionReference& shown, std::ostream* out) { *out << shown.name; }
[[nodiscard]] MotionReference five_body_fall();
[[nodiscard]] MotionReference double_pendulum();
[[nodiscard]] MotionReference sprung_chain();
[[nodiscard]] MotionReference tilted_hinge_chain();
/// Angles at which the sprung chain hangs still.
[[nodiscard]] Eigen::VectorXd sprung_chain_at_rest();

/// Heavy symmetric top with a fixed point: three crossed hinges, two massless bodies, then the top, which never comes
/// nearer than 30 degrees to the first axis, where the hinges would be singular.
struct HeavyTop {
  Tree tree;
  TreeState start;
  Vector3d gravity = Vector3d(0.0, 0.0, -9.81);
  struct At {
    double time;
    Vector3d center, spin;  ///< centre of mass in W [m], angular velocity in the body's frame [rad/s]
  };
  std::vector<At> known;
  HeavyTop();
};

/// A rod of 1 kg whose centre is 2 m from its hinge, released level, as a commercial solver (MSC ADAMS) moves it.
struct HingedRod {
  std::string name;  ///< of the published curves
  Tree tree;
  TreeState start;
  Vector3d gravity = Vector3d(0.0, 0.0, -9.80665);
  TorqueLaw torque = no_torque;
  double moment_tolerance = 5e-4;  ///< N m, of the published curves
  struct At {
    double time;
    Vector3d center, force, moment;  ///< in W: centre of mass [m]; what the rod puts on the ground at the hinge
  };
  std::vector<At> known;
};
inline void PrintTo(const HingedRod& shown, std::ostream* out) { *out << shown.name; }
[[nodiscard]] std::vector<HingedRod> adams_rods();
/// Where the rod's centre is and what it puts on the ground.
[[nodiscard]] HingedRod::At observe(const HingedRod& rod, const TreeState& state, double time);

}  // namespace grouser::test
