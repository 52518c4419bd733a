#pragma once
#include <Eigen/Core>
#include <vector>

#include "identification/monotone_basis.h"
#include "identification/prepared_test.h"
#include "model/bushing.h"

namespace grouser {

/// The nonlinear choice of a law: with it fixed, force = columns * coefficients is linear, coefficients >= 0.
/// Order of the columns: spring increments [N], stop stiffnesses [N/m], branch stiffnesses [N/m].
struct Dictionary {
  MonotoneBasis spring;
  std::vector<double> yields;            ///< m or rad
  std::vector<double> relaxation_times;  ///< s

  [[nodiscard]] int num_nonlinear() const { return static_cast<int>(yields.size() + relaxation_times.size()); }
  [[nodiscard]] int num_linear() const { return spring.size() + num_nonlinear(); }
};

/// One amplitude block of one test: what carries an error of its own (remounting gain, drift) and is resampled as a
/// whole.
struct DataBlock {
  const PreparedTest* test = nullptr;
  std::vector<CycleSpan> cycles;
  bool with_drift =
      false;  ///< the force zero may drift over the block; one cycle alone cannot tell drift from friction
  double row_weight = 0.0;     ///< of a sample's squared force error, 1/N^2
  double energy_weight = 0.0;  ///< of the squared relative energy error
  double mean_energy = 0.0;    ///< J a cycle
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

/// Blocks of the usable tests. A single block is split into its cycles, for want of better replicates.
[[nodiscard]] AxisData gather(const std::vector<const PreparedTest*>& tests);

/// Weighted normal equations of every block over [linear columns | d column / d log(yield or time) | force], in one
/// pass over the samples. Offset and drift are projected out of all columns and the force together (Frisch & Waugh);
/// the energy row of the block is included. Without derivatives the middle part is absent.
[[nodiscard]] std::vector<Eigen::MatrixXd> block_moments(const AxisData& data, const Dictionary& dictionary,
                                                         bool with_derivatives);

/// Adds the roughness penalty and a ridge on the linear columns, both relative to the data.
void regularise(Eigen::MatrixXd& moments, const Dictionary& dictionary);

/// Values of every linear column along a path of constant rate (one row a sample); states start at rest.
[[nodiscard]] Eigen::MatrixXd columns_along(const std::vector<double>& displacement, double time_step,
                                            const Dictionary& dictionary);

/// The law with these coefficients; elements of zero stiffness are left out.
[[nodiscard]] AxisLaw make_law(const Dictionary& dictionary, const Eigen::VectorXd& coefficients);

}  // namespace grouser
