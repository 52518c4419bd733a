#include "identification/response.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "model/bushing_law.h"

namespace grouser {
namespace {

constexpr int k_steps_per_cycle = 512;  // a stop's corner falls between two steps: 1e-4 of its energy
constexpr int k_steps_per_interval = 5;

// Force of spring and stops from rest.
class RateIndependentForce {
 public:
  explicit RateIndependentForce(const AxisLaw& law) : law_(&law), deflection_(law.stops.size()) {}

  double advance(double x) {
    const double dx = x - x_, growth = yield_scale(law_->yield_growth, x);
    x_ = x;
    double force = evaluate(law_->spring, x).force;
    for (std::size_t j = 0; j < deflection_.size(); ++j) {
      deflection_[j] = advance_stop(deflection_[j], dx, law_->stops[j].yield * growth);
      force += law_->stops[j].stiffness * deflection_[j];
    }
    return force;
  }

 private:
  const AxisLaw* law_;
  std::vector<double> deflection_;
  double x_ = 0.0;
};

// Force of branches and damper from rest, at a constant step.
class ViscoelasticForce {
 public:
  ViscoelasticForce(const AxisLaw& law, double step)
      : damping_per_step_(law.viscous / step), force_(law.branches.size()) {
    for (const MaxwellBranch& branch : law.branches) steps_.push_back(maxwell_step(branch, step));
  }

  double advance(double dx) {
    double total = damping_per_step_ * dx;
    for (std::size_t k = 0; k < steps_.size(); ++k) {
      force_[k] = steps_[k].decay * force_[k] + steps_[k].gain * dx;
      total += force_[k];
    }
    return total;
  }

 private:
  double damping_per_step_;
  std::vector<MaxwellStep> steps_;
  std::vector<double> force_;
};

}  // namespace

HarmonicResponse rate_independent_response(const AxisLaw& law, double amplitude, double centre) {
  RateIndependentForce state(law);
  double in_phase = 0.0, quadrature = 0.0;
  for (int i = 0; i <= 2 * k_steps_per_cycle; ++i) {  // the first cycle settles every stop
    const double phase = 2.0 * std::numbers::pi * i / k_steps_per_cycle;
    const double force = state.advance(centre + amplitude * std::sin(phase));
    if (i <= k_steps_per_cycle) continue;
    in_phase += force * std::sin(phase);
    quadrature += force * std::cos(phase);
  }
  const double scale = 2.0 / (k_steps_per_cycle * amplitude);
  return {scale * in_phase, scale * quadrature};
}

HarmonicResponse viscoelastic_response(const AxisLaw& law, double frequency) {
  const double omega = 2.0 * std::numbers::pi * frequency;
  HarmonicResponse response{0.0, law.viscous * omega};
  for (const MaxwellBranch& branch : law.branches) {
    const double turns = omega * branch.relaxation_time, share = branch.stiffness / (1.0 + turns * turns);
    response.storage_stiffness += share * turns * turns;
    response.loss_stiffness += share * turns;
  }
  return response;
}

std::vector<double> backbone_of(const AxisLaw& law, double low, double high, double period, int num_intervals) {
  const int ramp = num_intervals * k_steps_per_interval;
  RateIndependentForce instant(law);
  ViscoelasticForce slow(law, 0.5 * period / ramp);
  std::vector<double> force{instant.advance(low)};
  double x = low;
  for (int i = 1; i <= 4 * ramp; ++i) {  // up, down, up, down; the first two settle it
    const int done = i % (2 * ramp), station = std::min(done, 2 * ramp - done);
    const double next = low + (high - low) * station / ramp;
    force.push_back(instant.advance(next) + slow.advance(next - x));
    x = next;
  }
  std::vector<double> mean;
  for (int i = 0; i <= num_intervals; ++i) {
    const auto up = static_cast<std::size_t>(2 * ramp + i * k_steps_per_interval);
    const auto down = static_cast<std::size_t>(4 * ramp - i * k_steps_per_interval);
    mean.push_back(0.5 * (force[up] + force[down]));
  }
  return mean;
}

}  // namespace grouser
