// Closed forms of the elements, measured by the code that measures rig data.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "identification/element_history.h"
#include "identification/evaluate_fit.h"
#include "identification/prepared_test.h"
#include "tests/identification/bench.h"

namespace grouser {
namespace {

constexpr double k_pi = std::numbers::pi;

LoopMeasures last_loop(const AxisLaw& law, double amplitude, double frequency, int samples_per_cycle) {
  const int cycles = 12;
  RigTest test = sine_test(amplitude, frequency, cycles, samples_per_cycle, [](double, double) { return 0.0; });
  const std::vector<double> force = replay(law, test.time, test.displacement);
  const auto n = static_cast<std::size_t>(samples_per_cycle);
  return loop_measures(test.displacement, force, force, {(cycles - 1) * n, cycles * n}, frequency);
}

AxisLaw without_spring() {
  AxisLaw law;
  law.spring = SpringSpline::linear(0.0, 1.0);
  return law;
}

TEST(Stop, TurnsFourTimesYieldForceTimesSlipIntoHeat) {
  AxisLaw law = without_spring();
  law.stops = {{2.0e7, 0.1e-3}};
  const double amplitude = 0.5e-3;
  const LoopMeasures loop = last_loop(law, amplitude, 1.0, 4000);
  EXPECT_NEAR(loop.dissipated_energy, 4.0 * 2.0e7 * 0.1e-3 * (amplitude - 0.1e-3),
              3e-6);  // chords: (2 pi / 4000)^2 / 6 of the area, and corners cut by a step
  EXPECT_NEAR(loop.effective_stiffness, 2.0e7 * 0.1e-3 / amplitude, 1.0);
}

TEST(Stop, IsASpringBelowItsYield) {
  AxisLaw law = without_spring();
  law.stops = {{2.0e7, 0.1e-3}};
  const LoopMeasures loop = last_loop(law, 0.05e-3, 1.0, 400);
  EXPECT_NEAR(loop.dissipated_energy, 0.0, 1e-12);
  EXPECT_NEAR(loop.effective_stiffness, 2.0e7, 1.0);
}

TEST(MaxwellBranch, HasTheLoopOfItsClosedForm) {
  AxisLaw law = without_spring();
  law.branches = {{8.0e6, 0.02}};
  for (const double frequency : {1.0, 8.0, 60.0}) {
    const double omega = 2.0 * k_pi * frequency, c = 8.0e6 * 0.02, x = 0.3e-3;
    const double energy = k_pi * c * omega * x * x / (1.0 + std::pow(omega * 0.02, 2));
    const LoopMeasures loop = last_loop(law, x, frequency, 800);
    EXPECT_NEAR(loop.dissipated_energy, energy, 3e-5 * energy);  // chords: (2 pi / 800)^2 / 6 = 1e-5, twice
    EXPECT_NEAR(loop.equivalent_damping, energy / (k_pi * omega * x * x), 3e-5 * c);
  }
}

TEST(LoopMeasures, OfAViscoelasticEllipseAreItsOwnCoefficients) {
  const double k = 1.0e8, c = 2.0e4, x = 0.2e-3, frequency = 5.0, omega = 2.0 * k_pi * frequency;
  const RigTest test = sine_test(x, frequency, 1, 1000, [&](double at, double rate) { return k * at + c * rate; });
  const LoopMeasures loop = loop_measures(test.displacement, test.force, test.force, {0, 1000}, frequency);
  EXPECT_NEAR(loop.equivalent_damping, c, 1e-4 * c);
  EXPECT_NEAR(loop.effective_stiffness, std::hypot(k, c * omega), 1e-4 * k);
  EXPECT_NEAR(loop.dissipated_energy, k_pi * c * omega * x * x, 1e-4);
}

TEST(ElementHistory, KnowsItsDerivativesByYieldAndTime) {
  const double nudge = 1e-6;
  const auto run = [](double yield, double time) {
    const Dictionary dictionary{MonotoneBasis(-1.0, 1.0, 4), {yield}, {time}};
    ElementHistory history(dictionary);
    double x = 0.0;
    for (int i = 1; i <= 500; ++i) {
      const double next = std::sin(0.05 * i);
      history.advance(x, next, 0.01);
      x = next;
    }
    return std::pair(history.value(), history.derivative());
  };
  const auto [value, derivative] = run(0.3, 0.2);
  const auto [more, unused] = run(0.3 * std::exp(nudge), 0.2 * std::exp(nudge));
  EXPECT_NEAR(derivative[0], (more[0] - value[0]) / nudge, 1e-6);
  EXPECT_NEAR(derivative[1], (more[1] - value[1]) / nudge, 1e-5);
  EXPECT_GT(std::abs(derivative[1]), 1e-3);
}

TEST(Law, TakesWorkOnEveryClosedPath) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int trial = 0; trial < 400; ++trial) {
    AxisLaw law;
    const MonotoneBasis basis(-1.0, 1.0, 8);
    Eigen::VectorXd increments(basis.size());
    for (double& value : increments) value = uniform(random);
    law.spring = basis.spring(increments);
    for (int j = 0; j < 4; ++j) law.stops.push_back({uniform(random), 0.01 + uniform(random)});
    for (int k = 0; k < 4; ++k) law.branches.push_back({uniform(random), std::pow(10.0, 3.0 * uniform(random) - 2.0)});
    std::vector<double> time{0.0}, x{0.0};
    for (int leg = 0; leg < 12; ++leg) {
      const double from = x.back(), to = leg == 11 ? 0.0 : 2.0 * uniform(random) - 1.0;
      for (int i = 1; i <= 100; ++i) {
        x.push_back(from + (to - from) * i / 100.0);
        time.push_back(time.back() + 0.01);
      }
    }
    const std::vector<double> force = replay(law, time, x);
    double work = 0.0;
    for (std::size_t i = 1; i < x.size(); ++i) work += 0.5 * (force[i] + force[i - 1]) * (x[i] - x[i - 1]);
    EXPECT_GT(work, 0.0);  // a spring alone gives 0; every law here has friction
  }
}

}  // namespace
}  // namespace grouser
