#pragma once
#include "simulator/integrator.h"
#include "simulator/workspace.h"

namespace grouser {

/// M^t q'' = Q^t (paper eq. 6), block diagonal: accelerations of all links from the force sums; kinetic and gravity
/// energy.
void link_accelerations(const System& system, const AssemblyKnobs& knobs, const State& state, Workspace& work,
                        Acceleration& acceleration);

/// Chung-Lee update of all links. Orientation: q <- q exp(dtheta) with dtheta from the position formula in body axes.
/// Returns the largest turn of a link in the step [rad].
double advance_links(const System& system, const StepWeights& weights, const State& now, const Acceleration& f_now,
                     const Acceleration& f_before, State& next);

/// A step's ends: what was found there, and the accelerations at the beginning of the step before.
struct StepEnds {
  const Workspace &work_now, &work_next;
  const Acceleration &f_before, &f_now, &f_next;
};
struct LocalError {
  double ratio = 0.0;  ///< error / tolerance, maximum norm
  int link = -1;       ///< link array index
};
struct LinkVerdict {
  /// Largest embedded error of any link over its tolerance, and whose it is, where all accelerations are numbers.
  /// Rotation counts as the speed of a point half a pitch away.
  LocalError error;
  /// What contacts took from the links over the paths that they went, less the trapezoid of the powers at both ends
  /// [J]. Chung-Lee's velocity errs by 5/12 h^2 times the rate of the acceleration, so that powers of dampers, which go
  /// with its square, are too large wherever links vibrate; the mean force times the way is the very work that the step
  /// does.
  double contact_step_loss = 0.0;
};
/// Both in one pass, for both are made of the same accelerations.
[[nodiscard]] LinkVerdict judge_links(const System& system, const ErrorWeights& errors, const StepWeights& step,
                                      const StepEnds& ends);

}  // namespace grouser
