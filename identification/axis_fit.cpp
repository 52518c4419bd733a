#include "identification/axis_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "identification/nnls.h"
#include "identification/polish.h"
#include "model/errors.h"

namespace grouser {
namespace {

constexpr int k_spring_intervals = 14;  // 12 to 16 (I 3)
constexpr int k_full_stops = 12, k_full_branches = 10;
constexpr int k_stops = 4,
              k_branches = 4;  // each costs time in every step of a run; 4 + 4 fit as well as 12 + 10 (I 5.5)
constexpr double k_smallest_yield = 0.08;  // of the smallest amplitude
constexpr double k_largest_yield = 0.6;    // of the largest amplitude
constexpr double k_prune = 1e-3;           // of the total stiffness of its kind
constexpr double k_unnoticed = 0.05;       // growth of the cost, which is mostly noise and model error, by a merger
constexpr double k_least_frequency_ratio = 1.5;  // one frequency cannot tell a branch from a stop
constexpr double k_kkt_limit = 1e-6;

std::vector<double> geometric(double low, double high, int count) {
  std::vector<double> grid;
  for (int i = 0; i < count; ++i) {
    grid.push_back(low * std::pow(high / low, count > 1 ? static_cast<double>(i) / (count - 1) : 0.5));
  }
  return grid;
}

struct Element {
  double place = 0.0, stiffness = 0.0;  // yield or relaxation time
};

// Ward's merging on the log axis: the neighbours whose union moves the least stiffness the least far become one.
std::vector<double> merge_to(std::vector<Element> elements, std::size_t count) {
  double total = 0.0;
  for (const Element& element : elements) total += element.stiffness;
  std::erase_if(elements, [&](const Element& e) { return e.stiffness <= k_prune * total; });
  while (elements.size() > count) {
    std::size_t best = 0;
    double least = -1.0;
    for (std::size_t i = 0; i + 1 < elements.size(); ++i) {
      const double k1 = elements[i].stiffness, k2 = elements[i + 1].stiffness;
      const double distance = std::log(elements[i + 1].place / elements[i].place);
      const double cost = k1 * k2 / (k1 + k2) * distance * distance;
      if (least < 0.0 || cost < least) least = cost, best = i;
    }
    Element& a = elements[best];
    const Element& b = elements[best + 1];
    const double sum = a.stiffness + b.stiffness;
    a = {std::exp((a.stiffness * std::log(a.place) + b.stiffness * std::log(b.place)) / sum), sum};
    elements.erase(elements.begin() + static_cast<std::ptrdiff_t>(best) + 1);
  }
  std::vector<double> places;
  for (const Element& element : elements) places.push_back(element.place);
  return places;
}

Eigen::VectorXd solve(const Eigen::MatrixXd& moments, const Dictionary& dictionary) {
  const int n = dictionary.num_linear();
  return solve_nnls(moments.topLeftCorner(n, n), moments.col(moments.cols() - 1).head(n)).x;
}

// At most so many elements that stand for all of the dictionary's.
Dictionary condense(const Dictionary& full, const Eigen::VectorXd& coefficients, std::size_t num_stops,
                    std::size_t num_branches) {
  std::vector<Element> stops, branches;
  Eigen::Index at = full.spring.size();
  for (const double yield : full.yields) stops.push_back({yield, coefficients(at++)});
  for (const double time : full.relaxation_times) branches.push_back({time, coefficients(at++)});
  return {full.spring, merge_to(stops, num_stops), merge_to(branches, num_branches)};
}

// Leaves out elements without stiffness and sorts the rest, coefficients with them.
void tidy(AxisSolution& solution) {
  const AxisLaw law = make_law(solution.dictionary, solution.coefficients);
  std::vector<FrictionStop> stops = law.stops;
  std::vector<MaxwellBranch> branches = law.branches;
  std::ranges::sort(stops, {}, &FrictionStop::yield);
  std::ranges::sort(branches, {}, &MaxwellBranch::relaxation_time);
  Dictionary kept{solution.dictionary.spring, {}, {}};
  for (const FrictionStop& stop : stops) kept.yields.push_back(stop.yield);
  for (const MaxwellBranch& branch : branches) kept.relaxation_times.push_back(branch.relaxation_time);
  solution.dictionary = std::move(kept);
}

PolishBounds bounds_of(const Dictionary& full) {
  PolishBounds bounds;
  if (!full.yields.empty()) {
    bounds.yield_low = full.yields.front();
    bounds.yield_high = full.yields.back();
  }
  if (!full.relaxation_times.empty()) {
    bounds.time_low = full.relaxation_times.front();
    bounds.time_high = full.relaxation_times.back();
  }
  return bounds;
}

void settle_coefficients(const AxisData& data, AxisSolution& solution) {
  const Dictionary& dictionary = solution.dictionary;
  solution.coefficients = solve(weighted_sum(block_moments(data, dictionary, false), {}, dictionary), dictionary);
}

// Yields and times at their optimum, with the coefficients that belong to them.
AxisSolution refine(const AxisData& data, const PolishBounds& bounds, Dictionary start) {
  AxisSolution solution{std::move(start), {}, {}};
  solution.summary = refine_nonlinear(data, bounds, solution.dictionary);
  settle_coefficients(data, solution);
  tidy(solution);
  settle_coefficients(data, solution);
  return solution;
}

// Merges neighbours as long as the data hardly notice: two branches that no test tells apart cost time in every step of
// a run and leave neither of them identified.
AxisSolution simplify(const AxisData& data, const PolishBounds& bounds, AxisSolution solution) {
  const double budget = (1.0 + k_unnoticed) * solution.summary.final_cost;
  for (bool merged = true; merged;) {
    merged = false;
    for (const bool of_branches : {true, false}) {
      const std::size_t stops = solution.dictionary.yields.size(),
                        branches = solution.dictionary.relaxation_times.size();
      if ((of_branches ? branches : stops) < 2) continue;
      AxisSolution simpler = refine(data, bounds,
                                    condense(solution.dictionary, solution.coefficients, stops - (of_branches ? 0 : 1),
                                             branches - (of_branches ? 1 : 0)));
      simpler.summary.iterations += solution.summary.iterations;
      if (simpler.summary.final_cost > budget) continue;
      solution = std::move(simpler);
      merged = true;
    }
  }
  return solution;
}

}  // namespace

Eigen::MatrixXd weighted_sum(const std::vector<Eigen::MatrixXd>& blocks, const std::vector<double>& weights,
                             const Dictionary& dictionary) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(blocks.front().rows(), blocks.front().cols());
  for (std::size_t b = 0; b < blocks.size(); ++b) sum += (weights.empty() ? 1.0 : weights[b]) * blocks[b];
  regularise(sum, dictionary);
  return sum;
}

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

AxisSolution fit_axis(const AxisData& data) {
  const Dictionary full = full_dictionary(data);
  const Eigen::MatrixXd full_moments = weighted_sum(block_moments(data, full, false), {}, full);
  const double first_cost = full_moments(full_moments.rows() - 1, full_moments.cols() - 1);
  const PolishBounds bounds = bounds_of(full);
  const Dictionary few = condense(full, solve(full_moments, full), k_stops, k_branches);
  AxisSolution solution = simplify(data, bounds, refine(data, bounds, few));
  const SolverSummary joint = polish_jointly(data, bounds, solution.dictionary, solution.coefficients);

  // Ceres alone reports convergence far from the optimum of a non-negative problem (I 3): settle the linear part
  // exactly.
  const Eigen::MatrixXd moments =
      weighted_sum(block_moments(data, solution.dictionary, false), {}, solution.dictionary);
  solution.coefficients = solve(moments, solution.dictionary);
  const Eigen::Index n = solution.coefficients.size();
  solution.summary.iterations += joint.iterations;
  solution.summary.termination = joint.termination;
  solution.summary.initial_cost = 0.5 * first_cost;
  solution.summary.final_cost = joint.final_cost;
  solution.summary.kkt_residual =
      kkt_residual(moments.topLeftCorner(n, n), moments.col(n).head(n), moments(n, n), solution.coefficients);
  if (!(solution.summary.kkt_residual <= k_kkt_limit)) {
    throw NumericalError(fmt::format("fit misses the optimality conditions by {:.3g} (limit {:.1g})",
                                     solution.summary.kkt_residual, k_kkt_limit));
  }
  return solution;
}

}  // namespace grouser
