#pragma once
#include <string>
#include <vector>

#include "tests/validation/convergence_measures.h"

/// Run A at many steps: a ladder of tolerances, a ladder of fixed steps, and the finest of these as the reference.
namespace grouser::validation {

/// One setting of the integrator and the runs made with it, which differ by a nudge of 1 nm/s at the start.
struct Rung {
  std::string name;      ///< "10 mm/s", "40 us"
  double setting = 0.0;  ///< tolerance [m/s] or step [s]
  bool adaptive = true;
  IntegratorOptions options;
  int num_runs = 2;
  std::vector<Measures> runs{};

  [[nodiscard]] double mean(int quantity) const;
  [[nodiscard]] double mean_step() const;  ///< s, in cruise
  [[nodiscard]] double accepted() const;   ///< steps of a run
  [[nodiscard]] double average(double Measures::*field) const;
};

struct Ladder {
  Phases phases;
  std::vector<Rung> tolerances;   ///< coarse to fine; displacement tolerance 1e-3 s times the velocity's
  std::vector<Rung> bounds;       ///< the shipped tolerance with other fractions of the stability bound
  std::vector<Rung> fixed_steps;  ///< coarse to fine; the last is the reference
  std::string chosen;             ///< name of the rung that the shipped run A takes

  /// Tolerances, bounds and fixed steps, in this order.
  [[nodiscard]] std::vector<const Rung*> rungs() const;
  [[nodiscard]] const Rung& reference() const { return fixed_steps.back(); }
  [[nodiscard]] const Rung& tolerance(const std::string& name) const;
  /// Standard deviation of one run over its mean: all rungs' pairs pooled. Chaos makes it; no step takes it away.
  [[nodiscard]] double scatter(int quantity) const;
  /// (rung / reference) - 1.
  [[nodiscard]] double deviation(const Rung& rung, int quantity) const;
  /// What `deviation` may be: the limit of the quantity's kind and two standard errors of the two means compared.
  [[nodiscard]] double allowance(const Rung& rung, int quantity) const;
  /// Quantities of a rung beyond their allowance, and its energy residual; empty where it is fine enough.
  [[nodiscard]] std::vector<std::string> faults(const Rung& rung) const;
};

/// Means to 0.5 %, fluctuations to 5 %, peaks to 2 %: what a design engineer would call the same.
[[nodiscard]] double limit_of(Kind kind);
inline constexpr double k_residual_limit = 2e-4;  ///< of the integral of |sprocket power|

/// Runs all rungs; `say` hears of each.
void climb(const System& system, const Assembled& rest, Ladder& ladder, void (*say)(const std::string&));

}  // namespace grouser::validation
