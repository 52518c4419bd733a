// Loop measures of materials whose dynamic stiffness is known in closed form.
#include "identification/loop_measures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "model/bushing_law.h"
#include "tests/identification/bench.h"

namespace grouser {
namespace {

constexpr double k_pi = std::numbers::pi, k_stiffness = 1e7, k_amplitude = 1e-3, k_frequency = 5.0;
constexpr double k_omega = 2.0 * k_pi * k_frequency;

template <typename Force>
std::complex<double> stiffness_of(Force force) {
  const RigTest test = sine_test(k_amplitude, k_frequency, 3, 400, force);
  return dynamic_stiffness(test.time, test.displacement, test.force, {400, 800}, k_frequency);
}

TEST(DynamicStiffness, OfKelvinAndVoigtIsSpringAndDamper) {
  const auto k = stiffness_of([](double x, double rate) { return k_stiffness * x + 2e4 * rate; });
  EXPECT_NEAR(k.real(), k_stiffness, 1e-9 * k_stiffness);  // linear and exact at every sample: round-off
  EXPECT_NEAR(k.imag(), 2e4 * k_omega, 1e-9 * k_stiffness);
}

TEST(DynamicStiffness, OfAMaxwellBranchIsItsClosedForm) {
  const double tau = 0.02, ratio = k_omega * tau;
  RigTest test = sine_test(k_amplitude, k_frequency, 12, 400, [](double, double) { return 0.0; });
  const MaxwellStep step = maxwell_step({k_stiffness, tau}, test.time[1] - test.time[0]);
  for (std::size_t i = 1; i < test.force.size(); ++i) {
    test.force[i] = step.decay * test.force[i - 1] + step.gain * (test.displacement[i] - test.displacement[i - 1]);
  }
  const auto k = dynamic_stiffness(test.time, test.displacement, test.force, {4400, 4800}, k_frequency);
  const double scale = k_stiffness / (1.0 + ratio * ratio);
  EXPECT_NEAR(k.real(), scale * ratio * ratio, 1e-4 * k_stiffness);  // chords of 400 samples: (2 pi / 400)^2 / 6 = 4e-5
  EXPECT_NEAR(k.imag(), scale * ratio, 1e-4 * k_stiffness);
}

TEST(DynamicStiffness, OfDryFrictionIsFourOverPi) {
  const double friction = 2e3;
  const auto k = stiffness_of([&](double x, double rate) { return k_stiffness * x + std::copysign(friction, rate); });
  // The square wave's first harmonic is 4/pi of its height; a jump that comes a sample late turns it by 2 pi / 400.
  const double closed_form = 4.0 / k_pi * friction / k_amplitude;
  EXPECT_NEAR(k.real(), k_stiffness, 2.0 * k_pi / 400.0 * closed_form);
  EXPECT_NEAR(k.imag(), closed_form, 2.0 * k_pi / 400.0 * closed_form);
}

TEST(DynamicStiffness, OfACubicSpringHasThreeQuartersOfIt) {
  const auto k =
      stiffness_of([](double x, double) { return k_stiffness * (x + x * x * x / (k_amplitude * k_amplitude)); });
  EXPECT_NEAR(k.real(), 1.75 * k_stiffness, 1e-9 * k_stiffness);
  EXPECT_NEAR(k.imag(), 0.0, 1e-9 * k_stiffness);
}

TEST(DynamicStiffness, IsBlindToOffsetDriftAndTheCut) {
  RigTest test = sine_test(k_amplitude, k_frequency, 4, 150,
                           [](double x, double rate) { return k_stiffness * (x + x * x * x * 1e6) + 2e4 * rate; });
  for (std::size_t i = 0; i < test.time.size(); ++i) {
    test.force[i] += 700.0 + 3000.0 * test.time[i];
    test.displacement[i] += 2e-4 - 3e-4 * test.time[i];
  }
  const auto k = dynamic_stiffness(test.time, test.displacement, test.force, {131, 284}, k_frequency);
  EXPECT_NEAR(k.real(), 1.75 * k_stiffness, 1e-9 * k_stiffness);
  EXPECT_NEAR(k.imag(), 2e4 * k_omega, 1e-9 * k_stiffness);
}

TEST(LoopMeasures, OfAForceThatStandsStillAreZero) {
  const RigTest test = sine_test(k_amplitude, k_frequency, 3, 400, [](double, double) { return 0.0; });
  const LoopMeasures measures = loop_measures(test.displacement, test.force, test.force, {400, 800}, k_frequency);
  EXPECT_EQ(measures.loss_factor, 0.0);  // 0/0 by its definition
  EXPECT_EQ(measures.effective_stiffness, 0.0);
  EXPECT_EQ(measures.equivalent_damping, 0.0);
}

TEST(LoopMeasures, SecantStandsAtTheExtremeDisplacements) {
  // A Kelvin-Voigt loop: at the extremes the damper is still, though the force is largest elsewhere.
  const RigTest test =
      sine_test(k_amplitude, k_frequency, 2, 400, [](double x, double rate) { return k_stiffness * x + 2e5 * rate; });
  const LoopMeasures loop = loop_measures(test.displacement, test.force, test.force, {400, 800}, k_frequency);
  EXPECT_NEAR(loop.secant_stiffness, k_stiffness, 1e-9 * k_stiffness);
  const double complex_modulus = std::hypot(k_stiffness, 2e5 * k_omega);
  EXPECT_NEAR(loop.effective_stiffness, complex_modulus, 4e-5 * complex_modulus);  // half a sample beside the crest
}

}  // namespace
}  // namespace grouser
