#pragma once
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

/// Left side less right side of the restitution relation (1 + e) a v = ln[(1 + a v) / (1 - e a v)] (D 5.1).
inline double restitution_defect(double e, double av) { return (1.0 + e) * av - std::log((1.0 + av) / (1.0 - e * av)); }

/// Joint force of a free closed chain of n rigid links turning at w, joints of isotropic stiffness k (D 7.2, with the
/// joint's own gap: centre radius p / (2 tan) + s / (2 sin), s = T / k).
inline double spinning_polygon_force(int n, double pitch, double mass, double w, double k) {
  const double half = k_pi / n, mw2 = mass * w * w;
  return mw2 * pitch / (4.0 * std::sin(half) * std::tan(half)) /
         (1.0 - mw2 / (4.0 * k * std::sin(half) * std::sin(half)));
}

}  // namespace grouser::test
