#include "identification/axis_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace grouser {
namespace {

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
  for (const Cycle* cycle : cycles) {
    block.cycles.push_back(cycle->span);
    block.mean_energy += cycle->measured.dissipated_energy / static_cast<double>(cycles.size());
  }
  block.with_drift = cycles.size() > 1;
  block.force_range = force_range(test, block.cycles);
  block.force_unit = std::hypot(test.noise_force, k_model_error * block.force_range);
  if (block.mean_energy > 0.0) {
    const double scatter = energy_noise(test, *cycles.back()) / std::sqrt(static_cast<double>(cycles.size()));
    const double unit = std::hypot(k_energy_unit, scatter / block.mean_energy);
    block.energy_weight = 1.0 / (unit * unit);
  }
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

// A link is its own mirror image in the track's plane (x-z), so these deflections of its bushing have no preferred
// sign.
bool is_mirror_axis(Axis axis) { return axis == Axis::y || axis == Axis::rx || axis == Axis::rz; }

}  // namespace

double DataBlock::num_samples() const {
  double samples = 0.0;
  for (const CycleSpan& span : cycles) samples += static_cast<double>(span.end - span.begin);
  return samples;
}

double DataBlock::row_weight() const { return robust_weight / (num_samples() * force_unit * force_unit); }

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

std::vector<std::vector<std::size_t>> replicates(const AxisData& data) {
  std::vector<std::vector<std::size_t>> groups;
  const PreparedTest* first = data.blocks.front().test;
  const bool one_test = std::ranges::all_of(data.blocks, [&](const DataBlock& block) { return block.test == first; });
  for (std::size_t b = 0; b < data.blocks.size(); ++b) {
    if (b == 0 || one_test || data.blocks[b].test != data.blocks[b - 1].test) groups.emplace_back();
    groups.back().push_back(b);
  }
  return groups;
}

AxisLaw make_law(const Dictionary& dictionary, const Eigen::VectorXd& coefficients) {
  AxisLaw law;
  const int springs = dictionary.spring.size();
  law.spring = dictionary.spring.spring(coefficients.head(springs));
  law.yield_growth = dictionary.yield_growth;
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
