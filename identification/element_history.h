#pragma once
#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "identification/axis_problem.h"
#include "model/bushing_law.h"

namespace grouser {

/// States of all elements of a dictionary at unit stiffness, advanced by the very functions that the simulator calls,
/// and, when asked for, their derivatives by the logarithms of the nonlinear parameters.
class ElementHistory {
 public:
  explicit ElementHistory(const Dictionary& dictionary, bool with_derivatives = true)
      : dictionary_(&dictionary),
        with_derivatives_(with_derivatives),
        value_(Eigen::ArrayXd::Zero(dictionary.num_elements())),
        derivative_(Eigen::ArrayXd::Zero(dictionary.num_elements())),
        by_growth_(Eigen::ArrayXd::Zero(with_derivatives && dictionary.yield_growth > 0.0 ? num_stops() : 0)),
        decay_(dictionary.relaxation_times.size()),
        gain_(decay_.size()),
        decay_derivative_(decay_.size()),
        gain_derivative_(decay_.size()) {}

  /// The displacement goes to `to` over the time h.
  void advance(double from, double to, double h) {
    const double dx = to - from;
    advance_stops(to, dx);
    if (std::abs(h - h_) > 1e-9 * h) set_step(h);
    auto force = value_.tail(decay_.size());
    if (with_derivatives_) {
      auto slope = derivative_.tail(decay_.size());
      slope = decay_ * slope + decay_derivative_ * force + gain_derivative_ * dx;
    }
    force = decay_ * force + gain_ * dx;
  }

  /// m or rad for stops, then N / (N/m) for branches.
  [[nodiscard]] const Eigen::ArrayXd& value() const { return value_; }
  /// By log(yield) or log(relaxation time) of the element itself.
  [[nodiscard]] const Eigen::ArrayXd& derivative() const { return derivative_; }
  /// Of the stops by log(yield growth); empty when the yields do not grow.
  [[nodiscard]] const Eigen::ArrayXd& by_growth() const { return by_growth_; }

 private:
  [[nodiscard]] Eigen::Index num_stops() const { return static_cast<Eigen::Index>(dictionary_->yields.size()); }

  // One loop each, without branches and aliases: the compiler turns them into vector instructions.
  void advance_stops(double to, double dx) {
    const auto count = num_stops();
    const double* __restrict yield = dictionary_->yields.data();
    double* __restrict z = value_.data();
    const double scale = yield_scale(dictionary_->yield_growth, to);
    if (!with_derivatives_) {
      for (Eigen::Index j = 0; j < count; ++j) z[j] = advance_stop(z[j], dx, yield[j] * scale);
      return;
    }
    // a slipping stop carries +- its yield, a sticking one keeps what it had
    double* __restrict slope = derivative_.data();
    double* __restrict by_growth = by_growth_.data();
    const double share = 1.0 - 1.0 / scale;  // d log(grown yield) / d log(growth)
    const bool grows = by_growth_.size() > 0;
    for (Eigen::Index j = 0; j < count; ++j) {
      const double trial = z[j] + dx, next = advance_stop(z[j], dx, yield[j] * scale);
      if (grows) by_growth[j] = next == trial ? by_growth[j] : share * next;
      slope[j] = next == trial ? slope[j] : next;
      z[j] = next;
    }
  }

  void set_step(double h) {
    h_ = h;
    for (Eigen::Index k = 0; k < decay_.size(); ++k) {
      const double tau = dictionary_->relaxation_times[static_cast<std::size_t>(k)], ratio = h / tau;
      const MaxwellStep step = maxwell_step({1.0, tau}, h);
      decay_[k] = step.decay;
      gain_[k] = step.gain;
      decay_derivative_[k] = ratio * step.decay;
      // (1 - e^-u - u e^-u) / u cancels for small u; its series is u/2 - u^2/3
      gain_derivative_[k] = ratio > 1e-4 ? (1.0 - step.decay) / ratio - step.decay : ratio * (0.5 - ratio / 3.0);
    }
  }

  const Dictionary* dictionary_;
  bool with_derivatives_;
  Eigen::ArrayXd value_, derivative_, by_growth_;
  Eigen::ArrayXd decay_, gain_, decay_derivative_, gain_derivative_;
  double h_ = -1.0;
};

}  // namespace grouser
