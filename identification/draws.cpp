#include "identification/draws.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "identification/axis_fit.h"
#include "identification/nnls.h"

namespace grouser {
namespace {

// Chosen on the seeds 5000-5059 of coverage_benchmark, confirmed on 7000-7199. Coverage of energy, loss factor, storage
// stiffness, backbone, tangent: 93 95 98 96 97 % there and 94 94 98 96 96 % on the fresh ones. Coarser grids widen the
// intervals by half; the whole fine grid in every draw covers 80 % of backbone and tangent only.
constexpr int k_fine_stops = 40, k_fine_branches = 32;
constexpr int k_most_stops = 8, k_most_branches = 8;  // 6 + 6 widen the intervals by a quarter
constexpr double k_unnoticed = 0.003;                 // of the cost: what an element must be worth
constexpr double k_grid_overhang = 1.5;               // by what factor grids go below those of the fit
constexpr int k_least_intervals = 4;
// The random say of the tests shows part of their gains already; with the whole variance storage stiffness covers 99 %.
constexpr double k_gain_share = std::numbers::sqrt2 / 2.0;

// Knots and yield growth, relative to the fit's.
struct Variation {
  int more_intervals = 0;
  double growth = 1.0;
};
constexpr std::array k_variations{Variation{-2, 0.7}, Variation{0, 1.0}, Variation{2, 1.4}};

// Uniform in (0, 1), the same on every platform.
double uniform(std::mt19937_64& random) { return (static_cast<double>(random() >> 11) + 0.5) * 0x1p-53; }
double normal(std::mt19937_64& random) {
  const double radius = std::sqrt(-2.0 * std::log(uniform(random)));
  return radius * std::cos(2.0 * std::numbers::pi * uniform(random));
}

std::vector<double> refined(const std::vector<double>& grid, int count) {
  if (grid.empty()) return {};
  const double low = grid.front() / k_grid_overhang, ratio = grid.back() / low;
  std::vector<double> fine;
  for (int i = 0; i < count; ++i) fine.push_back(low * std::pow(ratio, static_cast<double>(i) / (count - 1)));
  return fine;
}

// A fine dictionary and its moments: every draw takes a part of them.
struct Grid {
  Dictionary dictionary;
  std::vector<Eigen::MatrixXd> moments;
};

Grid make_grid(const AxisData& data, const Dictionary& nominal, const Variation& variation) {
  Dictionary fine = full_dictionary(data);
  const int intervals = std::max(nominal.spring.intervals() + variation.more_intervals, k_least_intervals);
  fine.spring = MonotoneBasis(data.low, data.high, intervals, data.symmetry);
  fine.yields = refined(fine.yields, k_fine_stops);
  fine.relaxation_times = refined(fine.relaxation_times, k_fine_branches);
  fine.yield_growth = variation.growth * nominal.yield_growth;
  std::vector<Eigen::MatrixXd> moments = block_moments(data, fine, false);
  return {std::move(fine), std::move(moments)};
}

// By what fraction the stiffness of a ramp's cycles still falls from the first to the last (Mullins): settled, the
// rubber is softer than their mean by some of it, which no resampling of the tests can see (I 5.11). Loops run long
// enough to settle; there the difference of two cycles is noise.
double settling(const DataBlock& block) {
  if (block.test->source->kind != TestKind::static_ramp) return 0.0;
  const auto stiffness = [&](const CycleSpan& span) {
    const auto cycle = std::ranges::find(block.test->cycles, span.begin, [](const Cycle& c) { return c.span.begin; });
    return cycle->measured.effective_stiffness;
  };
  const double first = stiffness(block.cycles.front()), last = stiffness(block.cycles.back());
  return last > 0.0 ? std::max(first / last - 1.0, 0.0) : 0.0;
}

// Moments of the campaign with a random say and a random gain of every test.
Eigen::MatrixXd random_campaign_moments(const AxisData& data, const Grid& grid, double gain, std::mt19937_64& random) {
  const Eigen::Index force = grid.moments.front().cols() - 1;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(force + 1, force + 1);
  for (const std::vector<std::size_t>& test : replicates(data)) {
    const double weight = -std::log(uniform(random)), mounted = 1.0 + k_gain_share * gain * normal(random);
    const double settled = uniform(random);
    for (const std::size_t block : test) {
      const double scale = mounted * (1.0 - settled * settling(data.blocks[block]));
      Eigen::MatrixXd own = grid.moments[block];
      own.row(force) *= scale;
      own.col(force) *= scale;
      sum += weight * own;
    }
  }
  regularise(sum, grid.dictionary);
  return sum;
}

// All of the spring and, of the elements, one of every two neighbours.
std::vector<int> random_columns(const Dictionary& dictionary, std::mt19937_64& random) {
  std::vector<int> columns;
  int at = 0;
  for (; at < dictionary.spring.size(); ++at) columns.push_back(at);
  for (; at + 1 < dictionary.num_linear(); at += 2) columns.push_back(at + (uniform(random) < 0.5 ? 0 : 1));
  return columns;
}

// The best law on some columns of the moments, and those of them that it uses.
struct PartialFit {
  std::vector<int> columns;
  Eigen::VectorXd coefficients;  ///< of `columns`
  std::vector<int> free;         ///< places in `columns` with coefficients > 0
};

PartialFit solve(const Eigen::MatrixXd& moments, std::vector<int> columns, const std::vector<int>& start) {
  const Eigen::VectorXd rhs = moments.col(moments.cols() - 1)(columns);
  NnlsSolution solution = solve_nnls(moments(columns, columns), rhs, start);
  return {std::move(columns), std::move(solution.x), std::move(solution.free)};
}

// The free element that is missed least and by how much the cost grows without it: c_j^2 / (G^-1)_jj, exact as long as
// the others stay free.
struct Removal {
  int place = -1;  ///< in the fit's columns; -1: nothing may go
  double rise = 0.0;
};

Removal least_missed(const Eigen::MatrixXd& moments, const PartialFit& fit, const Dictionary& dictionary) {
  const int springs = dictionary.spring.size(), branches = springs + static_cast<int>(dictionary.yields.size());
  const auto is_stop = [&](int place) { return fit.columns[static_cast<std::size_t>(place)] < branches; };
  const auto is_element = [&](int place) { return fit.columns[static_cast<std::size_t>(place)] >= springs; };
  const auto stops = std::ranges::count_if(fit.free, [&](int j) { return is_element(j) && is_stop(j); });
  const auto others = std::ranges::count_if(fit.free, [&](int j) { return !is_stop(j); });
  const bool crowded = stops > k_most_stops || others > k_most_branches;

  std::vector<int> columns;
  for (const int place : fit.free) columns.push_back(fit.columns[static_cast<std::size_t>(place)]);
  const Eigen::MatrixXd gram = moments(columns, columns);
  const Eigen::VectorXd unit = gram.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd inverse =
      (unit.asDiagonal() * gram * unit.asDiagonal()).llt().solve(Eigen::MatrixXd::Identity(gram.rows(), gram.cols()));
  Removal removal;
  for (Eigen::Index i = 0; i < unit.size(); ++i) {
    const int place = fit.free[static_cast<std::size_t>(i)];
    const bool allowed = !crowded || (is_stop(place) ? stops > k_most_stops : others > k_most_branches);
    if (!is_element(place) || !allowed) continue;
    const double scaled = fit.coefficients(place) / unit(i), rise = scaled * scaled / inverse(i, i);
    if (removal.place < 0 || rise < removal.rise) removal = {place, rise};
  }
  const Eigen::Index last = moments.cols() - 1;
  const double cost = moments(last, last) - moments.col(last)(fit.columns).dot(fit.coefficients);
  if (!crowded && removal.rise > k_unnoticed * cost) removal.place = -1;
  return removal;
}

PartialFit without(const Eigen::MatrixXd& moments, const PartialFit& fit, int place) {
  std::vector<int> columns = fit.columns, start;
  columns.erase(columns.begin() + place);
  for (const int j : fit.free) {
    if (j != place) start.push_back(j < place ? j : j - 1);
  }
  return solve(moments, std::move(columns), start);
}

AxisLaw draw_law(const AxisData& data, const Grid& grid, double gain, std::mt19937_64& random) {
  const Eigen::MatrixXd moments = random_campaign_moments(data, grid, gain, random);
  PartialFit fit = solve(moments, random_columns(grid.dictionary, random), {});
  for (Removal removal = least_missed(moments, fit, grid.dictionary); removal.place >= 0;
       removal = least_missed(moments, fit, grid.dictionary)) {
    fit = without(moments, fit, removal.place);
  }
  Eigen::VectorXd coefficients = Eigen::VectorXd::Zero(grid.dictionary.num_linear());
  for (const int place : fit.free) {
    coefficients(fit.columns[static_cast<std::size_t>(place)]) = fit.coefficients(place);
  }
  return make_law(grid.dictionary, coefficients);
}

}  // namespace

std::vector<AxisLaw> draw_laws(const AxisData& data, const Dictionary& nominal, double gain, unsigned seed) {
  std::vector<Grid> grids;
  for (const Variation& variation : k_variations) grids.push_back(make_grid(data, nominal, variation));
  std::mt19937_64 random(seed);
  std::vector<AxisLaw> laws;
  for (std::size_t draw = 0; draw < k_num_draws; ++draw) {
    laws.push_back(draw_law(data, grids[draw % grids.size()], gain, random));
  }
  return laws;
}

}  // namespace grouser
