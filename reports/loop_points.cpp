#include "reports/loop_points.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace grouser {
namespace {

constexpr double k_level_width = 1.15;

void add(LoopMeasures& sum, const LoopMeasures& one, double weight) {
  sum.effective_stiffness += weight * one.effective_stiffness;
  sum.dissipated_energy += weight * one.dissipated_energy;
  sum.equivalent_damping += weight * one.equivalent_damping;
  sum.loss_factor += weight * one.loss_factor;
  sum.secant_stiffness += weight * one.secant_stiffness;
  sum.storage_stiffness += weight * one.storage_stiffness;
  sum.loss_stiffness += weight * one.loss_stiffness;
}

std::vector<const CycleFit*> used_cycles(const TestFit& test) {
  std::vector<const CycleFit*> used;
  for (const CycleFit& cycle : test.per_cycle)
    if (cycle.used && cycle.amplitude > 0.0) used.push_back(&cycle);
  return used;
}

}  // namespace

std::vector<const TestFit*> tests_of(const std::vector<TestFit>& tests, Axis axis) {
  std::vector<const TestFit*> found;
  for (const TestFit& test : tests)
    if (test.axis == axis) found.push_back(&test);
  std::vector<double> amplitudes;
  for (const TestFit* test : found)
    if (test->amplitude > 0.0) amplitudes.push_back(test->amplitude);
  const std::vector<double> levels = levels_of(amplitudes);
  const auto place = [&](const TestFit* test) {
    return std::tuple(test->kind == TestKind::cyclic, test->amplitude > 0.0 ? level_index(levels, test->amplitude) : 0,
                      test->frequency);
  };
  std::ranges::stable_sort(found, [&](const TestFit* a, const TestFit* b) { return place(a) < place(b); });
  return found;
}

double stiffness_of(const LoopMeasures& measures) {
  return measures.storage_stiffness > 0.0 ? measures.storage_stiffness : measures.effective_stiffness;
}

double loss_factor_of(const LoopMeasures& measures) {
  return measures.storage_stiffness > 0.0 ? measures.loss_stiffness / measures.storage_stiffness : measures.loss_factor;
}

std::vector<LoopPoint> loop_points(const std::vector<const TestFit*>& tests) {
  std::vector<LoopPoint> points;
  for (const TestFit* test : tests) {
    if (test->kind != TestKind::cyclic || left_out(*test)) continue;
    const std::vector<const CycleFit*> cycles = used_cycles(*test);
    std::vector<double> amplitudes;
    for (const CycleFit* cycle : cycles) amplitudes.push_back(cycle->amplitude);
    const std::vector<double> levels = levels_of(amplitudes);
    if (levels.size() < 2) {
      if (test->amplitude > 0.0)
        points.push_back({test, test->amplitude, test->frequency, test->measured, test->fitted});
      continue;
    }
    for (std::size_t level = 0; level < levels.size(); ++level) {
      LoopPoint point{test, levels[level], test->frequency, {}, {}};
      const auto belongs = [&](const CycleFit* c) { return level_index(levels, c->amplitude) == level; };
      const double share = 1.0 / static_cast<double>(std::ranges::count_if(cycles, belongs));
      for (const CycleFit* cycle : cycles) {
        if (!belongs(cycle)) continue;
        add(point.measured, cycle->measured, share);
        add(point.fitted, cycle->fitted, share);
      }
      points.push_back(point);
    }
  }
  return points;
}

std::vector<double> levels_of(std::vector<double> values) {
  std::ranges::sort(values);
  std::vector<double> levels;
  for (std::size_t begin = 0, end = 0; begin < values.size(); begin = end) {
    double sum = 0.0;
    while (end < values.size() && values[end] <= k_level_width * values[begin]) sum += values[end++];
    levels.push_back(sum / static_cast<double>(end - begin));
  }
  return levels;
}

std::size_t level_index(const std::vector<double>& levels, double value) {
  const auto distance = [value](double level) {
    return level > 0.0 && value > 0.0 ? std::abs(std::log(value / level)) : std::abs(value - level);
  };
  return static_cast<std::size_t>(std::ranges::min_element(levels, {}, distance) - levels.begin());
}

}  // namespace grouser
