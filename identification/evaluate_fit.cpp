#include "identification/evaluate_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "model/bushing_law.h"

namespace grouser {
namespace {

constexpr std::size_t k_curve_points = 600;

// The test's own force zero, and its drift where several cycles of a block show one, added to the law's force: these
// belong to the sensor, not to the rubber. A block's line serves all its cycles, used or not.
void add_sensor_zero(const PreparedTest& test, int block, std::vector<double>& fitted, std::vector<char>& done) {
  std::vector<std::size_t> rows;
  int cycles = 0;
  for (const Cycle& cycle : test.cycles) {
    if (!cycle.used || cycle.block != block) continue;
    ++cycles;
    for (std::size_t i = cycle.span.begin; i < cycle.span.end; ++i) rows.push_back(i);
  }
  if (rows.empty()) return;
  const Eigen::Index unknowns = cycles > 1 ? 2 : 1;
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(rows.size()), unknowns);
  Eigen::VectorXd difference(columns.rows());
  const auto position = [&](std::size_t i) { return static_cast<double>(i) / static_cast<double>(test.force.size()); };
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    columns(row, 0) = 1.0;
    if (unknowns > 1) columns(row, 1) = position(rows[k]);
    difference(row) = test.force[rows[k]] - fitted[rows[k]];
  }
  const Eigen::VectorXd line = columns.colPivHouseholderQr().solve(difference);
  for (const Cycle& cycle : test.cycles) {
    if (cycle.block != block) continue;
    for (std::size_t i = cycle.span.begin; i <= cycle.span.end; ++i) {
      if (done[i]) continue;
      done[i] = 1;
      fitted[i] += line(0) + (unknowns > 1 ? line(1) * position(i) : 0.0);
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
    for (std::size_t j = 0; j < law.stops.size(); ++j) {
      deflection[j] = advance_stop(deflection[j], dx, law.stops[j].yield);
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
  result.samples = static_cast<long>(test.force.size());
  result.cycles = static_cast<int>(test.cycles.size());
  result.cycles_used = test.cycles_used();
  result.frequency = test.frequency;
  std::vector<double> fitted = std::move(force);
  const bool modelled = !fitted.empty();
  if (modelled) {
    std::vector<char> done(fitted.size(), 0);
    for (int block = 0; block < test.blocks; ++block) add_sensor_zero(test, block, fitted, done);
  }
  ErrorSums all;
  for (std::size_t k = 0; k < test.cycles.size(); ++k) {
    const Cycle& cycle = test.cycles[k];
    CycleFit one;
    one.index = static_cast<int>(k) + 1;
    one.used = cycle.used;
    one.note = cycle.note;
    one.amplitude = cycle.amplitude;
    one.measured = cycle.measured;
    if (modelled) {
      one.fitted = loop_measures(test.displacement, fitted, fitted, cycle.span, test.frequency);
      if (cycle.open) one.fitted = {.effective_stiffness = one.fitted.effective_stiffness};
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
