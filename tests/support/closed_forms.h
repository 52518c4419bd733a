#pragma once
#include <Eigen/Eigenvalues>
#include <cmath>
#include <complex>

#include "model/geometry.h"

/// Answers known on paper. D numbers: the section of the project's domain notes a formula stands in.
namespace grouser::test {

/// u'' + 2 damping omega u' + omega^2 u = force cos(drive t) from u0, v0: displacement and velocity at t.
struct Oscillator {
  double omega = 1.0, damping = 0.0;
  double force = 0.0, drive = 1.0;
  double u0 = 1.0, v0 = 0.0;

  struct Motion {
    double u, v;
  };
  [[nodiscard]] double acceleration(double t, double u, double v) const {
    return force * std::cos(drive * t) - 2.0 * damping * omega * v - omega * omega * u;
  }
  [[nodiscard]] Motion at(double t) const {
    using Complex = std::complex<double>;
    const Complex i(0.0, 1.0);
    const Complex steady = force / Complex(omega * omega - drive * drive, 2.0 * damping * omega * drive);
    const Complex decay(-damping * omega, omega * std::sqrt(1.0 - damping * damping));
    // free part Re(c e^{decay t}) with c chosen for u0, v0
    const double u = u0 - steady.real(), v = v0 - (i * drive * steady).real();
    const Complex c(u, (decay.real() * u - v) / decay.imag());
    const Complex free = c * std::exp(decay * t), forced = steady * std::exp(i * drive * t);
    return {(free + forced).real(), (decay * free + i * drive * forced).real()};
  }
};

/// Left side less right side of the restitution relation (1 + e) a v = ln[(1 + a v) / (1 - e a v)].
inline double restitution_defect(double e, double av) { return (1.0 + e) * av - std::log((1.0 + av) / (1.0 - e * av)); }

/// Area of the loop of a stop whose yield is r(x) = r (1 + b x^2), |dr/dx| < 1, at the amplitude X: it leaves the turn
/// with z = -r(X), meets r(x) at x_s + X - r(X) = r(x_s) and slides to X: 2 k (integral of r dx - (r^2)/2) from x_s to
/// X.
inline double growing_stop_area(double k, double r, double b, double amplitude) {
  const auto yield = [&](double x) { return r * (1.0 + b * x * x); };
  const double linear = amplitude - yield(amplitude) - r;  // r b x_s^2 - x_s - linear = 0
  const double meets = (1.0 - std::sqrt(1.0 + 4.0 * r * b * linear)) / (2.0 * r * b);
  const auto primitive = [&](double x) { return r * (x + b * x * x * x / 3.0) - 0.5 * yield(x) * yield(x); };
  return 2.0 * k * (primitive(amplitude) - primitive(meets));
}

/// Joint force of a free closed chain of n rigid links turning at w, joints of isotropic stiffness k (with the
/// joint's own gap: centre radius p / (2 tan) + s / (2 sin), s = T / k).
inline double spinning_polygon_force(int n, double pitch, double mass, double w, double k) {
  const double half = k_pi / n, mw2 = mass * w * w;
  return mw2 * pitch / (4.0 * std::sin(half) * std::tan(half)) /
         (1.0 - mw2 / (4.0 * k * std::sin(half) * std::sin(half)));
}

/// A chain of n equal rigid links hanging between two fixed pins of one height, joints without bending stiffness and of
/// isotropic stiffness k: joint i carries the horizontal force H and the weight of half the links less i, gives way by
/// force / k, and each link lies along the mean of its two joints' forces.
struct HangingChain {
  double span = 0.0;  ///< m, between the pins
  double sag = 0.0;   ///< m, of the middle; n is even
};
inline HangingChain hanging_chain(int n, double pitch, double link_weight, double k, double horizontal) {
  const auto vertical = [&](int joint) { return link_weight * (0.5 * n - joint); };  // falling towards the middle
  HangingChain chain;
  chain.span = (n + 1) * horizontal / k;
  for (int i = 0; i <= n / 2; ++i) chain.sag += (i < n / 2 ? 1.0 : 0.5) * vertical(i) / k;
  for (int i = 0; i < n; ++i) {
    const double slope = std::atan2(0.5 * (vertical(i) + vertical(i + 1)), horizontal);
    chain.span += pitch * std::cos(slope);
    if (i < n / 2) chain.sag += pitch * std::sin(slope);
  }
  return chain;
}
/// Its horizontal force when the pins are `span` apart; tension between 0 and `most` [N].
inline double hanging_chain_force(int n, double pitch, double link_weight, double k, double span, double most) {
  double low = 1e-6 * most, high = most;
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    (hanging_chain(n, pitch, link_weight, k, middle).span < span ? low : high) = middle;
  }
  return 0.5 * (low + high);
}
/// Sag of an inextensible catenary of weight w a metre: a (cosh(L / 2a) - 1), a = H / w.
inline double catenary_sag(double span, double horizontal, double weight_per_length) {
  const double a = horizontal / weight_per_length;
  return 2.0 * a * std::pow(std::sinh(0.25 * span / a), 2);
}

/// Small vertical and pitching vibration of n rigid links in line under the tension T between two held ones, joints of
/// isotropic stiffness k and no bending stiffness: potential k/2 (gap across)^2 of every joint + T p/2 slope^2 of every
/// link. Unknowns: heights u_1..u_n, then slopes (front pin up) s_1..s_n.
struct TautChain {
  Eigen::VectorXd frequency;  ///< rad/s, rising
  Eigen::MatrixXd mode;       ///< columns (2n), mass-normalised
};
inline TautChain taut_chain(int n, double pitch, double mass, double inertia, double tension, double k) {
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  for (int joint = 0; joint <= n; ++joint) {
    Eigen::VectorXd gap = Eigen::VectorXd::Zero(2 * n);  // height of the rear pin of the link ahead less the groove
    if (joint < n) gap[joint] += 1.0, gap[n + joint] -= 0.5 * pitch;
    if (joint > 0) gap[joint - 1] -= 1.0, gap[n + joint - 1] -= 0.5 * pitch;
    K += k * gap * gap.transpose();
  }
  K.diagonal().tail(n).array() += tension * pitch;
  Eigen::VectorXd M(2 * n);
  M << Eigen::VectorXd::Constant(n, mass), Eigen::VectorXd::Constant(n, inertia);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(K, Eigen::MatrixXd(M.asDiagonal()));
  return {solver.eigenvalues().cwiseSqrt(), solver.eigenvectors()};
}

/// Vibration along a row of n masses between two held ones: 2 sqrt(k/m) sin(j pi / (2 (n + 1))), j = 1..n; a closed row
/// of 2 (n + 1) masses has the same ones.
inline double longitudinal_frequency(int n, int j, double k, double mass) {
  return 2.0 * std::sqrt(k / mass) * std::sin(0.5 * k_pi * j / (n + 1));
}

}  // namespace grouser::test
