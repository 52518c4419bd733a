#include "simulator/integrator.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "simulator/links.h"
#include "tests/support/closed_forms.h"
#include "tests/support/scalar_run.h"
#include "tests/support/tops.h"

namespace grouser::test {
namespace {

constexpr double k_beta = 28.0 / 27.0;

auto oscillator_force(double damping) {
  return [damping](double, double u, double v) { return -2.0 * damping * v - u; };
}

TEST(ChungLee, IsOfSecondOrderOnADampedDrivenOscillator) {
  const Oscillator exact{2.0 * k_pi, 0.05, 3.0, 1.7 * k_pi, 1.0, 0.5};
  struct Row {
    int steps;
    double u, v;
  };
  // Largest errors over 4 s, three digits, as published with the method's table.
  for (const Row& row : {Row{400, 6.62e-4, 7.51e-3}, Row{800, 1.618e-4, 1.884e-3}, Row{1600, 3.997e-5, 4.720e-4},
                         Row{3200, 9.934e-6, 1.181e-4}, Row{6400, 2.476e-6, 2.954e-5}}) {
    ScalarRun run(
        k_beta, [&](double t, double u, double v) { return exact.acceleration(t, u, v); }, 1.0, 0.5);
    double worst_u = 0.0, worst_v = 0.0;
    for (int i = 0; i < row.steps; ++i) {
      run.step(4.0 / row.steps);
      const auto [u, v] = exact.at(run.t);
      worst_u = std::max(worst_u, std::abs(run.u - u));
      worst_v = std::max(worst_v, std::abs(run.v - v));
    }
    EXPECT_NEAR(worst_u / row.u, 1.0, 2e-3) << row.steps << " steps";  // the table's rounding
    EXPECT_NEAR(worst_v / row.v, 1.0, 2e-3) << row.steps << " steps";
  }
}

struct StabilityRow {
  double beta;
  std::array<double, 12> limit;
};
constexpr std::array<double, 12> k_damping{0.0, 0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 2.0, 5.0};
// Largest stable omega h over damping ratio.
constexpr StabilityRow k_stability[] = {
    {1.0, {2.0000, 1.9604, 1.9216, 1.8100, 1.6396, 1.3541, 1.1324, 0.8284, 0.6409, 0.4721, 0.2462, 0.0998}},
    {1.02, {1.9245, 1.8878, 1.8519, 1.7482, 1.5894, 1.3214, 1.1111, 0.8189, 0.6362, 0.4702, 0.2459, 0.0997}},
    {k_beta, {1.8665, 1.8320, 1.7981, 1.7004, 1.5504, 1.2956, 1.0941, 0.8111, 0.6323, 0.4685, 0.2457, 0.0997}}};

TEST(ChungLee, StableStepIsTheTableOfStabilityLimits) {
  for (const StabilityRow& row : k_stability) {
    for (std::size_t i = 0; i < k_damping.size(); ++i) {
      EXPECT_NEAR(stable_step(row.beta, 1.0, 2.0 * k_damping[i]), row.limit[i], 6e-5)  // four digits
          << "beta " << row.beta << " damping " << k_damping[i];
    }
  }
  EXPECT_DOUBLE_EQ(stable_step(k_beta, 0.0, 4.0), 0.25);  // a damper alone: c h / m = 1
}

TEST(ChungLee, AnOscillatorGrowsJustAboveTheLimitAndStaysBoundedBelowIt) {
  for (const StabilityRow& row : k_stability) {
    for (const double damping : k_damping) {
      const double limit = stable_step(row.beta, 1.0, 2.0 * damping);
      for (const double part : {0.999, 1.001}) {
        ScalarRun run(row.beta, oscillator_force(damping), 1.0, 0.0);
        for (int i = 0; i < 40000 && std::abs(run.u) < 1e9; ++i) run.step(part * limit);
        // 40000 steps of a root 1e-3 off the unit circle: e^40; below it the non-normal growth is under 100.
        EXPECT_EQ(std::abs(run.u) < 1e3, part < 1.0) << "beta " << row.beta << " damping " << damping;
      }
    }
  }
}

struct Vector {
  double beta, damping;
  int steps;
  double u, v;
};

TEST(ChungLee, FollowsTheExactTrajectoriesToRoundOff) {
  // omega = 1, u0 = 1, v0 = 0, h = 0.1, computed in rational arithmetic.
  for (const Vector& known :
       {Vector{1.0, 0.0, 1, 0.995, -0.1}, Vector{1.0, 0.0, 2, 0.98005, -0.19925},
        Vector{1.0, 0.0, 3, 0.9552995, -0.2965075}, Vector{1.0, 0.0, 6, 0.8251942694005, -0.5667569329925},
        Vector{k_beta, 0.0, 3, 0.9553068696844993, -0.2965077777777778},
        Vector{k_beta, 0.0, 6, 0.8252387226519330, -0.5667638324654404},
        Vector{k_beta, 0.05, 2, 0.9801555555555556, -0.19775},
        Vector{k_beta, 0.05, 6, 0.8286051452707935, -0.5504229437967891},
        Vector{1.0, 0.05, 6, 0.8285447156835938, -0.5504119991210937},
        Vector{1.0, 0.0, 100, -0.8367949271103874, 0.5493565735841008},
        Vector{k_beta, 0.0, 100, -0.8376398067685461, 0.5478062356354678},
        Vector{1.0, 0.0, 1000, 0.8826849673165413, 0.4719448904978930},
        Vector{k_beta, 0.0, 1000, 0.8722622521941948, 0.4873899628592685}}) {
    ScalarRun run(known.beta, oscillator_force(known.damping), 1.0, 0.0);
    for (int i = 0; i < known.steps; ++i) run.step(0.1);
    const double round_off = 2e-15 * known.steps;
    EXPECT_NEAR(run.u, known.u, round_off) << known.steps << " steps, beta " << known.beta;
    EXPECT_NEAR(run.v, known.v, round_off) << known.steps << " steps, beta " << known.beta;
  }
}

TEST(ChungLee, FollowsTheExactTrajectoryOfVariableSteps) {
  ScalarRun run(k_beta, oscillator_force(0.0), 1.0, 0.0);
  const std::array<double, 6> steps{0.1, 0.1, 0.05, 0.05, 0.1, 0.2};
  const std::vector<Vector> known{{k_beta, 0.0, 3, 0.9688743216735254, -0.2480657407407408},
                                  {k_beta, 0.0, 5, 0.9210216393439838, -0.3903975761233298},
                                  {k_beta, 0.0, 6, 0.8259933149895188, -0.5677512421401999}};
  int done = 0;
  for (const Vector& at : known) {
    for (; done < at.steps; ++done) run.step(steps[static_cast<std::size_t>(done)]);
    EXPECT_NEAR(run.u, at.u, 1e-14) << "step " << done;
    EXPECT_NEAR(run.v, at.v, 1e-14) << "step " << done;
  }
}

TEST(ChungLee, AlternatingStepsKeepTheSecondOrder) {
  const Oscillator exact{2.0 * k_pi, 0.05, 3.0, 1.7 * k_pi, 1.0, 0.5};
  const auto error = [&](int pairs) {
    ScalarRun run(
        k_beta, [&](double t, double u, double v) { return exact.acceleration(t, u, v); }, 1.0, 0.5);
    for (int i = 0; i < pairs; ++i) {
      run.step(4.0 / pairs / 3.0);
      run.step(4.0 / pairs * 2.0 / 3.0);
    }
    return std::abs(run.u - exact.at(4.0).u);
  };
  // The form with constant coefficients is of first order here: its ratio would be 2.
  EXPECT_NEAR(error(1600) / error(3200), 4.0, 0.1);
}

TEST(ChungLee, EmbeddedEstimatesTendToTheTrueLocalError) {
  const Oscillator exact{2.0 * k_pi, 0.05, 3.0, 1.7 * k_pi, 1.0, 0.5};
  constexpr double t0 = 0.37;  // s, where neither f' nor f'' is near zero
  struct Ratio {
    double velocity, position;
  };
  const auto ratio = [&](double h, double r) {
    const auto force = [&](double t) {
      const auto [u, v] = exact.at(t);
      return exact.acceleration(t, u, v);
    };
    const auto [u, v] = exact.at(t0);
    const double before = force(t0 - h / r), now = force(t0);
    const StepWeights w = step_weights(k_beta, h, h / r);
    const double next_u = u + h * v + w.position_now * now + w.position_before * before;
    const double next_v = v + w.velocity_now * now + w.velocity_before * before;
    const double next = exact.acceleration(t0 + h, next_u, next_v);
    const ErrorWeights e = error_weights(k_beta, h, h / r);
    const auto end = exact.at(t0 + h);
    return Ratio{
        e.velocity * std::abs(next - now - e.ratio * (now - before)) / std::abs(end.v - next_v),
        e.position * std::max(e.ratio * std::abs(now - before), std::abs(next - now)) / std::abs(end.u - next_u)};
  };
  for (const double r : {0.5, 1.0, 1.25, 2.0}) {
    const Ratio coarse = ratio(0.0025, r), fine = ratio(0.00125, r);
    EXPECT_NEAR(coarse.velocity, 1.0, 0.03) << "r " << r;  // linear in h, measured 0.3 to 2 %
    EXPECT_NEAR(coarse.position, 1.0, 0.03) << "r " << r;
    EXPECT_LT(std::abs(fine.velocity - 1.0), 0.6 * std::abs(coarse.velocity - 1.0) + 1e-4) << "r " << r;
    EXPECT_LT(std::abs(fine.position - 1.0), 0.6 * std::abs(coarse.position - 1.0) + 1e-4) << "r " << r;
  }
}

TEST(ChungLee, TurnsATorqueFreeTopAtSecondOrder) {
  const Vector3d inertia(1.0, 2.0, 3.5), spin(0.4, 2.0, 0.3);
  const Quaterniond exact = reference_top(inertia, spin, 5.0).orientation;
  struct Row {
    int steps;
    double error;
  };
  for (const Row& row : {Row{250, 3.68e-4}, Row{500, 9.08e-5}, Row{1000, 2.26e-5}, Row{2000, 5.62e-6}}) {
    const Quaterniond q = spin_top(inertia, spin, 5.0, row.steps).orientation;
    EXPECT_NEAR(quaternion_distance(q, exact) / row.error, 1.0, 0.02) << row.steps << " steps";
    EXPECT_NEAR(q.norm(), 1.0, 1e-14);
  }
}

TEST(ChungLee, KeepsTheClosedFormOfEulersTop) {
  const TopReference top = euler_top();
  const auto error = [&](int steps) {
    const TopReference::At& last = top.known.back();  // 10 s
    return (spin_top(top.inertia, top.spin, last.time, steps).angular_velocity - last.angular_velocity).norm();
  };
  const double coarse = error(2000), fine = error(4000);
  EXPECT_LT(fine, 3e-5);                 // 10 s at steps of 2.5 ms, measured 1.9e-5
  EXPECT_NEAR(coarse / fine, 4.0, 0.1);  // second order
}

TEST(ChungLee, TumblesAboutTheMiddleAxisAsKnown) {
  const TopReference top = tumbling_top();
  for (const TopReference::At& known : top.known) {
    const Vector3d found = reference_top(top.inertia, top.spin, known.time).angular_velocity;
    EXPECT_LT((found - known.angular_velocity).norm(), 1e-6) << known.time << " s";
  }
  const TopReference::At& last = top.known[3];  // 4 s, after the first turn-over
  const auto error = [&](int steps) {
    return (spin_top(top.inertia, top.spin, last.time, steps).angular_velocity - last.angular_velocity).norm();
  };
  EXPECT_NEAR(error(8000) / error(16000), 4.0, 0.1);
}

TEST(ChungLee, AFreeBodyUnderGravityFallsExactly) {
  Scenario scenario = parked(bare_vehicle(8), no_bushing(), 9.81);
  scenario.integrator.fixed_step = 1e-3;
  const System system = compile(scenario);
  Stepper stepper(system, strewn_state(system), {});
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(stepper.step(1e9), StepStatus::ok);
  // A constant acceleration is integrated without error; round-off of 1000 steps at a height of 1000 m.
  EXPECT_NEAR(get_link(stepper.state(), 3).position.z(), 1000.0 - 0.5 * 9.81, 1e-9);
  EXPECT_NEAR(stepper.state().chassis.position.z(), system.chassis_center_V.z() - 0.5 * 9.81, 1e-11);
}

}  // namespace
}  // namespace grouser::test
