#pragma once
#include <vector>

#include "identification/axis_problem.h"
#include "model/bushing.h"

namespace grouser {

inline constexpr int k_num_draws = 60;  ///< 60 to 120 (I 2)

/// Laws as likely as the fitted one, each a physical law of at most 7 stops and 7 branches that a run can use. One
/// draw:
/// - a random say of every test (Bayesian bootstrap, Rubin 1981, Ann. Stat. 9:130): remounting gain, left-over
///   conditioning and drift are common to all samples of a test, so tests are the replicates (I 2);
/// - a random dictionary (one of every two neighbours of a fine grid of yields and times; knots; yield growth), because
///   the split between spring, large stops and slow branches is a choice of the grid;
/// - non-negative least squares; then elements are taken away, the least missed first.
/// `nominal`: the fitted dictionary, whose spring and yield growth the draws vary. Deterministic in the seed.
[[nodiscard]] std::vector<AxisLaw> draw_laws(const AxisData& data, const Dictionary& nominal, unsigned seed);

}  // namespace grouser
