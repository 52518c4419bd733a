#pragma once
#include <Eigen/Core>
#include <vector>

#include "identification/axis_problem.h"

namespace grouser {

/// Normal equations of one block over [linear columns | derivative columns | force].
/// Derivative columns: of every element by the log of its own yield or time; then, when yields grow, of every stop by
/// log(growth). Without derivatives they are absent.
struct BlockMoments {
  Eigen::MatrixXd force;   ///< of all samples, weighted; offset and drift projected out of columns and force together
  Eigen::VectorXd energy;  ///< loop area of every column over the measured area, 1 for the force; empty when open
  double energy_weight = 0.0;

  /// Normal equations of samples and energy row together.
  [[nodiscard]] Eigen::MatrixXd total() const;
};

/// Moments of every block in one pass over the samples (projection: Frisch & Waugh 1933).
[[nodiscard]] std::vector<BlockMoments> split_moments(const AxisData& data, const Dictionary& dictionary,
                                                      bool with_derivatives);
/// The totals of split_moments().
[[nodiscard]] std::vector<Eigen::MatrixXd> block_moments(const AxisData& data, const Dictionary& dictionary,
                                                         bool with_derivatives);

/// Sum of all totals, not regularised.
[[nodiscard]] Eigen::MatrixXd sum_of(const std::vector<BlockMoments>& blocks);

/// Weights (derivative columns x num_nonlinear) that add the derivative columns up to d force / d log parameter of the
/// law with these coefficients.
[[nodiscard]] Eigen::MatrixXd derivative_weights(const Dictionary& dictionary, const Eigen::VectorXd& coefficients);

/// Adds the roughness penalty and a ridge on the linear columns, both relative to the data.
void regularise(Eigen::MatrixXd& moments, const Dictionary& dictionary);

/// Sum of all blocks' moments, each with its weight (empty = 1), regularised.
[[nodiscard]] Eigen::MatrixXd weighted_sum(const std::vector<Eigen::MatrixXd>& blocks,
                                           const std::vector<double>& weights, const Dictionary& dictionary);

/// Values of every linear column along a path of constant rate (one row a sample); states start at rest.
[[nodiscard]] Eigen::MatrixXd columns_along(const std::vector<double>& displacement, double time_step,
                                            const Dictionary& dictionary);

}  // namespace grouser
