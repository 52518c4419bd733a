#pragma once
#include <string>
#include <vector>

#include "model/fit.h"

/// What the loops of an axis say, sorted for plots and tables.
namespace grouser {

/// The tests of an axis in reading order: ramps first, then loops by amplitude and frequency.
[[nodiscard]] std::vector<const TestFit*> tests_of(const std::vector<TestFit>& tests, Axis axis);
/// A test of which no cycle entered the fit says nothing of how well the law holds.
[[nodiscard]] inline bool left_out(const TestFit& test) { return test.cycles_used == 0; }
/// Storage stiffness where the force was read over a known frequency, else force range over displacement range.
[[nodiscard]] double stiffness_of(const LoopMeasures& measures);

/// Loss over storage stiffness where both are known, else loop area over that of the equivalent elastic ellipse.
[[nodiscard]] double loss_factor_of(const LoopMeasures& measures);

/// Mean of the used cycles of one amplitude of a cyclic test; most tests have one amplitude.
struct LoopPoint {
  const TestFit* test = nullptr;
  double amplitude = 0.0, frequency = 0.0;
  LoopMeasures measured, fitted;
};
[[nodiscard]] std::vector<LoopPoint> loop_points(const std::vector<const TestFit*>& tests);

/// Rising values that stand for all of `values`, which meet what was asked of the rig only nearly: a value within 15 %
/// of the least of its group belongs to that group, which its mean stands for.
[[nodiscard]] std::vector<double> levels_of(std::vector<double> values);
/// Index of the level nearest to a value by ratio.
[[nodiscard]] std::size_t level_index(const std::vector<double>& levels, double value);

}  // namespace grouser
