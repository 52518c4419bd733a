#include "identification/evaluate_fit.h"

#include <algorithm>
#include <cmath>

#include "model/bushing_law.h"

namespace grouser {
namespace {

constexpr std::size_t k_curve_points = 600;

// What one block's measured force has beside the modelled one: F = p + offset + slope (i - middle) + gain (p - mean p).
// Offset and, where several cycles of a block show one, drift belong to the sensor, not to the rubber. All are fitted
// together: a line fitted alone to n whole cycles of a sine has a slope (I 5).
struct BlockDifference {
  double offset = 0.0, slope = 0.0, middle = 0.0;  ///< N, N a sample, samples
  double samples = 0.0;
  double change = 0.0;             ///< drift over the used cycles, N
  double gain = 0.0, power = 0.0;  ///< the gain's say is the modelled force's squared sum

  [[nodiscard]] double zero(std::size_t i) const { return offset + slope * (static_cast<double>(i) - middle); }
};

BlockDifference difference_of(const PreparedTest& test, int block, const std::vector<double>& modelled) {
  std::vector<std::size_t> rows;
  int cycles = 0;
  for (const Cycle& cycle : test.cycles) {
    if (!cycle.used || cycle.block != block) continue;
    ++cycles;
    for (std::size_t i = cycle.span.begin; i < cycle.span.end; ++i) rows.push_back(i);
  }
  BlockDifference result;
  if (rows.empty()) return result;
  result.samples = static_cast<double>(rows.size());
  double mean_p = 0.0, mean_f = 0.0;
  for (const std::size_t i : rows) {
    mean_p += modelled[i] / result.samples;
    mean_f += test.force[i] / result.samples;
    result.middle += static_cast<double>(i) / result.samples;
  }
  double uu = 0.0, up = 0.0, pp = 0.0, uf = 0.0, pf = 0.0;
  for (const std::size_t i : rows) {
    const double u = static_cast<double>(i) - result.middle, p = modelled[i] - mean_p, f = test.force[i] - mean_f - p;
    uu += u * u, up += u * p, pp += p * p, uf += u * f, pf += p * f;
  }
  if (cycles < 2) up = uf = 0.0;  // one cycle cannot tell drift from friction
  result.offset = mean_f - mean_p;
  result.power = pp - up * up / uu;
  result.gain = result.power > 0.0 ? (pf - up * uf / uu) / result.power : 0.0;
  result.slope = (uf - up * result.gain) / uu;
  result.change = result.slope * static_cast<double>(rows.back() - rows.front());
  return result;
}

// Finds every block's sensor zero and the test's gain, and moves the modelled force by the zero, for all cycles of the
// block, used or not.
void take_sensor_zero(const PreparedTest& test, std::vector<double>& modelled, TestFit& result) {
  double samples = 0.0, power = 0.0;
  std::vector<BlockDifference> blocks;
  for (int block = 0; block < test.blocks; ++block) {
    const BlockDifference one = blocks.emplace_back(difference_of(test, block, modelled));
    samples += one.samples;
    power += one.power;
    result.force_zero += one.samples * one.offset;
    result.gain += one.power * one.gain;
    if (std::abs(one.change) > std::abs(result.force_drift)) result.force_drift = one.change;
  }
  if (samples > 0.0) result.force_zero /= samples;
  if (power > 0.0) result.gain /= power;
  std::vector<char> done(modelled.size(), 0);
  for (const Cycle& cycle : test.cycles) {
    for (std::size_t i = cycle.span.begin; cycle.followed() && i <= cycle.span.end; ++i) {
      if (!done[i]) modelled[i] += blocks[static_cast<std::size_t>(cycle.block)].zero(i);
      done[i] = 1;
    }
  }
}

struct ErrorSums {
  double squared = 0.0, low = 0.0, high = 0.0, sum = 0.0, sum_squares = 0.0, count = 0.0;
  void add(double measured, double fitted) {
    low = count == 0.0 ? measured : std::min(low, measured);
    high = count == 0.0 ? measured : std::max(high, measured);
    squared += (measured - fitted) * (measured - fitted);
    sum += measured;
    sum_squares += measured * measured;
    count += 1.0;
  }
  [[nodiscard]] double nrmse() const { return high > low ? std::sqrt(squared / count) / (high - low) : 0.0; }
  [[nodiscard]] double r_squared() const {
    const double spread = sum_squares - sum * sum / count;
    return spread > 0.0 ? 1.0 - squared / spread : 0.0;
  }
};

void accumulate(LoopMeasures& mean, const LoopMeasures& one, double weight) {
  mean.effective_stiffness += weight * one.effective_stiffness;
  mean.dissipated_energy += weight * one.dissipated_energy;
  mean.equivalent_damping += weight * one.equivalent_damping;
  mean.loss_factor += weight * one.loss_factor;
  mean.secant_stiffness += weight * one.secant_stiffness;
  mean.storage_stiffness += weight * one.storage_stiffness;
  mean.loss_stiffness += weight * one.loss_stiffness;
}

// Last used cycle of every block.
void draw_curve(const PreparedTest& test, const std::vector<double>& fitted, LoopCurve& curve) {
  std::vector<const Cycle*> shown;
  for (const Cycle& cycle : test.cycles) {
    if (!cycle.used) continue;
    if (!shown.empty() && shown.back()->block == cycle.block)
      shown.back() = &cycle;
    else
      shown.push_back(&cycle);
  }
  std::size_t samples = 0;
  for (const Cycle* cycle : shown) samples += cycle->span.end - cycle->span.begin + 2;
  const std::size_t stride = (samples + k_curve_points - 1) / k_curve_points;
  for (const Cycle* cycle : shown) {
    const auto put = [&](std::size_t i) {
      curve.displacement.push_back(test.displacement[i]);
      curve.force.push_back(test.force[i]);
      curve.fitted.push_back(fitted[i]);
    };
    for (std::size_t i = cycle->span.begin; i < cycle->span.end; i += stride) put(i);
    put(cycle->span.end);
  }
}

}  // namespace

std::vector<double> replay(const AxisLaw& law, const std::vector<double>& time,
                           const std::vector<double>& displacement) {
  std::vector<double> deflection(law.stops.size()), branch_force(law.branches.size()), force;
  force.reserve(displacement.size());
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    const double dx = i > 0 ? displacement[i] - displacement[i - 1] : 0.0, h = i > 0 ? time[i] - time[i - 1] : 0.0;
    double total = evaluate(law.spring, displacement[i]).force + (h > 0.0 ? law.viscous * dx / h : 0.0);
    const double grown = yield_scale(law.yield_growth, displacement[i]);
    for (std::size_t j = 0; j < law.stops.size(); ++j) {
      deflection[j] = advance_stop(deflection[j], dx, law.stops[j].yield * grown);
      total += law.stops[j].stiffness * deflection[j];
    }
    for (std::size_t k = 0; k < law.branches.size(); ++k) {
      const MaxwellStep step = maxwell_step(law.branches[k], h);
      branch_force[k] = step.decay * branch_force[k] + step.gain * dx;
      total += branch_force[k];
    }
    force.push_back(total);
  }
  return force;
}

TestFit evaluate_fit(const PreparedTest& test, std::vector<double> force) {
  TestFit result;
  result.name = test.source->name;
  result.axis = test.source->axis;
  result.kind = test.source->kind;
  result.samples = static_cast<long>(test.source->force.size());
  result.cycles = static_cast<int>(test.cycles.size());
  result.cycles_used = test.cycles_used();
  result.frequency = test.frequency;
  std::vector<double> fitted = std::move(force);
  const bool modelled = !fitted.empty();
  if (modelled && test.blocks > 0) take_sensor_zero(test, fitted, result);
  ErrorSums all;
  for (std::size_t k = 0; k < test.cycles.size(); ++k) {
    const Cycle& cycle = test.cycles[k];
    CycleFit one;
    one.index = static_cast<int>(k) + 1;
    one.used = cycle.used;
    one.note = cycle.note;
    one.amplitude = cycle.amplitude;
    one.measured = cycle.measured;
    if (modelled && cycle.followed()) {
      one.fitted =
          loop_measures(test.displacement, fitted, fitted, cycle.span, test.frequency, test.noise_displacement);
      if (cycle.open) {
        one.fitted = {.effective_stiffness = one.fitted.effective_stiffness,
                      .secant_stiffness = one.fitted.secant_stiffness};
      }
      add_dynamic_stiffness(test, cycle, fitted, one.fitted);
      ErrorSums sums;
      for (std::size_t i = cycle.span.begin; i < cycle.span.end; ++i) {
        sums.add(test.force[i], fitted[i]);
        if (cycle.used) all.add(test.force[i], fitted[i]);
      }
      one.nrmse = sums.nrmse();
    }
    if (cycle.used) {
      const double weight = 1.0 / result.cycles_used;
      result.amplitude += weight * cycle.amplitude;
      accumulate(result.measured, one.measured, weight);
      accumulate(result.fitted, one.fitted, weight);
    }
    result.per_cycle.push_back(std::move(one));
  }
  if (modelled && all.count > 0.0) {
    result.nrmse = all.nrmse();
    result.r_squared = all.r_squared();
    draw_curve(test, fitted, result.curve);
  }
  return result;
}

}  // namespace grouser
