#include "test_data/generator/random_campaign.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

namespace grouser {
namespace {

constexpr double k_pi = std::numbers::pi;
constexpr double k_mm = 1e-3, k_kilonewton_per_mm = 1e6;

PlannedTest planned_loop(double amplitude, double frequency) {
  PlannedTest test;
  test.name = fmt::format("x_loop_{:g}mm_{:g}hz", amplitude / k_mm, frequency);
  test.amplitude = amplitude;
  test.frequency = frequency;
  test.cycles = 10;
  test.samples_per_cycle = 200;
  return test;
}

PlannedTest planned_ramps() {
  PlannedTest test;
  test.name = "x_static";
  test.kind = TestKind::static_ramp;
  test.amplitude = 0.5 * k_mm;
  test.rate = 2.0 * k_mm / 60.0;
  test.peak_force = 10.0e3 * 9.80665;
  test.cycles = 6;
  test.samples_per_cycle = 240;
  return test;
}

}  // namespace

OutsideMechanism outside_mechanism(std::uint64_t seed) {
  return static_cast<OutsideMechanism>(seed % k_num_outside_mechanisms);
}

TrueRubber random_rubber(std::uint64_t seed) {
  PortableRandom random(seed * 0x9E3779B97F4A7C15ULL + 1);  // neighbouring seeds are strangers
  const auto scattered = [&](double value, double width) { return value * std::exp(width * random.normal()); };
  TrueRubber rubber;
  rubber.k1 = scattered(65.0, 0.15) * k_kilonewton_per_mm;
  rubber.k3 = scattered(20.0, 0.4) * k_kilonewton_per_mm / (k_mm * k_mm);
  constexpr std::array yields{0.004, 0.012, 0.03, 0.08, 0.2, 0.5};
  constexpr std::array sizes{8.0, 8.0, 8.0, 6.0, 6.0, 5.0};
  for (std::size_t j = 0; j < yields.size(); ++j) {
    const double stiffness = scattered(sizes[j], 0.3) * k_kilonewton_per_mm;
    rubber.stops.push_back({stiffness, scattered(yields[j], 0.3) * k_mm});
  }
  for (const double time : {2.0, 0.2, 0.02, 0.002}) {
    const double stiffness = scattered(8.0, 0.3) * k_kilonewton_per_mm;
    rubber.branches.push_back({stiffness, scattered(time, 0.5)});
  }
  const OutsideMechanism outside = outside_mechanism(seed);
  if (outside == OutsideMechanism::springpot || outside == OutsideMechanism::both) {
    rubber.springpot_order = 0.1 + 0.2 * random.uniform();
    // storage stiffness at 1 Hz: C w^a cos(pi a / 2)
    rubber.springpot = scattered(10.0, 0.3) * k_kilonewton_per_mm /
                       (std::pow(2.0 * k_pi, rubber.springpot_order) * std::cos(0.5 * k_pi * rubber.springpot_order));
  }
  if (outside == OutsideMechanism::growing_yield || outside == OutsideMechanism::both) {
    rubber.yield_growth = (0.3 + 0.7 * random.uniform()) / (k_mm * k_mm);
  }
  return rubber;
}

AxisCampaign random_campaign(std::uint64_t seed) {
  AxisCampaign campaign;
  campaign.rubber = random_rubber(seed);
  campaign.errors.displacement_noise = 0.5e-6;
  campaign.errors.displacement_quantum = 0.1e-6;
  campaign.errors.force_noise = 100.0;
  campaign.errors.force_quantum = 30.0;
  campaign.errors.force_offset = 300.0;
  campaign.errors.force_drift = 200.0;
  campaign.errors.remounting_gain = 3e-3;
  campaign.errors.conditioning = 0.15;
  for (const double amplitude : {0.05, 0.1, 0.2, 0.5, 1.0}) {
    for (const double frequency : {0.1, 1.0, 5.0, 20.0, 70.0}) {
      campaign.tests.push_back(planned_loop(amplitude * k_mm, frequency));
    }
  }
  campaign.tests.push_back(planned_ramps());
  return campaign;
}

SteadyResponse true_steady_response(const TrueRubber& rubber, double amplitude, double frequency, double centre) {
  constexpr int steps = 4000;
  TrueRubber instant = rubber;  // what does not know about time
  instant.branches.clear();
  instant.springpot = 0.0;
  RubberState state(instant);
  double in_phase = 0.0, quadrature = 0.0;
  for (int i = 0; i <= 3 * steps; ++i) {  // two cycles settle it
    const double phase = 2.0 * k_pi * i / steps;
    const double force = state.advance(centre + amplitude * std::sin(phase), 1.0);
    if (i <= 2 * steps) continue;
    in_phase += force * std::sin(phase) * 2.0 / steps;
    quadrature += force * std::cos(phase) * 2.0 / steps;
  }
  SteadyResponse response;
  double loss = quadrature / amplitude;
  response.storage_stiffness = in_phase / amplitude;
  std::vector<MaxwellBranch> branches = rubber.branches;
  for (const MaxwellBranch& branch : rubber.springpot_series()) branches.push_back(branch);
  for (const MaxwellBranch& branch : branches) {
    const double turns = 2.0 * k_pi * frequency * branch.relaxation_time;
    response.storage_stiffness += branch.stiffness * turns * turns / (1.0 + turns * turns);
    loss += branch.stiffness * turns / (1.0 + turns * turns);
  }
  response.energy = k_pi * loss * amplitude * amplitude;
  response.loss_factor = loss / response.storage_stiffness;
  return response;
}

}  // namespace grouser
