#pragma once
#include <Eigen/Core>
#include <vector>

#include "identification/monotone_basis.h"
#include "identification/prepared_test.h"
#include "model/bushing.h"

namespace grouser {

/// The nonlinear choice of a law: with it fixed, force = columns * coefficients is linear, coefficients >= 0.
/// Order of the columns: spring increments [N], stop stiffnesses [N/m], branch stiffnesses [N/m].
/// Order of the nonlinear parameters, by their logarithms: yields, relaxation times, yield growth when there is one.
struct Dictionary {
  MonotoneBasis spring;
  std::vector<double> yields;            ///< m or rad, at displacement 0
  std::vector<double> relaxation_times;  ///< s
  double yield_growth = 0.0;             ///< 1/m^2 or 1/rad^2, see AxisLaw; 0: yields do not grow

  [[nodiscard]] int num_elements() const { return static_cast<int>(yields.size() + relaxation_times.size()); }
  [[nodiscard]] int num_linear() const { return spring.size() + num_elements(); }
  [[nodiscard]] int num_nonlinear() const { return num_elements() + (yield_growth > 0.0 ? 1 : 0); }
};

/// One amplitude block of one test: what carries an error of its own (remounting gain, drift) and is resampled as a
/// whole.
struct DataBlock {
  const PreparedTest* test = nullptr;
  std::vector<CycleSpan> cycles;
  bool with_drift =
      false;  ///< the force zero may drift over the block; one cycle alone cannot tell drift from friction
  double force_range = 0.0;    ///< N or N m
  double force_unit = 0.0;     ///< N or N m: noise and model error together, what counts as an error of 1
  double energy_weight = 0.0;  ///< of the squared relative energy error
  double mean_energy = 0.0;    ///< J a cycle
  double robust_weight = 1.0;  ///< say of the test in the joint fit, 0 .. 1

  [[nodiscard]] double num_samples() const;
  /// Of a sample's squared force error, 1/N^2: the block as a whole weighs as one error of `force_unit`.
  [[nodiscard]] double row_weight() const;
};

/// All blocks of one axis and the range they cover.
struct AxisData {
  std::vector<DataBlock> blocks;
  double low = 0.0, high = 0.0;  ///< m or rad
  double smallest_amplitude = 0.0, largest_amplitude = 0.0;
  double lowest_frequency = 0.0, highest_frequency = 0.0;  ///< Hz; 0: no test has a known rate
  double noise_displacement = 0.0;
  /// The axis is one along which a link is its own mirror image (y, rx, rz): the spring is odd.
  SpringSymmetry symmetry = SpringSymmetry::none;
  bool closed = false;  ///< at least one closed cycle: friction can be told from stiffness
};

/// What a model misses of measured rubber's force, as a fraction of the loop's range: samples quieter than that deserve
/// no more say (I 2).
inline constexpr double k_model_error = 0.01;
/// Relative energy error that weighs as much as the force error k_model_error: 5 % of energy as much as 3 % of force,
/// which is what a fit of measured rubber is held to. Without energy rows least squares leaves 5-8 % of the energy even
/// with noise-free data (I 2).
inline constexpr double k_energy_unit = k_model_error * 5.0 / 3.0;

/// Blocks of the usable tests. A single block is split into its cycles, for want of better replicates.
[[nodiscard]] AxisData gather(const std::vector<const PreparedTest*>& tests);

/// What can be left out or resampled as a whole: the blocks of each test (numbers into AxisData::blocks); with a single
/// test every block by itself.
[[nodiscard]] std::vector<std::vector<std::size_t>> replicates(const AxisData& data);

/// The law with these coefficients; elements of zero stiffness are left out.
[[nodiscard]] AxisLaw make_law(const Dictionary& dictionary, const Eigen::VectorXd& coefficients);

}  // namespace grouser
