#include <cmath>

#include "model/fit.h"
#include "model/geometry.h"
#include "tests/support/mock_inputs.h"

namespace grouser::mock {
namespace {

TestFit loop(Axis axis, double amplitude, double frequency, double stiffness) {
  TestFit test;
  test.name = std::string("loop_") + name_of(axis) + "_" + std::to_string(static_cast<int>(1e6 * amplitude)) + "_" +
              std::to_string(static_cast<int>(10 * frequency));
  test.axis = axis;
  test.samples = 2000;
  test.cycles = 10;
  test.cycles_used = 6;
  test.frequency = frequency;
  test.amplitude = amplitude;
  const double loss = 0.08 + 0.01 * std::log10(frequency);
  const double k = stiffness * (1.0 + 0.08 * std::log10(frequency)) * std::pow(amplitude / 1e-4, -0.05);
  test.measured = {k, k_pi * k * loss * amplitude * amplitude, 1e3, loss};
  test.fitted = {1.01 * k, 0.98 * test.measured.dissipated_energy, 1e3, 0.98 * loss};
  test.nrmse = 0.012;
  test.r_squared = 0.9987;
  for (int i = 0; i <= 200; ++i) {
    const double phase = 2.0 * k_pi * i / 100.0, x = amplitude * std::sin(phase);
    test.curve.displacement.push_back(x);
    test.curve.fitted.push_back(k * (x + loss * amplitude * std::cos(phase)));
    test.curve.force.push_back(test.curve.fitted.back() + 0.02 * k * amplitude * std::sin(17.0 * phase));
  }
  CycleFit cycle;
  cycle.index = 1;
  cycle.note = "conditioning";
  test.per_cycle.push_back(cycle);
  return test;
}

AxisFit axis_fit(Axis axis, double stiffness, double reach) {
  AxisFit fit;
  fit.axis = axis;
  fit.parameters = {{"stop[0].stiffness", is_rotation(axis) ? "N m/rad" : "N/m", 0.1 * stiffness, 0.01 * stiffness,
                     0.08 * stiffness, 0.12 * stiffness, true},
                    {"maxwell[0].relaxation_time", "s", 0.02, 0.004, 0.012, 0.028, false}};
  fit.covariance = {{1e-4, 0.0}, {0.0, 1e-6}};
  fit.condition_number = 3.2e4;
  fit.not_identified = {"The split between the spline and the largest stop is not determined by these tests."};
  fit.solver = {"CONVERGENCE", 23, 14.2, 1.31, 2e-9};
  fit.tangent_window = 0.15 * reach;
  for (int i = -20; i <= 20; ++i) {
    const double x = reach * i / 20.0, f = stiffness * x * (1.0 + 0.4 * std::pow(x / reach, 2)),
                 k = stiffness * (1.0 + 1.2 * std::pow(x / reach, 2));
    fit.backbone.push_back({x, f, f - 0.02 * stiffness * reach, f + 0.02 * stiffness * reach});
    fit.tangent.push_back({x, k, 0.97 * k, 1.03 * k});
  }
  return fit;
}

}  // namespace

void write_fit_folder(const std::filesystem::path& folder, const std::string& specimen) {
  FitRecord fit;
  fit.specimen = specimen;
  fit.synthetic = true;
  fit.synthetic_note = "Mock data, made up for a test, seed 1.";
  for (const double frequency : {0.1, 1.0, 10.0})
    for (const double amplitude : {1e-4, 5e-4}) fit.tests.push_back(loop(Axis::x, amplitude, frequency, 1e8));
  for (const double frequency : {0.1, 1.0}) fit.tests.push_back(loop(Axis::ry, 0.1, frequency, 1500.0));
  fit.axes = {axis_fit(Axis::x, 1e8, 1e-3), axis_fit(Axis::ry, 1500.0, 0.25)};
  fit.warnings = {{"drift", fit.tests[0].name, "The force drifts by 0.4 kN over the test."}};
  fit.calibration_residual = 0.0012;
  fit.provenance.version = "0.1.0";
  fit.provenance.command = "grouser identify rig.json -o mock";
  fit.provenance.inputs = {{"rig", "rig.json", std::string(64, 'c')}};
  std::filesystem::create_directories(folder);
  write_fit(fit, folder / "fit.json");
  write_bushing(straight_bushing(), folder / "bushing.json");
}

}  // namespace grouser::mock
