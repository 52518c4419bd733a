#pragma once
#include <Eigen/Eigenvalues>
#include <cmath>
#include <complex>

#include "simulator/integrator.h"

/// The program's integrator on one degree of freedom.
namespace grouser::test {

/// Chung-Lee on one scalar, from f_{-1} = f_0; acceleration = force(t, u, v).
template <typename Force>
class ScalarRun {
 public:
  ScalarRun(double beta, Force force, double u0, double v0) : beta_(beta), force_(force), u(u0), v(v0) {
    before_ = force_(0.0, u, v);
  }
  void step(double h) {
    const StepWeights w = step_weights(beta_, h, previous_h_ > 0.0 ? previous_h_ : h);
    const double now = force_(t, u, v);
    u += h * v + w.position_now * now + w.position_before * before_;
    v += w.velocity_now * now + w.velocity_before * before_;
    before_ = now;
    previous_h_ = h;
    t += h;
  }

 private:
  double beta_;
  Force force_;
  double before_ = 0.0, previous_h_ = 0.0;

 public:
  double t = 0.0, u, v;
};

/// One step of u'' + 2 damping u' + u = 0 as a matrix on (u, v, f of the last step).
inline Eigen::Matrix3d step_matrix(double beta, double damping, double h, double previous_h) {
  const StepWeights w = step_weights(beta, h, previous_h);
  Eigen::Matrix3d A;
  const Eigen::RowVector3d f(-1.0, -2.0 * damping, 0.0);
  A.row(0) = Eigen::RowVector3d(1.0, h, w.position_before) + w.position_now * f;
  A.row(1) = Eigen::RowVector3d(0.0, 1.0, w.velocity_before) + w.velocity_now * f;
  A.row(2) = f;
  return A;
}
inline double spectral_radius(const Eigen::Matrix3d& A) { return A.eigenvalues().cwiseAbs().maxCoeff(); }

/// What a step does to a free oscillation: the root that turns, against exp(i h).
struct Amplification {
  double radius = 0.0;        ///< |E| of the principal pair
  double damping = 0.0;       ///< of the oscillation that comes out
  double period_error = 0.0;  ///< (its period - the true one) / the true one
};
inline Amplification amplification(double beta, double damping, double h) {
  const Eigen::Vector3cd roots = step_matrix(beta, damping, h, h).eigenvalues();
  std::complex<double> principal = roots[0];
  for (const std::complex<double>& root : roots) {
    if (root.imag() > principal.imag()) principal = root;
  }
  const double turned = std::arg(principal), shrunk = -std::log(std::abs(principal));
  const double frequency = std::hypot(turned, shrunk) / h;
  return {std::abs(principal), shrunk / (frequency * h), h / turned - 1.0};
}

/// Smallest h (omega = 1) above `from` at which steps h, h / ratio, h, ... let a free oscillation grow.
inline double stability_limit(double beta, double damping, double ratio, double from, double to) {
  const auto grows = [&](double h) {
    const Eigen::Matrix3d A = step_matrix(beta, damping, h / ratio, h) * step_matrix(beta, damping, h, h / ratio);
    return spectral_radius(A) > 1.0 + 1e-9;
  };
  constexpr double k_scan = 2e-4;
  for (double h = from; h < to; h += k_scan) {
    if (!grows(h)) continue;
    double stable = h - k_scan, unstable = h;
    for (int i = 0; i < 40; ++i) (grows(0.5 * (stable + unstable)) ? unstable : stable) = 0.5 * (stable + unstable);
    return unstable;
  }
  return to;
}

}  // namespace grouser::test
