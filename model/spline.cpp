#include "model/spline.h"

#include <cmath>

namespace grouser {
namespace {

/// Cubic of piece i in powers of u = x - displacement[i].
struct Piece {
  double c0, c1, c2, c3, width;
};

Piece piece_of(const SpringSpline& spring, std::size_t i) {
  const double width = spring.displacement[i + 1] - spring.displacement[i];
  const double secant = (spring.force[i + 1] - spring.force[i]) / width;
  const double s0 = spring.slope[i], s1 = spring.slope[i + 1];
  return {spring.force[i], s0, (3.0 * secant - 2.0 * s0 - s1) / width, (s0 + s1 - 2.0 * secant) / (width * width),
          width};
}

double integral(const Piece& p, double u) { return u * (p.c0 + u * (p.c1 / 2.0 + u * (p.c2 / 3.0 + u * p.c3 / 4.0))); }

/// Integral of the force from the first knot to x.
double integral_from_first_knot(const SpringSpline& spring, double x) {
  const auto& knots = spring.displacement;
  const std::size_t last = knots.size() - 1;
  if (x <= knots[0]) {
    const double u = x - knots[0];
    return u * (spring.force[0] + 0.5 * spring.slope[0] * u);
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < last; ++i) {
    const Piece piece = piece_of(spring, i);
    if (x <= knots[i + 1]) return sum + integral(piece, x - knots[i]);
    sum += integral(piece, piece.width);
  }
  const double u = x - knots[last];
  return sum + u * (spring.force[last] + 0.5 * spring.slope[last] * u);
}

}  // namespace

SpringSpline SpringSpline::linear(double stiffness, double range) {
  return {{-range, range}, {-stiffness * range, stiffness * range}, {stiffness, stiffness}};
}

std::vector<double> fritsch_carlson_slopes(const std::vector<double>& x, const std::vector<double>& y) {
  const std::size_t last = x.size() - 1;
  std::vector<double> secant(last), slope(x.size());
  for (std::size_t i = 0; i < last; ++i) secant[i] = (y[i + 1] - y[i]) / (x[i + 1] - x[i]);
  slope.front() = secant.front();
  slope.back() = secant.back();
  for (std::size_t i = 1; i < last; ++i) {
    slope[i] = secant[i - 1] * secant[i] > 0.0 ? 0.5 * (secant[i - 1] + secant[i]) : 0.0;
  }
  for (std::size_t i = 0; i < last; ++i) {
    if (secant[i] == 0.0) {
      slope[i] = slope[i + 1] = 0.0;
      continue;
    }
    // Sufficient for monotony: (alpha, beta) inside the circle of radius 3.
    const double alpha = slope[i] / secant[i], beta = slope[i + 1] / secant[i];
    const double radius = std::hypot(alpha, beta);
    if (radius > 3.0) {
      slope[i] = 3.0 * alpha / radius * secant[i];
      slope[i + 1] = 3.0 * beta / radius * secant[i];
    }
  }
  return slope;
}

double stored_energy(const SpringSpline& spring, double x) {
  return integral_from_first_knot(spring, x) - integral_from_first_knot(spring, 0.0);
}

double largest_slope(const SpringSpline& spring, double low, double high) {
  double largest = std::max(evaluate(spring, low).slope, evaluate(spring, high).slope);
  for (std::size_t i = 0; i < spring.displacement.size(); ++i) {
    const double knot = spring.displacement[i];
    if (knot >= low && knot <= high) largest = std::max(largest, spring.slope[i]);
    if (i + 1 == spring.displacement.size()) break;
    const Piece piece = piece_of(spring, i);
    const double u = piece.c3 != 0.0 ? -piece.c2 / (3.0 * piece.c3) : -1.0;  // vertex of the slope's parabola
    if (u > 0.0 && u < piece.width && knot + u >= low && knot + u <= high) {
      largest = std::max(largest, piece.c1 + u * (2.0 * piece.c2 + 3.0 * u * piece.c3));
    }
  }
  return largest;
}

}  // namespace grouser
