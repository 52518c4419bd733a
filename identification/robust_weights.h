#pragma once
#include "identification/axis_problem.h"

namespace grouser {

/// Gives every test its say (DataBlock::robust_weight) by its own error s: the square root of its mean squared error in
/// units of noise and model error, under a law fitted to all tests on the full dictionary, so that no test pays for
/// what a small law cannot do. weight = min(1, (3 m / s)^2) with m the median of s over the tests, at least 0.5
/// (nobody loses say for an error below 1.5 % of its force range); iterated to its fixed point. This is least squares
/// up to three times the typical test's error, and beyond grows like a logarithm (Huber 1981, ch. 7; the tail of
/// Cauchy's loss): a mounting whose gain is wrong by 30 % keeps about 1 % of its say.
/// Fewer than four tests cannot outvote one: all keep weight 1.
void weigh_tests(AxisData& data);

}  // namespace grouser
