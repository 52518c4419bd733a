#include "identification/axis_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "identification/law_selection.h"
#include "identification/polish.h"
#include "identification/thin_axis.h"
#include "model/errors.h"

namespace grouser {
namespace {

constexpr int k_spring_intervals = 14;  // 12 to 16 (I 3)
constexpr int k_full_stops = 12, k_full_branches = 10;
constexpr double k_smallest_yield = 0.08;        // of the smallest amplitude
constexpr double k_largest_yield = 0.6;          // of the largest amplitude
constexpr double k_least_frequency_ratio = 1.5;  // one frequency cannot tell a branch from a stop
constexpr double k_kkt_limit = 1e-6;
// Moving any one yield or time gains less than 0.3 % of the cost, far less than one test's share. Not smaller: a yield
// may rest where one more sample starts to slip, and there the derivative jumps.
constexpr double k_gradient_limit = 0.05;

std::vector<double> geometric(double low, double high, int count) {
  std::vector<double> grid;
  for (int i = 0; i < count; ++i) {
    grid.push_back(low * std::pow(high / low, count > 1 ? static_cast<double>(i) / (count - 1) : 0.5));
  }
  return grid;
}

// Twice the cost of no law at all.
double null_cost(const PolishedLaw& law) {
  double sum = 0.0;
  for (const BlockMoments& block : law.moments) {
    const Eigen::Index force = block.force.cols() - 1;
    sum += block.force(force, force) + (block.energy.size() > 0 ? block.energy_weight : 0.0);
  }
  return sum;
}

// All moments are sums of squares of forces.
void require_squares(const AxisData& data) {
  for (const DataBlock& block : data.blocks) {
    const double square = block.force_range * block.force_range, weight = block.row_weight();
    if (std::isfinite(square) && std::isfinite(weight) && weight > 0.0) continue;
    throw NumericalError(
        fmt::format("forces over a range of {:.3g} (SI) have no square that a double can hold: test {}",
                    block.force_range, block.test->source->name));
  }
}

// Ceres alone reports convergence far from the optimum of a non-negative problem (I 3).
void require_optimal(const PolishedLaw& law) {
  if (!law.converged) throw NumericalError("the fit did not converge: " + law.summary.termination);
  if (!(law.summary.kkt_residual <= k_kkt_limit)) {
    throw NumericalError(
        fmt::format("the fit misses the optimality conditions of its coefficients by {:.3g} (limit {:.1g})",
                    law.summary.kkt_residual, k_kkt_limit));
  }
  if (!(law.gradient <= k_gradient_limit)) {
    throw NumericalError(
        fmt::format("the fit misses the optimality conditions of its yields and times by {:.3g} (limit {:.1g})",
                    law.gradient, k_gradient_limit));
  }
  if (!(law.coefficients.maxCoeff() > 0.0)) {
    throw NumericalError(
        "the best law is none: the force falls where the displacement grows, as with swapped columns or a reversed "
        "sensor");
  }
}

}  // namespace

Dictionary full_dictionary(const AxisData& data, double yield_spread, double time_spread, int extra_intervals) {
  const MonotoneBasis spring(data.low, data.high, k_spring_intervals + extra_intervals, data.symmetry);
  Dictionary dictionary{spring, {}, {}};
  if (!data.closed) return dictionary;
  const double largest = k_largest_yield * data.largest_amplitude;
  const double smallest =
      std::min(0.1 * largest, std::max(k_smallest_yield * data.smallest_amplitude, data.noise_displacement));
  dictionary.yields = geometric(smallest / yield_spread, largest, k_full_stops);
  if (data.highest_frequency > k_least_frequency_ratio * data.lowest_frequency && data.lowest_frequency > 0.0) {
    // Faster branches than this are dampers within 1 % and would only be stiff; slower ones cannot be dampers (I 1).
    const double fastest = 1.0 / (20.0 * std::numbers::pi * data.highest_frequency);
    const double slowest = 1.0 / (2.0 * std::numbers::pi * data.lowest_frequency);
    dictionary.relaxation_times = geometric(fastest / time_spread, slowest, k_full_branches);
  }
  return dictionary;
}

AxisSolution fit_axis(const AxisData& data, const PolishOptions& options) {
  require_squares(data);
  const LawChoice choice = choose_law(thin(data).data, options);
  PolishOptions last = options;
  last.gradient_limit = k_gradient_limit;
  PolishedLaw law = polish(data, search_bounds(data), choice.dictionary, last);
  const Dictionary used = used_elements(law.dictionary, law.coefficients);
  if (used.yields != law.dictionary.yields || used.relaxation_times != law.dictionary.relaxation_times) {
    law = polish(data, search_bounds(data), used, last);
  }
  require_optimal(law);

  AxisSolution solution{law.dictionary, law.coefficients, law.summary, choice.candidates, {}, {}};
  solution.summary.starts = choice.starts;
  solution.summary.initial_cost = 0.5 * null_cost(law);
  solution.summary.iterations += choice.iterations;
  solution.left_out_nrmse = leave_one_out(data, law.dictionary, law.moments, law.free).nrmse;
  for (const BlockMoments& block : law.moments) solution.moments.push_back(block.total());
  return solution;
}

}  // namespace grouser
