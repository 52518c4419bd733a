#pragma once
#include <Eigen/Core>
#include <vector>

#include "identification/block_moments.h"

namespace grouser {

/// Errors of a law on data that it was not fitted to: one after the other, each test is left out (Gram subtraction:
/// total less its own moments), the coefficients are fitted to all the others, and the test is predicted. With a single
/// test its amplitude blocks or cycles take the tests' place; with a single block there is nothing to leave out.
/// Yields, relaxation times and growth stay those of the whole data.
struct LeftOut {
  std::vector<double> cost;   ///< of each of replicates(): mean squared error of force and energy in their units
  std::vector<double> nrmse;  ///< force alone, fraction of the force range
};

/// `blocks`: moments of `dictionary`, with or without derivatives; `free`: coefficients > 0 of the fit to all data.
[[nodiscard]] LeftOut leave_one_out(const AxisData& data, const Dictionary& dictionary,
                                    const std::vector<BlockMoments>& blocks, const std::vector<int>& free);

/// Robust mean over the tests, as a fraction of the force range; energy errors count in the proportion of
/// k_model_error to k_energy_unit. The loss log(1 + cost) lets no single test, such as the largest amplitude, which
/// only extrapolation reaches, decide alone. 0 with nothing to leave out.
[[nodiscard]] double left_out_error(const LeftOut& left_out);

/// True when `a` predicts worse than `b` by more than one standard error of the difference, test by test (the
/// one-standard-error rule of Breiman et al. 1984, paired because all candidates meet the same tests), and by more than
/// 1 % of the error. A test counts no more than with a doubled squared error, so that none decides alone.
[[nodiscard]] bool clearly_worse(const LeftOut& a, const LeftOut& b);

}  // namespace grouser
