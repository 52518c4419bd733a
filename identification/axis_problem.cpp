#include "identification/axis_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "identification/element_history.h"

namespace grouser {
namespace {

// A model misses measured rubber by about 1 % of a loop's range: samples quieter than that deserve no more say (I 2).
constexpr double k_model_error = 0.01;
// The squared relative energy error weighs as much as 12^2 squared units of k_model_error: 8 % of energy against 1 % of
// force. Without energy rows least squares leaves 5-8 % of the energy even with noise-free data; much heavier costs
// stiffness (I 2).
constexpr double k_energy_weight = 144.0;
constexpr double k_roughness = 1e-5;  // relative; 1e-6 to 1e-3 are equivalent (I 2)
constexpr double k_ridge = 1e-9;
constexpr int k_buffered_rows = 256;

double force_range(const PreparedTest& test, const std::vector<CycleSpan>& cycles) {
  double low = std::numeric_limits<double>::max(), high = -low;
  for (const CycleSpan& span : cycles) {
    for (std::size_t i = span.begin; i <= span.end; ++i) {
      low = std::min(low, test.smooth_force[i]);
      high = std::max(high, test.smooth_force[i]);
    }
  }
  return high - low;
}

DataBlock make_block(const PreparedTest& test, const std::vector<const Cycle*>& cycles) {
  DataBlock block;
  block.test = &test;
  double samples = 0.0;
  for (const Cycle* cycle : cycles) {
    block.cycles.push_back(cycle->span);
    block.mean_energy += cycle->measured.dissipated_energy / static_cast<double>(cycles.size());
    samples += static_cast<double>(cycle->span.end - cycle->span.begin);
  }
  block.with_drift = cycles.size() > 1;
  const double model_error = k_model_error * force_range(test, block.cycles);
  block.row_weight = 1.0 / (samples * (test.noise_force * test.noise_force + model_error * model_error));
  const double scatter = energy_noise(test, *cycles.back()) / std::sqrt(static_cast<double>(cycles.size()));
  const double relative = scatter / block.mean_energy;
  block.energy_weight = block.mean_energy > 0.0 ? 1.0 / (1.0 / k_energy_weight + relative * relative) : 0.0;
  return block;
}

void cover(AxisData& data, const PreparedTest& test, const Cycle& cycle) {
  for (std::size_t i = cycle.span.begin; i <= cycle.span.end; ++i) {
    data.low = std::min(data.low, test.displacement[i]);
    data.high = std::max(data.high, test.displacement[i]);
  }
  data.smallest_amplitude = std::min(data.smallest_amplitude, cycle.amplitude);
  data.largest_amplitude = std::max(data.largest_amplitude, cycle.amplitude);
}

std::vector<DataBlock> split_by_cycle(const DataBlock& block) {
  std::vector<DataBlock> result;
  for (const Cycle& cycle : block.test->cycles) {
    if (cycle.used) result.push_back(make_block(*block.test, {&cycle}));
  }
  return result;
}

// Normal equations of one block while its samples stream by.
class BlockAccumulator {
 public:
  BlockAccumulator(const DataBlock& block, Eigen::Index num_columns)
      : block_(&block),
        width_(num_columns + 3),
        moments_(Eigen::MatrixXd::Zero(width_, width_)),
        buffer_(k_buffered_rows, width_),
        area_(Eigen::VectorXd::Zero(num_columns)),
        first_(num_columns),
        previous_(num_columns),
        shift_(block.test->force[block.cycles.front().begin]) {}

  [[nodiscard]] std::size_t first() const { return block_->cycles.front().begin; }
  [[nodiscard]] std::size_t last() const { return block_->cycles.back().end; }
  /// Sample i with the values of all columns.
  void take(std::size_t i, const Eigen::VectorXd& columns) {
    while (cycle_ < block_->cycles.size() && i > block_->cycles[cycle_].end) ++cycle_;
    if (cycle_ == block_->cycles.size() || i < block_->cycles[cycle_].begin) return;
    close_loop(i, columns);
    const PreparedTest& test = *block_->test;
    auto row = buffer_.row(used_++);
    row(0) = 1.0;
    row(1) = block_->with_drift ? static_cast<double>(i) / static_cast<double>(test.force.size()) : 0.0;
    row.segment(2, columns.size()) = columns.transpose();
    row(width_ - 1) = test.force[i] - shift_;
    if (used_ == k_buffered_rows) flush();
  }

  [[nodiscard]] Eigen::MatrixXd finish() {
    flush();
    Eigen::MatrixXd all = moments_.selfadjointView<Eigen::Lower>();
    for (const Eigen::Index nuisance : {0, 1}) {  // offset, then drift: one elimination step each
      const double pivot = all(nuisance, nuisance);
      if (!(pivot > 1e-9 * moments_(0, 0))) continue;
      const Eigen::VectorXd column = all.col(nuisance);
      all -= column * column.transpose() / pivot;
    }
    Eigen::MatrixXd result = block_->row_weight * all.bottomRightCorner(width_ - 2, width_ - 2);
    if (block_->energy_weight > 0.0) {
      Eigen::VectorXd row(width_ - 2);
      row << area_ / (static_cast<double>(block_->cycles.size()) * block_->mean_energy), 1.0;
      result += block_->energy_weight * row * row.transpose();
    }
    return result;
  }

 private:
  void close_loop(std::size_t i, const Eigen::VectorXd& columns) {
    const std::vector<double>& x = block_->test->displacement;
    if (i > block_->cycles[cycle_].begin) area_ += 0.5 * (x[i] - x[i - 1]) * (columns + previous_);
    if (i == block_->cycles[cycle_].end) {
      area_ += 0.5 * (x[block_->cycles[cycle_].begin] - x[i]) * (columns + first_);
      if (cycle_ + 1 < block_->cycles.size()) ++cycle_;
    }
    if (i == block_->cycles[cycle_].begin) first_ = columns;
    previous_ = columns;
  }

  void flush() {
    moments_.selfadjointView<Eigen::Lower>().rankUpdate(buffer_.topRows(used_).transpose());
    used_ = 0;
  }

  const DataBlock* block_;
  Eigen::Index width_;
  Eigen::MatrixXd moments_;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> buffer_;
  Eigen::VectorXd area_, first_, previous_;
  double shift_;
  std::size_t cycle_ = 0;
  Eigen::Index used_ = 0;
};

void write_columns(const Dictionary& dictionary, const ElementHistory& history, double x, Eigen::VectorXd& columns) {
  dictionary.spring.evaluate(x, columns.data());
  std::copy(history.value().begin(), history.value().end(), columns.data() + dictionary.spring.size());
  if (columns.size() > dictionary.num_linear()) {
    std::copy(history.derivative().begin(), history.derivative().end(), columns.data() + dictionary.num_linear());
  }
}

// A link is its own mirror image in the track's plane (x-z), so these deflections of its bushing have no preferred
// sign.
bool is_mirror_axis(Axis axis) { return axis == Axis::y || axis == Axis::rx || axis == Axis::rz; }

}  // namespace

AxisData gather(const std::vector<const PreparedTest*>& tests) {
  AxisData data;
  data.low = data.smallest_amplitude = data.lowest_frequency = std::numeric_limits<double>::max();
  data.high = std::numeric_limits<double>::lowest();
  for (const PreparedTest* test : tests) {
    for (int b = 0; b < test->blocks; ++b) {
      std::vector<const Cycle*> cycles;
      for (const Cycle& cycle : test->cycles) {
        if (!cycle.used || cycle.block != b) continue;
        cycles.push_back(&cycle);
        data.closed = data.closed || !cycle.open;
        cover(data, *test, cycle);
      }
      if (!cycles.empty()) data.blocks.push_back(make_block(*test, cycles));
    }
    data.noise_displacement = std::max(data.noise_displacement, test->noise_displacement);
    if (test->frequency > 0.0) data.lowest_frequency = std::min(data.lowest_frequency, test->frequency);
    data.highest_frequency = std::max(data.highest_frequency, test->frequency);
  }
  const bool rate_known = std::ranges::all_of(tests, [](const PreparedTest* test) { return test->rate_known; });
  if (!rate_known)
    data.highest_frequency = 0.0;  // a history without its times would mislead the branches of all the others
  if (data.highest_frequency == 0.0) data.lowest_frequency = 0.0;
  if (!tests.empty() && is_mirror_axis(tests.front()->source->axis)) {
    data.symmetry = SpringSymmetry::odd;
    data.high = std::max(std::abs(data.low), std::abs(data.high));
    data.low = -data.high;
  }
  if (data.blocks.size() == 1) data.blocks = split_by_cycle(DataBlock(data.blocks.front()));
  return data;
}

std::vector<Eigen::MatrixXd> block_moments(const AxisData& data, const Dictionary& dictionary, bool with_derivatives) {
  const Eigen::Index num_columns = dictionary.num_linear() + (with_derivatives ? dictionary.num_nonlinear() : 0);
  std::vector<Eigen::MatrixXd> result;
  Eigen::VectorXd columns(num_columns);
  for (std::size_t b = 0; b < data.blocks.size();) {
    const PreparedTest& test = *data.blocks[b].test;
    std::vector<BlockAccumulator> accumulators;  // of this test: one pass serves all
    for (; b < data.blocks.size() && data.blocks[b].test == &test; ++b) {
      accumulators.emplace_back(data.blocks[b], num_columns);
    }
    ElementHistory history(dictionary);
    auto current = accumulators.begin();
    for (std::size_t i = 0; i < test.displacement.size() && current != accumulators.end(); ++i) {
      if (i > 0) history.advance(test.displacement[i] - test.displacement[i - 1], test.time[i] - test.time[i - 1]);
      if (i < current->first()) continue;
      write_columns(dictionary, history, test.displacement[i], columns);
      // blocks follow each other in time; at most the end of one is the begin of the next
      for (auto open = current; open != accumulators.end() && open->first() <= i; ++open) open->take(i, columns);
      if (i >= current->last()) ++current;
    }
    for (BlockAccumulator& accumulator : accumulators) result.push_back(accumulator.finish());
  }
  return result;
}

void regularise(Eigen::MatrixXd& moments, const Dictionary& dictionary) {
  const int springs = dictionary.spring.size(), linear = dictionary.num_linear();
  const double mean_spring = moments.diagonal().head(springs).mean();
  moments.topLeftCorner(springs, springs) += k_roughness * mean_spring * dictionary.spring.roughness();
  moments.diagonal().head(linear) *= 1.0 + k_ridge;
}

Eigen::MatrixXd columns_along(const std::vector<double>& displacement, double time_step, const Dictionary& dictionary) {
  Eigen::MatrixXd result(static_cast<Eigen::Index>(displacement.size()), dictionary.num_linear());
  Eigen::VectorXd columns(dictionary.num_linear());
  ElementHistory history(dictionary);
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    if (i > 0) history.advance(displacement[i] - displacement[i - 1], time_step);
    write_columns(dictionary, history, displacement[i], columns);
    result.row(static_cast<Eigen::Index>(i)) = columns.transpose();
  }
  return result;
}

AxisLaw make_law(const Dictionary& dictionary, const Eigen::VectorXd& coefficients) {
  AxisLaw law;
  const int springs = dictionary.spring.size();
  law.spring = dictionary.spring.spring(coefficients.head(springs));
  Eigen::Index at = springs;
  for (const double yield : dictionary.yields) {
    if (coefficients(at) > 0.0) law.stops.push_back({coefficients(at), yield});
    ++at;
  }
  for (const double time : dictionary.relaxation_times) {
    if (coefficients(at) > 0.0) law.branches.push_back({coefficients(at), time});
    ++at;
  }
  return law;
}

}  // namespace grouser
