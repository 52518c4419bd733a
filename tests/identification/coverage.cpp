#include "tests/identification/coverage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identification/identify.h"
#include "tests/identification/bench.h"

namespace grouser {
namespace {

enum Family : std::size_t { energy, loss_factor, storage_stiffness, backbone, tangent };

class Comparison {
 public:
  explicit Comparison(std::uint64_t seed) : rubber_(random_rubber(seed)) { result_.outside = outside_mechanism(seed); }

  void responses(const AxisFit& fit) {
    for (const ResponsePoint& cell : fit.responses) {
      const SteadyResponse truth = true_steady_response(rubber_, cell.amplitude, cell.frequency);
      const double mm = 1e3 * cell.amplitude;
      for (const double amplitude : {0.05, 0.2, 1.0}) {
        if (is_near(mm, amplitude)) add(energy, fmt::format("energy at {} mm", amplitude), cell.energy, truth.energy);
      }
      for (const double frequency : {0.1, 5.0, 70.0}) {
        if (is_near(cell.frequency, frequency))
          add(loss_factor, fmt::format("loss factor at {} Hz", frequency), cell.loss_factor, truth.loss_factor);
      }
      add(storage_stiffness, "storage stiffness", cell.storage_stiffness, truth.storage_stiffness);
      worsen(result_.worst_energy, cell.energy.value, truth.energy);
      worsen(result_.worst_storage_stiffness, cell.storage_stiffness.value, truth.storage_stiffness);
    }
  }

  void ramp(const AxisFit& fit, double period) {
    const Backbone truth = true_backbone(rubber_, fit.backbone.front().x, fit.backbone.back().x, period);
    const std::size_t intervals = truth.force.size() - 1;
    double true_mean = 0.0, fitted_mean = 0.0;
    for (std::size_t i = 0; i <= intervals; ++i) {
      true_mean += truth.force[i] / static_cast<double>(intervals + 1);
      fitted_mean += fit.backbone[i].value / static_cast<double>(intervals + 1);
    }
    const double half_range = 0.5 * (truth.force.back() - truth.force.front());
    for (std::size_t station = 0; station < 5; ++station) {
      const BandPoint& point = fit.backbone[station * intervals / 4];
      const double value = truth.force[station * intervals / 4] - true_mean + fitted_mean;
      add(backbone, fmt::format("backbone, station {} of 5", station + 1), {point.value, point.low, point.high}, value,
          half_range);
    }
    const std::size_t window = (fit.backbone.size() - fit.tangent.size()) / 2, last = fit.tangent.size() - 1;
    for (std::size_t i = 0; i <= last; ++i) {
      const double slope = (truth.force[i + 2 * window] - truth.force[i]) / (2.0 * fit.tangent_window);
      const BandPoint& point = fit.tangent[i];
      worsen(result_.worst_tangent, point.value, slope);
      if (i % (last / 4) == 0) add(tangent, "tangent", {point.value, point.low, point.high}, slope);
    }
  }

  [[nodiscard]] const SeedCoverage& result() const { return result_; }

 private:
  static bool is_near(double a, double b) { return std::abs(a - b) < 0.1 * b; }
  static void worsen(double& worst, double value, double truth) {
    worst = std::max(worst, std::abs(value / truth - 1.0));
  }
  void add(Family family, const std::string& name, const Interval& stated, double truth, double unit = 0.0) {
    const bool holds = stated.low <= truth && truth <= stated.high;
    const double half_width = 0.5 * (stated.high - stated.low) / (unit > 0.0 ? unit : truth);
    result_.quantities[name].add(holds, half_width);
    result_.families[family].add(holds, half_width);
  }

  TrueRubber rubber_;
  SeedCoverage result_;
};

}  // namespace

void Coverage::add(bool holds, double half_width) { add({1, holds ? 1 : 0, half_width}); }

void Coverage::add(const Coverage& other) {
  stated += other.stated;
  held += other.held;
  sum_half_width += other.sum_half_width;
}

SeedCoverage coverage_of_seed(std::uint64_t seed) {
  const AxisCampaign campaign = random_campaign(seed);
  std::vector<RigTest> tests;
  for (const PlannedTest& plan : campaign.tests) tests.push_back(as_rig_test(run_test(campaign, plan, seed)));
  const IdentifyResult result = identify(record_of(std::move(tests)));
  const auto ramp = std::ranges::find(result.fit.tests, TestKind::static_ramp, &TestFit::kind);
  Comparison comparison(seed);
  comparison.responses(result.fit.axes.front());
  comparison.ramp(result.fit.axes.front(), 1.0 / ramp->frequency);
  return comparison.result();
}

}  // namespace grouser
