#pragma once

/// Chung-Lee explicit integrator, variable-step slope form (Chung & Lee 1994, IJNME 37:3961).
/// With f_n the acceleration at t_n, r = h_n / h_{n-1}:
///   v += h [(1 + r/2) f_n - (r/2) f_{n-1}]                      (second-order Adams-Bashforth)
///   d += h v_n + h^2 [f_n / 2 + (beta - 1/2) r (f_n - f_{n-1})]
/// One force evaluation a step. beta = 1 is the central difference method, 28/27 the most dissipative.
namespace grouser {

struct StepWeights {
  double h = 0.0;                ///< s
  double velocity_now = 0.0;     ///< of f_n in v
  double velocity_before = 0.0;  ///< of f_{n-1}
  double position_now = 0.0;     ///< of f_n in d
  double position_before = 0.0;
};
[[nodiscard]] StepWeights step_weights(double beta, double h, double previous_h);

/// Factors of the embedded local error estimates: e_v = velocity |f_{n+1} - f_n - r (f_n - f_{n-1})|,
/// e_d = position max(r |f_n - f_{n-1}|, |f_{n+1} - f_n|).
struct ErrorWeights {
  double ratio = 1.0;     ///< r
  double velocity = 0.0;  ///< s
  double position = 0.0;  ///< s^2
};
[[nodiscard]] ErrorWeights error_weights(double beta, double h, double previous_h);

/// Largest stable step of u'' + s1 u' + s2 u = 0: (4 beta - 3) s2 h^2 + 4 s1 h = 4; s.
[[nodiscard]] double stable_step(double beta, double s2, double s1);

}  // namespace grouser
