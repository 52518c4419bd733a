#include "identification/robust_weights.h"

#include <algorithm>
#include <cmath>

#include "identification/axis_fit.h"
#include "identification/nnls.h"
#include "identification/thin_axis.h"

namespace grouser {
namespace {

constexpr double k_full_say = 3.0;         // times the median error
constexpr double k_smallest_median = 0.5;  // times the unit of error
constexpr std::size_t k_fewest_tests = 4;
constexpr int k_iterations = 50;
constexpr double k_settled = 1e-3;

double median(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

double error_of(const std::vector<std::size_t>& group, const std::vector<Eigen::MatrixXd>& blocks,
                const Eigen::VectorXd& c) {
  double sum = 0.0;
  const Eigen::Index n = c.size();
  for (const std::size_t b : group) {
    const Eigen::MatrixXd& m = blocks[b];
    sum += m(n, n) - 2.0 * c.dot(m.col(n).head(n)) + c.dot(m.topLeftCorner(n, n) * c);
  }
  return std::sqrt(std::max(sum, 0.0) / static_cast<double>(group.size()));
}

}  // namespace

void weigh_tests(AxisData& data) {
  const bool one_test =
      std::ranges::all_of(data.blocks, [&](const DataBlock& block) { return block.test == data.blocks.front().test; });
  const std::vector<std::vector<std::size_t>> tests = replicates(data);
  if (one_test || tests.size() < k_fewest_tests) return;
  const ThinAxis few = thin(data);
  const Dictionary dictionary = full_dictionary(few.data);
  const std::vector<Eigen::MatrixXd> blocks = block_moments(few.data, dictionary, false);
  const Eigen::Index n = dictionary.num_linear();
  std::vector<double> weights(blocks.size(), 1.0);
  NnlsSolution fit;
  for (int i = 0; i < k_iterations; ++i) {
    const Eigen::MatrixXd sum = weighted_sum(blocks, weights, dictionary);
    fit = solve_nnls(sum.topLeftCorner(n, n), sum.col(n).head(n), fit.free);
    std::vector<double> errors;
    for (const auto& test : tests) errors.push_back(error_of(test, blocks, fit.x));
    const double limit = k_full_say * std::max(median(errors), k_smallest_median);
    double change = 0.0;
    for (std::size_t t = 0; t < tests.size(); ++t) {
      const double weight = std::min(1.0, std::pow(limit / errors[t], 2));
      for (const std::size_t b : tests[t]) {
        change = std::max(change, std::abs(weight - weights[b]));
        weights[b] = weight;
      }
    }
    if (change < k_settled) break;
  }
  for (std::size_t b = 0; b < blocks.size(); ++b) data.blocks[b].robust_weight = weights[b];
}

}  // namespace grouser
