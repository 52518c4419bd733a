#include "identification/bands.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "identification/response.h"

namespace grouser {
namespace {

constexpr double k_normal_95 = 1.959964;
// Of n tests so many are spent on the law. I 2 takes 6 with a bootstrap alone; 3 are enough where gains are drawn too.
constexpr double k_fitted_by_few = 3.0;
constexpr double k_same = 0.05;         // amplitudes and frequencies of one cell of the grid agree within 5 %
constexpr double k_off_centre = 0.1;    // of the amplitude: a smaller shift of a loop's middle is the transducer's zero
constexpr double k_least_period = 1.0;  // s a cycle, for a backbone without any known rate
constexpr int k_band_intervals = 40;
// Of the range: narrower windows show the stops' corners, not the rubber (I 2). With the intervals above: 6 of 40.
constexpr double k_tangent_window = 0.15;

// Means of clusters of equal values, ascending.
std::vector<double> clusters(std::vector<double> values) {
  std::ranges::sort(values);
  std::vector<double> means;
  for (std::size_t first = 0, i = 0; i < values.size(); first = i) {
    double sum = 0.0;
    while (i < values.size() && values[i] <= (1.0 + k_same) * values[first]) sum += values[i++];
    means.push_back(sum / static_cast<double>(i - first));
  }
  return means;
}

// What the loops of an axis were run at.
struct LoopGrid {
  std::vector<double> amplitudes, frequencies;
  double preset = 0.0;
};

LoopGrid loop_grid(const AxisData& data) {
  LoopGrid grid;
  double centre = 0.0, stated = 0.0, loops = 0.0, num_stated = 0.0, largest = 0.0;
  for (const DataBlock& block : data.blocks) {
    if (block.test->source->kind != TestKind::cyclic) continue;
    for (const CycleSpan& span : block.cycles) {
      const auto cycle = std::ranges::find(block.test->cycles, span.begin, [](const Cycle& c) { return c.span.begin; });
      grid.amplitudes.push_back(cycle->amplitude);
      largest = std::max(largest, cycle->amplitude);
      centre += cycle->centre;
      loops += 1.0;
    }
    grid.frequencies.push_back(data.highest_frequency > 0.0 ? block.test->frequency : 0.0);
    if (!block.test->source->preset) continue;
    stated += *block.test->source->preset;
    num_stated += 1.0;
  }
  grid.amplitudes = clusters(grid.amplitudes);
  grid.frequencies = clusters(grid.frequencies);
  if (num_stated > 0.0)
    grid.preset = stated / num_stated;
  else if (loops > 0.0 && std::abs(centre / loops) > k_off_centre * largest)
    grid.preset = centre / loops;
  return grid;
}

// Range of the slowest ramp, or of the largest loops where there is none.
std::pair<double, double> backbone_range(const AxisData& data) {
  const auto ramp = std::ranges::find_if(
      data.blocks, [](const DataBlock& block) { return block.test->source->kind == TestKind::static_ramp; });
  if (ramp == data.blocks.end()) return {data.low, data.high};
  const CycleSpan& span = ramp->cycles.back();
  const auto first = ramp->test->displacement.begin();
  const auto [low, high] = std::minmax_element(first + static_cast<std::ptrdiff_t>(span.begin),
                                               first + static_cast<std::ptrdiff_t>(span.end) + 1);
  return {*low, *high};
}

// A quantity of the fitted law and of every draw.
struct Sampled {
  double value = 0.0;
  std::vector<double> draws;
};

// See the header; `replicates` tests.
Interval interval_of(const Sampled& sampled, double replicates) {
  double mean = 0.0, variance = 0.0;
  const auto count = static_cast<double>(sampled.draws.size());
  for (const double draw : sampled.draws) mean += draw / count;
  for (const double draw : sampled.draws) variance += (draw - mean) * (draw - mean) / count;
  const double few_tests =
      replicates / std::max(replicates - k_fitted_by_few, 0.5 * replicates);  // bounded where tests are few
  const double half = k_normal_95 * std::sqrt(few_tests * variance);
  return {sampled.value, std::min(mean - half, sampled.value), std::max(mean + half, sampled.value)};
}

// Responses of all laws over the grid.
class ResponseTable {
 public:
  ResponseTable(const AxisLaw& law, const std::vector<AxisLaw>& draws, const LoopGrid& grid) {
    add(law, grid);
    for (const AxisLaw& draw : draws) add(draw, grid);
  }

  /// Any quantity of the response of one cell.
  template <typename Of>
  [[nodiscard]] Sampled at(std::size_t amplitude, std::size_t frequency, const Of& of) const {
    Sampled sampled;
    for (std::size_t i = 0; i < instant_.size(); ++i) {
      const HarmonicResponse &a = instant_[i][amplitude], &b = viscoelastic_[i][frequency];
      const double quantity =
          of(HarmonicResponse{a.storage_stiffness + b.storage_stiffness, a.loss_stiffness + b.loss_stiffness});
      if (i == 0)
        sampled.value = quantity;
      else
        sampled.draws.push_back(quantity);
    }
    return sampled;
  }

 private:
  void add(const AxisLaw& law, const LoopGrid& grid) {
    instant_.emplace_back();
    for (const double amplitude : grid.amplitudes)
      instant_.back().push_back(rate_independent_response(law, amplitude, grid.preset));
    viscoelastic_.emplace_back();
    for (const double frequency : grid.frequencies)
      viscoelastic_.back().push_back(viscoelastic_response(law, frequency));
  }

  std::vector<std::vector<HarmonicResponse>> instant_, viscoelastic_;  // [law][amplitude], [law][frequency]
};

std::vector<ResponsePoint> state_responses(const AxisLaw& law, const std::vector<AxisLaw>& draws, const LoopGrid& grid,
                                           double replicates) {
  const ResponseTable table(law, draws, grid);
  std::vector<ResponsePoint> points;
  for (std::size_t a = 0; a < grid.amplitudes.size(); ++a) {
    for (std::size_t f = 0; f < grid.frequencies.size(); ++f) {
      ResponsePoint point;
      point.amplitude = grid.amplitudes[a];
      point.frequency = grid.frequencies[f];
      const double loop = std::numbers::pi * point.amplitude * point.amplitude;
      const auto state = [&](const auto& of) { return interval_of(table.at(a, f, of), replicates); };
      point.energy = state([&](const HarmonicResponse& r) { return loop * r.loss_stiffness; });
      point.storage_stiffness = state([](const HarmonicResponse& r) { return r.storage_stiffness; });
      point.loss_stiffness = state([](const HarmonicResponse& r) { return r.loss_stiffness; });
      point.loss_factor = state([](const HarmonicResponse& r) { return r.loss_stiffness / r.storage_stiffness; });
      points.push_back(point);
    }
  }
  return points;
}

// Intervals of stations along the backbone: force about its own mean, or tangent over the window.
void state_backbone(const AxisData& data, const AxisLaw& law, const std::vector<AxisLaw>& draws, double replicates,
                    AxisFit& fit) {
  const auto [low, high] = backbone_range(data);
  const double from = low, spacing = (high - low) / k_band_intervals;
  const double period = data.lowest_frequency > 0.0 ? 1.0 / data.lowest_frequency : k_least_period;
  std::vector<std::vector<double>> force{backbone_of(law, low, high, period, k_band_intervals)};
  for (const AxisLaw& draw : draws) force.push_back(backbone_of(draw, low, high, period, k_band_intervals));
  const double stations = k_band_intervals + 1.0;
  double fitted_mean = 0.0;
  for (const double f : force.front()) fitted_mean += f / stations;
  for (std::vector<double>& curve : force) {
    double mean = 0.0;
    for (const double f : curve) mean += f / stations;
    for (double& f : curve) f += fitted_mean - mean;
  }
  const auto state = [&](double x, const auto& of) {
    Sampled sampled{of(force.front()), {}};
    for (std::size_t i = 1; i < force.size(); ++i) sampled.draws.push_back(of(force[i]));
    const Interval interval = interval_of(sampled, replicates);
    return BandPoint{x, interval.value, interval.low, interval.high};
  };
  for (std::size_t i = 0; i <= k_band_intervals; ++i) {
    fit.backbone.push_back(state(from + spacing * static_cast<double>(i), [i](const auto& curve) { return curve[i]; }));
  }
  const auto window = static_cast<std::size_t>(std::lround(k_tangent_window * k_band_intervals));
  fit.tangent_window = static_cast<double>(window) * spacing;
  for (std::size_t i = window; i + window <= k_band_intervals; ++i) {
    fit.tangent.push_back(state(from + spacing * static_cast<double>(i), [&](const auto& curve) {
      return (curve[i + window] - curve[i - window]) / (2.0 * fit.tangent_window);
    }));
  }
}

}  // namespace

void state_intervals(const AxisData& data, const AxisLaw& law, const std::vector<AxisLaw>& draws, AxisFit& fit) {
  const LoopGrid grid = loop_grid(data);
  const auto num_replicates = static_cast<double>(replicates(data).size());
  fit.preset = grid.preset;
  fit.draws = static_cast<int>(draws.size());
  fit.responses = state_responses(law, draws, grid, num_replicates);
  state_backbone(data, law, draws, num_replicates, fit);
}

}  // namespace grouser
