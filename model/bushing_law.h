#pragma once
#include <cmath>
#include <type_traits>

#include "model/bushing.h"

/// The law of one bushing axis: f = spring(x) + sum of stops + sum of Maxwell branches + c x_dot, acting against x.
/// (Paper eq. 7 with a spline in place of K, and with friction stops and Maxwell branches in place of one constant C,
/// because a damper taken from a slow loop is wrong by orders of magnitude at link-passing frequency.)
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
/// What a branch has relaxed by after x = h / tau >= 0: 1 - e^-x, that over x, and what the latter lacks of 1 over x.
/// T: double, or several branches at once.
template <typename T>
struct Relaxation {
  T lost, share, rest;
};
template <typename T>
[[nodiscard]] inline Relaxation<T> relaxation(const T& x) {
  using std::exp;
  constexpr double k_short = 0.25;  // the series of the rest ends below round-off there; 1 - e^-x cancels little beyond
  T rest = 1.0 / 479001600.0;
  for (const double factorial : {39916800.0, 3628800.0, 362880.0, 40320.0, 5040.0, 720.0, 120.0, 24.0, 6.0, 2.0})
    rest = 1.0 / factorial - x * rest;
  const T share = 1.0 - x * rest;
  const Relaxation<T> soon{x * share, share, rest};
  const auto after = [](const T& long_x) -> Relaxation<T> {
    const T lost = 1.0 - exp(-long_x), of_way = lost / long_x;
    return {lost, of_way, (1.0 - of_way) / long_x};
  };
  if constexpr (std::is_floating_point_v<T>) {
    return x < k_short ? soon : after(x);
  } else {
    const auto is_short = x < k_short;
    const Relaxation<T> late = after(x.max(k_short));
    return {choose(is_short, soon.lost, late.lost), choose(is_short, soon.share, late.share),
            choose(is_short, soon.rest, late.rest)};
  }
}
[[nodiscard]] inline MaxwellStep maxwell_step(double stiffness, const Relaxation<double>& relaxed) {
  return {1.0 - relaxed.lost, stiffness * relaxed.share, relaxed.share, stiffness * relaxed.rest, 0.5 / stiffness};
}
[[nodiscard]] inline MaxwellStep maxwell_step(const MaxwellBranch& branch, double h) {
  return maxwell_step(branch.stiffness, relaxation(h / branch.relaxation_time));
}

}  // namespace grouser
