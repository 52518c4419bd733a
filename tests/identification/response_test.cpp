// The settled response of a law against closed forms and against the generator's own simulation.
#include "identification/response.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "test_data/generator/random_campaign.h"

namespace grouser {
namespace {

constexpr double k_pi = std::numbers::pi;

TEST(Response, OfAStopIsItsDescribingFunction) {
  // Masing loop of yield r under amplitude X: energy 4 r (X - r), K' = k (t - sin t cos t) / pi with cos t = 1 - 2 r /
  // X.
  AxisLaw law;
  law.spring = SpringSpline::linear(0.0, 1e-3);
  law.stops = {{5e6, 0.08e-3}};
  for (const double amplitude : {0.05e-3, 0.1e-3, 1e-3}) {
    const HarmonicResponse response = rate_independent_response(law, amplitude, 0.3e-3);
    const double angle = amplitude > 0.08e-3 ? std::acos(1.0 - 2.0 * 0.08e-3 / amplitude) : k_pi;
    const double energy = amplitude > 0.08e-3 ? 4.0 * 5e6 * 0.08e-3 * (amplitude - 0.08e-3) : 0.0;
    const double storage = 5e6 * (angle - std::sin(angle) * std::cos(angle)) / k_pi;
    // A corner between two of 512 steps costs at most (2 pi / 512)^2 = 1.5e-4 of the stop's own stiffness.
    EXPECT_NEAR(response.storage_stiffness, storage, 2e-4 * 5e6);
    EXPECT_NEAR(response.loss_stiffness, energy / (k_pi * amplitude * amplitude), 2e-4 * 5e6);
  }
}

TEST(Response, OfACubicSpringGrowsWithTheSquareOfTheAmplitude) {
  AxisLaw law;
  for (int i = -200; i <= 200; ++i) {
    const double x = 1e-5 * i;
    law.spring.displacement.push_back(x);
    law.spring.force.push_back(65e6 * x + 20e12 * x * x * x);
    law.spring.slope.push_back(65e6 + 60e12 * x * x);
  }
  const HarmonicResponse response = rate_independent_response(law, 1e-3, 0.0);
  EXPECT_NEAR(response.storage_stiffness, 65e6 + 0.75 * 20e12 * 1e-6, 1.0);  // round-off of 512 terms of 1e5 N
  EXPECT_NEAR(response.loss_stiffness, 0.0, 1.0);
}

TEST(Response, OfABranchIsItsComplexStiffness) {
  AxisLaw law;
  law.branches = {{8e6, 0.02}};
  law.viscous = 100.0;
  for (const double frequency : {0.1, 8.0, 70.0}) {
    const double omega = 2.0 * k_pi * frequency, turns = omega * 0.02;
    const HarmonicResponse response = viscoelastic_response(law, frequency);
    EXPECT_DOUBLE_EQ(response.storage_stiffness, 8e6 * turns * turns / (1.0 + turns * turns));
    EXPECT_DOUBLE_EQ(response.loss_stiffness, 8e6 * turns / (1.0 + turns * turns) + 100.0 * omega);
  }
}

// The generator follows its own rubber with its own stepping; the same elements must answer alike.
TEST(Response, OfTheTrueElementsIsTheTruth) {
  const TrueRubber rubber = random_rubber(4);  // none but the law's own mechanisms
  AxisLaw law;
  for (int i = -100; i <= 100; ++i) {
    const double x = 1.2e-5 * i;
    law.spring.displacement.push_back(x);
    law.spring.force.push_back(rubber.elastic(x));
    law.spring.slope.push_back(rubber.k1 + 3.0 * rubber.k3 * x * x);
  }
  law.stops = rubber.stops;
  law.branches = rubber.branches;
  for (const double amplitude : {0.05e-3, 0.2e-3, 1e-3}) {
    const SteadyResponse truth = true_steady_response(rubber, amplitude, 5.0);
    const HarmonicResponse instant = rate_independent_response(law, amplitude, 0.0);
    const HarmonicResponse viscoelastic = viscoelastic_response(law, 5.0);
    const double storage = instant.storage_stiffness + viscoelastic.storage_stiffness;
    const double loss = instant.loss_stiffness + viscoelastic.loss_stiffness;
    EXPECT_NEAR(storage, truth.storage_stiffness, 2e-4 * storage);  // corners, see above
    EXPECT_NEAR(k_pi * loss * amplitude * amplitude, truth.energy, 1e-3 * truth.energy);
    EXPECT_NEAR(loss / storage, truth.loss_factor, 1e-3 * truth.loss_factor);
  }
  const Backbone truth = true_backbone(rubber, -0.2e-3, 0.9e-3, 60.0);
  const std::vector<double> backbone = backbone_of(law, -0.2e-3, 0.9e-3, 60.0, 40);
  const double span = truth.force.back() - truth.force.front();
  for (std::size_t i = 0; i < backbone.size(); ++i) {
    // Two settled triangles of 200 and 1000 steps a leg; the slowest branch (seconds) settles within the first.
    EXPECT_NEAR(backbone[i], truth.force[i], 2e-4 * span) << i;
  }
}

}  // namespace
}  // namespace grouser
