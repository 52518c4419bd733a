#include "identification/leave_one_out.h"

#include <algorithm>
#include <cmath>

#include "identification/nnls.h"

namespace grouser {
namespace {

// Squared error of coefficients c: b'b - 2 c'A'b + c'A'A c.
double squared_error(const Eigen::MatrixXd& moments, const Eigen::VectorXd& c) {
  const Eigen::Index n = c.size(), force = moments.cols() - 1;
  const double value =
      moments(force, force) - 2.0 * c.dot(moments.col(force).head(n)) + c.dot(moments.topLeftCorner(n, n) * c);
  return std::max(value, 0.0);
}

// Mean difference of losses that no reader of the fit would notice: 1 % of the error.
constexpr double k_negligible = 0.02;

// A test whose squared error doubles casts a full vote, however much more it grows.
constexpr double k_full_vote = 0.693147;

double loss(double cost) { return std::log1p(cost); }

}  // namespace

LeftOut leave_one_out(const AxisData& data, const Dictionary& dictionary, const std::vector<BlockMoments>& blocks,
                      const std::vector<int>& free) {
  const std::vector<std::vector<std::size_t>> groups = replicates(data);
  LeftOut result;
  if (groups.size() < 2) return result;
  std::vector<Eigen::MatrixXd> totals;
  for (const BlockMoments& block : blocks) totals.push_back(block.total());
  const Eigen::MatrixXd all = sum_of(blocks);
  const int n = dictionary.num_linear();
  for (const std::vector<std::size_t>& group : groups) {
    Eigen::MatrixXd rest = all;
    for (const std::size_t b : group) rest -= totals[b];
    regularise(rest, dictionary);
    const Eigen::VectorXd c = solve_nnls(rest.topLeftCorner(n, n), rest.col(rest.cols() - 1).head(n), free).x;
    double cost = 0.0, squared = 0.0, samples = 0.0, range = 0.0;
    for (const std::size_t b : group) {
      const DataBlock& block = data.blocks[b];
      cost += squared_error(totals[b], c) / static_cast<double>(group.size());
      squared += squared_error(blocks[b].force, c) / block.row_weight();
      samples += block.num_samples();
      range = std::max(range, block.force_range);
    }
    result.cost.push_back(cost);
    result.nrmse.push_back(range > 0.0 ? std::sqrt(squared / samples) / range : 0.0);
  }
  return result;
}

double left_out_error(const LeftOut& left_out) {
  if (left_out.cost.empty()) return 0.0;
  double mean = 0.0;
  for (const double cost : left_out.cost) mean += loss(cost) / static_cast<double>(left_out.cost.size());
  return k_model_error * std::sqrt(std::expm1(mean));
}

bool clearly_worse(const LeftOut& a, const LeftOut& b) {
  const auto n = static_cast<double>(a.cost.size());
  if (a.cost.size() < 2) return false;
  double sum = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < a.cost.size(); ++i) {
    const double vote = std::clamp(loss(a.cost[i]) - loss(b.cost[i]), -k_full_vote, k_full_vote);
    sum += vote;
    squares += vote * vote;
  }
  const double mean = sum / n, variance = std::max(squares - sum * mean, 0.0) / (n - 1.0);
  return mean > std::max(std::sqrt(variance / n), k_negligible);
}

}  // namespace grouser
