#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

namespace grouser {

/// Force over displacement as a piecewise cubic Hermite curve; outside its knots a straight line with the end slope.
/// Units: N over m for translation, N m over rad for rotation.
struct SpringSpline {
  std::vector<double> displacement;  ///< strictly increasing, at least 2
  std::vector<double> force;         ///< same length
  std::vector<double> slope;         ///< same length; see fritsch_carlson_slopes()

  /// A linear spring through the origin, valid over [-range, range].
  [[nodiscard]] static SpringSpline linear(double stiffness, double range);
};

/// Value, slope and stored energy of a spring at one displacement.
template <typename T>
struct SpringValue {
  T force;  ///< N or N m
  T slope;  ///< N/m or N m/rad
};

/// Monotone slopes for Hermite interpolation (Fritsch & Carlson 1980, SIAM J. Numer. Anal. 17:238).
[[nodiscard]] std::vector<double> fritsch_carlson_slopes(const std::vector<double>& x, const std::vector<double>& y);

/// Spring force and tangent at displacement x. T is double in a run and ceres::Jet in a fit.
template <typename T>
[[nodiscard]] SpringValue<T> evaluate(const SpringSpline& spring, const T& x) {
  const auto& knots = spring.displacement;
  const std::size_t last = knots.size() - 1;
  if (x <= T(knots[0])) return {T(spring.force[0]) + (x - T(knots[0])) * spring.slope[0], T(spring.slope[0])};
  if (x >= T(knots[last])) {
    return {T(spring.force[last]) + (x - T(knots[last])) * spring.slope[last], T(spring.slope[last])};
  }
  std::size_t i = 0;
  for (std::size_t hi = last; hi - i > 1;) {
    const std::size_t mid = (i + hi) / 2;
    (x < T(knots[mid]) ? hi : i) = mid;
  }
  const double width = knots[i + 1] - knots[i];
  const double rise = spring.force[i + 1] - spring.force[i];
  const double c2 = (3.0 * rise / width - 2.0 * spring.slope[i] - spring.slope[i + 1]) / width;
  const double c3 = (spring.slope[i] + spring.slope[i + 1] - 2.0 * rise / width) / (width * width);
  const T u = x - T(knots[i]);
  return {T(spring.force[i]) + u * (T(spring.slope[i]) + u * (T(c2) + u * c3)),
          T(spring.slope[i]) + u * (T(2.0 * c2) + u * (3.0 * c3))};
}

/// Energy stored between displacement 0 and x [J], exact for each cubic piece and for the straight ends.
[[nodiscard]] double stored_energy(const SpringSpline& spring, double x);

/// Largest tangent stiffness over [low, high] (the knots inside and the ends; pieces are checked at their extremum).
[[nodiscard]] double largest_slope(const SpringSpline& spring, double low, double high);

}  // namespace grouser
