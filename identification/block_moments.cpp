#include "identification/block_moments.h"

#include <algorithm>

#include "identification/element_history.h"

namespace grouser {
namespace {

constexpr double k_roughness = 1e-5;  // relative; 1e-6 to 1e-3 are equivalent (I 2)
constexpr double k_ridge = 1e-9;
constexpr Eigen::Index k_buffered_rows = 128;

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

int num_derivatives(const Dictionary& dictionary) {
  const auto stops = static_cast<int>(dictionary.yields.size());
  return dictionary.num_elements() + (dictionary.yield_growth > 0.0 ? stops : 0);
}

// Normal equations of one block while its samples stream by. The dense columns are
//   1 | position (drift) | share of the sample in the loop area | elements | derivatives | force;
// the spring enters by the four B-splines that do not vanish at the sample.
class BlockAccumulator {
 public:
  BlockAccumulator(const DataBlock& block, const Dictionary& dictionary, int num_columns)
      : block_(&block),
        basis_(&dictionary.spring),
        width_(k_first_column + num_columns + 1),
        padded_((width_ + k_lanes - 1) / k_lanes * k_lanes),
        dense_(Eigen::MatrixXd::Zero(width_, width_)),
        cross_(RowMatrix::Zero(basis_->num_bsplines(), padded_)),
        band_(RowMatrix::Zero(basis_->num_bsplines(), 4)),
        buffer_(RowMatrix::Zero(k_buffered_rows, padded_)),
        shift_(block.test->force[block.cycles.front().begin]),
        pivot_(basis_->local(block.test->displacement[block.cycles.front().begin]).first) {}

  [[nodiscard]] std::size_t first() const { return block_->cycles.front().begin; }
  [[nodiscard]] std::size_t last() const { return block_->cycles.back().end; }

  /// Sample i with the elements' states.
  void take(std::size_t i, const ElementHistory& history, bool with_derivatives) {
    const std::vector<CycleSpan>& cycles = block_->cycles;
    while (cycle_ + 1 < cycles.size() && i > cycles[cycle_].end) ++cycle_;
    if (i < cycles[cycle_].begin || i > cycles[cycle_].end) return;
    const PreparedTest& test = *block_->test;
    auto row = buffer_.row(used_++);
    row(0) = 1.0;
    row(1) = block_->with_drift ? static_cast<double>(i) / static_cast<double>(test.force.size()) : 0.0;
    row(2) = share_of_area(i);
    Eigen::Index at = k_first_column;
    const auto put = [&](const Eigen::ArrayXd& values) {
      row.segment(at, values.size()) = values.transpose();
      at += values.size();
    };
    put(history.value());
    if (with_derivatives) {
      put(history.derivative());
      put(history.by_growth());
    }
    row(at) = test.force[i] - shift_;
    add_spring(test.displacement[i], row.data());
    if (used_ == k_buffered_rows) flush();
  }

  [[nodiscard]] BlockMoments finish() {
    flush();
    BlockMoments result;
    Eigen::MatrixXd all = assembled();
    if (block_->energy_weight > 0.0) {
      const Eigen::VectorXd area = all.col(2).tail(all.cols() - k_first_column);
      result.energy = area / (static_cast<double>(block_->cycles.size()) * block_->mean_energy);
      result.energy(result.energy.size() - 1) = 1.0;
      result.energy_weight = block_->robust_weight * block_->energy_weight;
    }
    for (const Eigen::Index nuisance : {0, 1}) {  // offset, then drift: one elimination step each
      const double pivot = all(nuisance, nuisance);
      if (!(pivot > 1e-9 * dense_(0, 0))) continue;
      const Eigen::VectorXd column = all.col(nuisance);
      all.noalias() -= (column / pivot) * column.transpose();
    }
    const Eigen::Index kept = all.cols() - k_first_column;
    result.force = block_->row_weight() * all.bottomRightCorner(kept, kept);
    return result;
  }

 private:
  static constexpr Eigen::Index k_first_column = 3;
  static constexpr Eigen::Index k_lanes = 8;  // rows are padded to whole vectors

  // Trapezoid rule over each closed cycle: area = sum of (x[i+1] - x[i-1]) / 2 * value[i], neighbours cyclic.
  [[nodiscard]] double share_of_area(std::size_t i) const {
    const std::vector<double>& x = block_->test->displacement;
    double share = 0.0;
    for (std::size_t c = cycle_; c < block_->cycles.size() && block_->cycles[c].begin <= i; ++c) {
      const auto [begin, end] = block_->cycles[c];
      const double before = i == begin ? x[end] : x[i - 1], after = i == end ? x[begin] : x[i + 1];
      share += 0.5 * (after - before);
    }
    return share;
  }

  void add_spring(double x, const double* __restrict row) {
    const MonotoneBasis::Local here = basis_->local(x);
    for (int k = 0; k < 4; ++k) {
      const double value = here.value[static_cast<std::size_t>(k)];
      double* __restrict sums = &cross_(here.first + k, 0);
      for (Eigen::Index lane = 0; lane < padded_; lane += k_lanes) {
        for (Eigen::Index j = 0; j < k_lanes; ++j) sums[lane + j] += value * row[lane + j];
      }
      double* __restrict band = &band_(here.first + k, 0);
      for (int l = k; l < 4; ++l) band[l - k] += value * here.value[static_cast<std::size_t>(l)];
    }
  }

  void flush() {
    dense_.selfadjointView<Eigen::Lower>().rankUpdate(buffer_.topLeftCorner(used_, width_).transpose());
    used_ = 0;
  }

  // Full symmetric moments over [1 | position | share | increments | elements | derivatives | force].
  [[nodiscard]] Eigen::MatrixXd assembled() const {
    const Eigen::Index n = basis_->num_bsplines(), springs = basis_->size();
    Eigen::MatrixXd spring(n, n);
    spring.setZero();
    for (Eigen::Index k = 0; k < n; ++k) {
      for (Eigen::Index l = k; l < std::min(k + 4, n); ++l) spring(k, l) = spring(l, k) = band_(k, l - k);
    }
    const Eigen::MatrixXd half = basis_->of_increments(spring, pivot_),
                          cross = basis_->of_increments(cross_.leftCols(width_), pivot_);
    const Eigen::MatrixXd dense = dense_.selfadjointView<Eigen::Lower>();
    const Eigen::Index tail = width_ - k_first_column;
    Eigen::MatrixXd all(width_ + springs, width_ + springs);
    all.topLeftCorner(k_first_column, k_first_column) = dense.topLeftCorner(k_first_column, k_first_column);
    all.bottomRightCorner(tail, tail) = dense.bottomRightCorner(tail, tail);
    all.bottomLeftCorner(tail, k_first_column) = dense.bottomLeftCorner(tail, k_first_column);
    all.topRightCorner(k_first_column, tail) = dense.topRightCorner(k_first_column, tail);
    all.block(k_first_column, k_first_column, springs, springs) = basis_->of_increments(half.transpose(), pivot_);
    all.block(k_first_column, 0, springs, k_first_column) = cross.leftCols(k_first_column);
    all.block(0, k_first_column, k_first_column, springs) = cross.leftCols(k_first_column).transpose();
    all.block(k_first_column, k_first_column + springs, springs, tail) = cross.rightCols(tail);
    all.block(k_first_column + springs, k_first_column, tail, springs) = cross.rightCols(tail).transpose();
    return all;
  }

  const DataBlock* block_;
  const MonotoneBasis* basis_;
  Eigen::Index width_, padded_;
  Eigen::MatrixXd dense_;
  RowMatrix cross_, band_, buffer_;
  double shift_;
  int pivot_;
  std::size_t cycle_ = 0;
  Eigen::Index used_ = 0;
};

}  // namespace

Eigen::MatrixXd BlockMoments::total() const {
  if (energy.size() == 0) return force;
  return force + energy_weight * energy * energy.transpose();
}

std::vector<BlockMoments> split_moments(const AxisData& data, const Dictionary& dictionary, bool with_derivatives) {
  const int num_columns = dictionary.num_elements() + (with_derivatives ? num_derivatives(dictionary) : 0);
  std::vector<BlockMoments> result;
  for (std::size_t b = 0; b < data.blocks.size();) {
    const PreparedTest& test = *data.blocks[b].test;
    std::vector<BlockAccumulator> accumulators;  // of this test: one pass serves all
    for (; b < data.blocks.size() && data.blocks[b].test == &test; ++b) {
      accumulators.emplace_back(data.blocks[b], dictionary, num_columns);
    }
    ElementHistory history(dictionary, with_derivatives);
    auto current = accumulators.begin();
    for (std::size_t i = 0; i < test.displacement.size() && current != accumulators.end(); ++i) {
      if (i > 0) history.advance(test.displacement[i - 1], test.displacement[i], test.time[i] - test.time[i - 1]);
      if (i < current->first()) continue;
      // blocks follow each other in time; at most the end of one is the begin of the next
      for (auto open = current; open != accumulators.end() && open->first() <= i; ++open) {
        open->take(i, history, with_derivatives);
      }
      if (i >= current->last()) ++current;
    }
    for (BlockAccumulator& accumulator : accumulators) result.push_back(accumulator.finish());
  }
  return result;
}

std::vector<Eigen::MatrixXd> block_moments(const AxisData& data, const Dictionary& dictionary, bool with_derivatives) {
  std::vector<Eigen::MatrixXd> result;
  for (const BlockMoments& block : split_moments(data, dictionary, with_derivatives)) result.push_back(block.total());
  return result;
}

Eigen::MatrixXd sum_of(const std::vector<BlockMoments>& blocks) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(blocks.front().force.rows(), blocks.front().force.cols());
  for (const BlockMoments& block : blocks) sum += block.total();
  return sum;
}

Eigen::MatrixXd derivative_weights(const Dictionary& dictionary, const Eigen::VectorXd& coefficients) {
  const auto stops = static_cast<Eigen::Index>(dictionary.yields.size());
  const Eigen::Index elements = dictionary.num_elements(), springs = dictionary.spring.size();
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(num_derivatives(dictionary), dictionary.num_nonlinear());
  weights.topLeftCorner(elements, elements).diagonal() = coefficients.tail(elements);
  if (dictionary.yield_growth > 0.0) weights.col(elements).tail(stops) = coefficients.segment(springs, stops);
  return weights;
}

void regularise(Eigen::MatrixXd& moments, const Dictionary& dictionary) {
  const int springs = dictionary.spring.size(), linear = dictionary.num_linear();
  const double mean_spring = moments.diagonal().head(springs).mean();
  moments.topLeftCorner(springs, springs) += k_roughness * mean_spring * dictionary.spring.roughness();
  moments.diagonal().head(linear) *= 1.0 + k_ridge;
}

Eigen::MatrixXd weighted_sum(const std::vector<Eigen::MatrixXd>& blocks, const std::vector<double>& weights,
                             const Dictionary& dictionary) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(blocks.front().rows(), blocks.front().cols());
  for (std::size_t b = 0; b < blocks.size(); ++b) sum += (weights.empty() ? 1.0 : weights[b]) * blocks[b];
  regularise(sum, dictionary);
  return sum;
}

Eigen::MatrixXd columns_along(const std::vector<double>& displacement, double time_step, const Dictionary& dictionary) {
  RowMatrix result(static_cast<Eigen::Index>(displacement.size()), dictionary.num_linear());
  ElementHistory history(dictionary, false);
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    if (i > 0) history.advance(displacement[i - 1], displacement[i], time_step);
    auto row = result.row(static_cast<Eigen::Index>(i));
    dictionary.spring.evaluate(displacement[i], row.data());
    row.tail(dictionary.num_elements()) = history.value().transpose();
  }
  return result;
}

}  // namespace grouser
