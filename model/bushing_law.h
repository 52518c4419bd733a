#pragma once
#include <cmath>

#include "model/bushing.h"

/// The law of one bushing axis: f = spring(x) + sum of stops + sum of Maxwell branches + c x_dot, acting against x.
/// (Paper eq. 7 with a spline in place of K, and with friction stops and Maxwell branches in place of one constant C,
/// because a damper taken from a slow loop is wrong by orders of magnitude at link-passing frequency; D 1.6, 6.1.)
/// The simulator and the fit both call these functions.
namespace grouser {

/// Elastic deflection of a stop (Jenkins element) after the displacement grew by dx: exact for any monotone step,
/// passive. z, yield [m]; the element's force is stiffness * z.
template <typename T>
[[nodiscard]] inline T advance_stop(const T& z, const T& dx, const T& yield) {
  const T trial = z + dx;
  return trial > yield ? yield : (trial < -yield ? -yield : trial);
}

/// Constants of a Maxwell branch for one step of length h: force' = decay * force + gain * dx, exact for a constant
/// rate.
struct MaxwellStep {
  double decay = 1.0;  ///< exp(-h / tau)
  double gain = 0.0;   ///< stiffness * (1 - exp(-h/tau)) * tau / h [N/m]; -> stiffness for h -> 0
};
[[nodiscard]] inline MaxwellStep maxwell_step(const MaxwellBranch& branch, double h) {
  const double ratio = h / branch.relaxation_time;
  const double lost = -std::expm1(-ratio);
  return {1.0 - lost, ratio > 1e-12 ? branch.stiffness * lost / ratio : branch.stiffness};
}

/// Energy that a Maxwell branch turns into heat over one step of constant rate [J], >= 0 up to round-off.
/// Work done on the branch less the growth of its stored energy force^2 / (2 stiffness).
[[nodiscard]] inline double maxwell_dissipation(const MaxwellBranch& branch, double force, double next_force, double dx,
                                                double h) {
  const double ratio = h / branch.relaxation_time;
  const double gain_free = ratio > 0.0 ? -std::expm1(-ratio) / ratio : 1.0;
  const double steady = branch.stiffness * dx / ratio;  // force the branch would settle at: k tau dx / h
  const double work = dx * (steady + (force - steady) * gain_free);
  return work - 0.5 * (next_force * next_force - force * force) / branch.stiffness;
}

}  // namespace grouser
