#pragma once
#include <vector>

#include "identification/axis_problem.h"
#include "model/bushing.h"

namespace grouser {

inline constexpr int k_num_draws = 60;  ///< 60 to 120 (I 2)

/// Laws as likely as the fitted one, each a physical law of at most 8 stops and 8 branches that a run can use. One
/// draw:
/// - a random say of every test (Bayesian bootstrap, Rubin 1981, Ann. Stat. 9:130): left-over conditioning, drift and
///   what the law cannot do are common to all samples of a test, so tests are the replicates (I 2);
/// - a random gain of every test, normal with the deviation `gain`: the specimen mounted again. The bootstrap alone
/// does
///   not see it, because a law rich enough follows the gain of every mounting; and a random part of what the cycles of
///   the test still soften;
/// - a random dictionary (one of every two neighbours of a fine grid of yields and times; knots; yield growth), because
///   the split between spring, large stops and slow branches is a choice of the grid;
/// - non-negative least squares; then elements are taken away, the least missed first.
/// `nominal`: the fitted dictionary, whose spring and yield growth the draws vary. Deterministic in the seed.
[[nodiscard]] std::vector<AxisLaw> draw_laws(const AxisData& data, const Dictionary& nominal, double gain,
                                             unsigned seed);

}  // namespace grouser
