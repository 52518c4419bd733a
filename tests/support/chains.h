#pragma once
#include <vector>

#include "simulator/energy_book.h"
#include "tests/support/scenes.h"

/// Chains of links that touch nothing: free closed ones, and ones between links that are held.
namespace grouser::test {

/// Where free chains float [m].
[[nodiscard]] inline Vector3d far_from_chassis() { return {0.0, 0.0, 1000.0}; }

/// Two closed chains in free space, no gravity, fixed step [s].
[[nodiscard]] System chain_system(int num_links, const Bushing& bushing, double step);
/// Polygons whose links start with random velocities on top of a common motion.
[[nodiscard]] State thrown_chain(const System& system);

/// What 0.2 s of a thrown chain of 24 links change, and the sizes to compare with.
struct ChainDrift {
  double linear, angular, energy;            ///< N s, N m s, J; angular about the chain's own middle
  double linear_scale, angular_scale, loss;  ///< momentum at the start, energy lost in the rubber
};
[[nodiscard]] ChainDrift drift_of(const Bushing& bushing, double step);

/// A closed chain turning as a polygon in relative rest: every link feels its centripetal acceleration and nothing
/// else.
struct SpinningPolygon {
  System system;
  State start;
  double force = 0.0;  ///< N, closed form of every joint's force
  Vector3d center = far_from_chassis();
  SpinningPolygon(int num_links, double spin, double step);
  /// Largest distance of a link's linear acceleration from the centripetal one [m/s^2].
  [[nodiscard]] double centripetal_error(const Acceleration& acceleration) const;
  double spin;
};

/// Links of one track, some of them held where they are; no chassis, no second track. Smooth bushings only: their
/// memory is not carried along. All methods start from rest accelerations and leave the state at the end.
class HeldChain {
 public:
  /// `held`: links that never move. Gravity along -z [m/s^2].
  HeldChain(int num_links, const Bushing& bushing, std::vector<int> held, double gravity);

  /// The program's own method with a fixed step [s]; visit(state, work) after every step.
  template <typename Visit>
  void chung_lee(double h, int steps, Visit visit) {
    start();
    for (int i = 0; i < steps; ++i) chung_lee_step(h), visit();
  }
  void chung_lee(double h, int steps) {
    chung_lee(h, steps, [] {});
  }
  /// Classical Runge-Kutta of fourth order; rotations after Munthe-Kaas (1998).
  void runge_kutta(double h, int steps);
  /// Newmark's trapezoidal rule (1959), implicit, on rotations after Bruels & Cardona (2010); solved by
  /// fixed-point iteration, which needs h well below 2 / omega_max.
  void trapezoidal(double h, int steps);
  /// Motion damped at `rate` [1/s] until no link accelerates by more than `small` [m/s^2, also for half a pitch's
  /// rotation]; throws when it does not get there.
  void relax(double h, double rate, double small);

  [[nodiscard]] const Acceleration& accelerate(const State& at);
  [[nodiscard]] LinkMotion link(int i) const { return get_link(state, i); }
  [[nodiscard]] Vector3d joint_force(int i) const { return get_vector(work.joint_force_W, i); }

  System system;
  State state;
  Workspace work;

 private:
  void start();
  void chung_lee_step(double h);
  std::vector<int> held_;
  double damping_ = 0.0;
  State next_;
  Acceleration f_, f_before_, f_found_;
};

/// Largest distance between two states' link centres and orientations, the latter at half a pitch [m].
[[nodiscard]] double distance(const HeldChain& a, const HeldChain& b);

}  // namespace grouser::test
