#pragma once
#include <cmath>

#include "model/bushing.h"

/// The law of one bushing axis: f = spring(x) + sum of stops + sum of Maxwell branches + c x_dot, acting against x.
/// (Paper eq. 7 with a spline in place of K, and with friction stops and Maxwell branches in place of one constant C,
/// because a damper taken from a slow loop is wrong by orders of magnitude at link-passing frequency; D 1.6, 6.1.)
/// The simulator and the fit both call these functions.
namespace grouser {

/// Elastic deflection of a stop (Jenkins element) after the displacement grew by dx: exact for any monotone step,
/// passive. z, yield [m]; the element's force is stiffness * z. T is double, ceres::Jet or an Eigen array of several
/// bushings.
template <typename T, typename Yield>
[[nodiscard]] inline T advance_stop(const T& z, const T& dx, const Yield& yield) {
  const T trial = z + dx;
  if constexpr (requires { trial.min(yield); }) {
    return trial.min(yield).max(-yield);
  } else {
    return trial > yield ? T(yield) : (trial < -yield ? T(-yield) : trial);
  }
}

/// By what factor the yields of an axis have grown at displacement x: 1 + b x^2, b = AxisLaw::yield_growth >= 0 (I 1).
/// A step to x slips at its end: z <- advance_stop(z, dx, yield * yield_scale(b, x)). x is the displacement that the
/// axis' spring sees. Passive for any path: a shrinking yield only discards stored energy. T, B: double, ceres::Jet or
/// an Eigen array.
template <typename B, typename T>
[[nodiscard]] inline auto yield_scale(const B& growth, const T& x) {
  if constexpr (requires { x.square(); }) {
    return T(1.0 + growth * x.square());
  } else {
    return 1.0 + growth * x * x;
  }
}

/// How far a stop slipped in a step. It turns stiffness * yield * |slip| into heat, which is stiffness * next_z * slip,
/// for a slipping stop ends at its yield. A yield that grows counts with the mean of before and after: then work =
/// growth of storage + loss holds with the trapezoid of the force over every sliding step, of second order in the step.
template <typename T>
[[nodiscard]] inline T stop_slip(const T& z, const T& next_z, const T& dx) {
  return (z + dx) - next_z;
}

/// Constants of a Maxwell branch for one step of length h: force' = decay * force + gain * dx, exact for a constant
/// rate. Its work over the step is dx * (work_per_way * dx + gain_share * force), its energy compliance * force^2;
/// the difference of work and growth of energy is its loss.
struct MaxwellStep {
  double decay = 1.0;         ///< exp(-h / tau)
  double gain = 0.0;          ///< stiffness * gain_share [N/m]
  double gain_share = 1.0;    ///< (1 - exp(-h/tau)) * tau / h; -> 1 for h -> 0
  double work_per_way = 0.0;  ///< stiffness * (1 - gain_share) * tau / h [N/m]; -> stiffness / 2 for h -> 0
  double compliance = 0.0;    ///< 1 / (2 stiffness) [m/N]
};
[[nodiscard]] inline MaxwellStep maxwell_step(const MaxwellBranch& branch, double h) {
  const double k = branch.stiffness, ratio = h / branch.relaxation_time;
  const double lost = -std::expm1(-ratio);
  const bool some = ratio > 1e-12;
  const double share = some ? lost / ratio : 1.0;
  return {1.0 - lost, k * share, share, some ? k * (1.0 - share) / ratio : 0.5 * k, 0.5 / k};
}

}  // namespace grouser
