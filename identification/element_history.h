#pragma once
#include <cmath>
#include <vector>

#include "identification/axis_problem.h"
#include "model/bushing_law.h"

namespace grouser {

/// States of all elements of a dictionary at unit stiffness, advanced by the very functions that the simulator calls,
/// with their derivatives by log(yield) and log(relaxation time).
class ElementHistory {
 public:
  explicit ElementHistory(const Dictionary& dictionary)
      : dictionary_(&dictionary),
        value_(static_cast<std::size_t>(dictionary.num_nonlinear())),
        derivative_(value_.size()),
        steps_(dictionary.relaxation_times.size()),
        step_derivatives_(steps_.size()) {}

  /// Displacement grew by dx over the time h.
  void advance(double dx, double h) {
    const std::vector<double>& yields = dictionary_->yields;
    for (std::size_t j = 0; j < yields.size(); ++j) {
      const double trial = value_[j] + dx;
      value_[j] = advance_stop(value_[j], dx, yields[j]);
      if (trial > yields[j]) derivative_[j] = yields[j];
      if (trial < -yields[j]) derivative_[j] = -yields[j];
    }
    if (std::abs(h - h_) > 1e-9 * h) set_step(h);
    for (std::size_t k = 0; k < steps_.size(); ++k) {
      double& force = value_[yields.size() + k];
      double& slope = derivative_[yields.size() + k];
      slope = steps_[k].decay * slope + step_derivatives_[k].decay * force + step_derivatives_[k].gain * dx;
      force = steps_[k].decay * force + steps_[k].gain * dx;
    }
  }

  [[nodiscard]] const std::vector<double>& value() const { return value_; }
  [[nodiscard]] const std::vector<double>& derivative() const { return derivative_; }

 private:
  void set_step(double h) {
    h_ = h;
    for (std::size_t k = 0; k < steps_.size(); ++k) {
      const double tau = dictionary_->relaxation_times[k], ratio = h / tau;
      steps_[k] = maxwell_step({1.0, tau}, h);
      const double decay = steps_[k].decay;
      step_derivatives_[k].decay = ratio * decay;
      // (1 - e^-u - u e^-u) / u cancels for small u; its series is u/2 - u^2/3
      step_derivatives_[k].gain = ratio > 1e-4 ? (1.0 - decay) / ratio - decay : ratio * (0.5 - ratio / 3.0);
    }
  }

  const Dictionary* dictionary_;
  std::vector<double> value_, derivative_;
  std::vector<MaxwellStep> steps_, step_derivatives_;
  double h_ = -1.0;
};

}  // namespace grouser
