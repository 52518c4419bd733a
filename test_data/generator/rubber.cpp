#include "test_data/generator/rubber.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "model/bushing_law.h"

namespace grouser {
namespace {

constexpr double k_scatter = 0.1;  // lognormal, of places and sizes

}  // namespace

double PortableRandom::uniform() {
  state_ += 0x9E3779B97F4A7C15ULL;  // splitmix64 (Steele, Lea & Flood 2014)
  std::uint64_t z = state_;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  z ^= z >> 31;
  return (static_cast<double>(z >> 11) + 0.5) * 0x1p-53;
}

double PortableRandom::normal() {
  const double radius = std::sqrt(-2.0 * std::log(uniform()));
  return radius * std::cos(2.0 * std::numbers::pi * uniform());
}

std::vector<MaxwellBranch> TrueRubber::springpot_series() const {
  if (springpot == 0.0) return {};
  constexpr int per_decade = 8, first = -5 * per_decade, last = 4 * per_decade;
  const double spacing = std::numbers::ln10 / per_decade;
  const double scale = springpot / (std::tgamma(1.0 - springpot_order) * std::tgamma(springpot_order));
  std::vector<MaxwellBranch> series;
  for (int i = first; i <= last; ++i) {
    const double time = std::pow(10.0, static_cast<double>(i) / per_decade);
    series.push_back({scale * std::pow(time, -springpot_order) * spacing, time});
  }
  return series;
}

double TrueRubber::elastic(double x) const {
  const double stretch = clearance > 0.0 ? std::copysign(std::max(std::abs(x) - clearance, 0.0), x) : x;
  const double force = (k1 + k3 * stretch * stretch) * stretch;
  if (hard_stop_stiffness == 0.0) return force;
  const double past = (std::abs(x) - hard_stop) / hard_stop_width;  // stiffness grows as the logistic function
  const double contact = past > 30.0 ? past : std::log1p(std::exp(past));
  return force + std::copysign(hard_stop_stiffness * hard_stop_width * contact, x);
}

TrueRubber make_rubber(double stiffness, double stroke, std::uint64_t seed) {
  PortableRandom random(seed);
  const auto scattered = [&](double value) { return value * std::exp(k_scatter * random.normal()); };
  TrueRubber rubber;
  rubber.k1 = 0.76 * stiffness;
  rubber.k3 = 0.14 * stiffness / (stroke * stroke);
  constexpr std::array yields{0.003, 0.007, 0.016, 0.035, 0.075, 0.16, 0.34, 0.7};
  constexpr std::array sizes{0.02, 0.03, 0.04, 0.05, 0.055, 0.055, 0.045, 0.03};
  for (std::size_t j = 0; j < yields.size(); ++j) {
    rubber.stops.push_back({scattered(sizes[j] * stiffness), scattered(yields[j] * stroke)});
  }
  for (const double time : {6.0, 0.9, 0.13, 0.021, 0.0034, 0.0006}) {
    rubber.branches.push_back({scattered(0.042 * stiffness), scattered(time)});
  }
  rubber.springpot_order = 0.14;
  // storage stiffness of 6 % at 1 Hz: C w^a cos(pi a / 2)
  rubber.springpot = 0.06 * stiffness /
                     (std::pow(2.0 * std::numbers::pi, rubber.springpot_order) *
                      std::cos(0.5 * std::numbers::pi * rubber.springpot_order));
  return rubber;
}

RubberState::RubberState(const TrueRubber& rubber)
    : rubber_(rubber), branches_(rubber.branches), deflection_(rubber.stops.size()) {
  for (const MaxwellBranch& branch : rubber.springpot_series()) branches_.push_back(branch);
  branch_force_.resize(branches_.size());
  decay_.resize(branches_.size());
  gain_.resize(branches_.size());
}

double RubberState::advance(double x, double h) {
  const double dx = x - x_;
  x_ = x;
  if (std::abs(h - step_) > 1e-9 * h) {
    step_ = h;
    for (std::size_t k = 0; k < branches_.size(); ++k) {
      const MaxwellStep step = maxwell_step(branches_[k], h);
      decay_[k] = step.decay;
      gain_[k] = step.gain;
    }
  }
  double force = rubber_.elastic(x);
  const double growth = 1.0 + rubber_.yield_growth * x * x;
  for (std::size_t j = 0; j < deflection_.size(); ++j) {
    deflection_[j] = advance_stop(deflection_[j], dx, rubber_.stops[j].yield * growth);
    force += rubber_.stops[j].stiffness * deflection_[j];
  }
  for (std::size_t k = 0; k < branches_.size(); ++k) {
    branch_force_[k] = decay_[k] * branch_force_[k] + gain_[k] * dx;
    force += branch_force_[k];
  }
  return force;
}

}  // namespace grouser
