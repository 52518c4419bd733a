#pragma once
#include "identification/axis_fit.h"
#include "model/fit.h"

namespace grouser {

/// Fills parameters, covariance, condition number, backbone and tangent bands and what cannot be identified.
/// Errors are common to all samples of a test (remounting gain, left-over conditioning), so everything rests on tests
/// as replicates: parameters by the sandwich over tests; bands by a Bayesian bootstrap over tests (exponential weights,
/// each draw a non-negative fit) widened by the spread over random dictionaries, because the split between spring,
/// large stops and slow branches is a choice of the grid (I 2). Deterministic: fixed seed.
void estimate_uncertainty(const AxisData& data, const AxisSolution& solution, AxisFit& fit);

}  // namespace grouser
