#include <cmath>

#include "model/fit.h"
#include "model/geometry.h"
#include "tests/support/mock_inputs.h"

namespace grouser::mock {
namespace {

CycleFit cycle(int index, bool used, const TestFit& test) {
  CycleFit cycle;
  cycle.index = index;
  cycle.used = used;
  cycle.note = used ? "" : "conditioning";
  cycle.amplitude = test.amplitude;
  cycle.measured = test.measured;
  cycle.fitted = test.fitted;
  cycle.nrmse = used ? test.nrmse : 0.0;
  return cycle;
}

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
  test.measured = {k, k_pi * k * loss * amplitude * amplitude, 1e3, loss, 0.98 * k, 1.02 * k, 1.02 * k * loss};
  test.fitted = {1.01 * k,       0.98 * test.measured.dissipated_energy, 1e3, 0.98 * loss, 0.99 * k, 1.03 * k,
                 1.01 * k * loss};
  test.nrmse = 0.012;
  test.r_squared = 0.9987;
  test.gain = 0.004 * std::log10(frequency) + 0.001;
  test.weight = 0.93;
  test.force_zero = 3e-4 * stiffness * amplitude;
  test.force_drift = 1e-4 * stiffness * amplitude;
  test.left_out_nrmse = 0.019;
  for (int i = 0; i <= 200; ++i) {
    const double phase = 2.0 * k_pi * i / 100.0, x = amplitude * std::sin(phase);
    test.curve.displacement.push_back(x);
    test.curve.fitted.push_back(k * (x + loss * amplitude * std::cos(phase)));
    test.curve.force.push_back(test.curve.fitted.back() + 0.02 * k * amplitude * std::sin(17.0 * phase));
  }
  for (int index = 1; index <= 3; ++index) test.per_cycle.push_back(cycle(index, index > 1, test));
  return test;
}

std::vector<ResponsePoint> responses(const std::vector<TestFit>& tests, Axis axis) {
  const auto around = [](double value, double share) {
    return Interval{value, (1.0 - share) * value, (1.0 + share) * value};
  };
  std::vector<ResponsePoint> cells;
  for (const TestFit& test : tests)
    if (test.axis == axis)
      cells.push_back({test.amplitude, test.frequency, around(test.fitted.dissipated_energy, 0.012),
                       around(test.fitted.storage_stiffness, 0.006), around(test.fitted.loss_stiffness, 0.014),
                       around(test.fitted.loss_factor, 0.013)});
  return cells;
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
  fit.solver = {"CONVERGENCE", 23, 14.2, 1.31, 2e-9, 5};
  fit.tangent_window = 0.15 * reach;
  for (int i = -20; i <= 20; ++i) {
    const double x = reach * i / 20.0, f = stiffness * x * (1.0 + 0.4 * std::pow(x / reach, 2)),
                 k = stiffness * (1.0 + 1.2 * std::pow(x / reach, 2));
    fit.backbone.push_back({x, f, f - 0.02 * stiffness * reach, f + 0.02 * stiffness * reach});
    fit.tangent.push_back({x, k, 0.97 * k, 1.03 * k});
  }
  for (int stops = 1; stops <= 3; ++stops)
    for (int branches = 1; branches <= 3; ++branches)
      fit.selection.push_back({14, stops, branches, false, 0.04 / (stops + branches), stops == 3 && branches == 2});
  fit.selection.push_back({14, 3, 2, true, 0.0079, false});
  fit.draws = 60;
  return fit;
}

}  // namespace

FitRecord fit_record(const std::string& specimen) {
  FitRecord fit;
  fit.specimen = specimen;
  fit.synthetic = true;
  fit.synthetic_note = "Mock data, made up for a test, seed 1.";
  for (const double frequency : {0.1, 1.0, 10.0})
    for (const double amplitude : {1e-4, 5e-4}) fit.tests.push_back(loop(Axis::x, amplitude, frequency, 1e8));
  for (const double frequency : {0.1, 1.0}) fit.tests.push_back(loop(Axis::ry, 0.1, frequency, 1500.0));
  fit.axes = {axis_fit(Axis::x, 1e8, 1e-3), axis_fit(Axis::ry, 1500.0, 0.25)};
  for (AxisFit& axis : fit.axes) axis.responses = responses(fit.tests, axis.axis);
  fit.axes[0].clearance = Clearance{-5e-5, 6e-5, 0.08};
  fit.axes[1].hard_stops = {{0.2, 7.5}};
  fit.axes[1].preset = 0.12;
  fit.warnings = {{"drift", fit.tests[0].name, "The force drifts by 0.4 kN over the test."},
                  {"backlash", fit.tests[1].name, "Play of 0.02 mm near zero force."},
                  {"drift", fit.tests[2].name, "The force drifts by 0.5 kN over the test."}};
  fit.corrections = {{"rig_compliance", "", "The rig yields 0.4 mm/MN; taken out of 7 tests."},
                     {"remove_backlash", fit.tests[1].name, "Play of 0.02 mm taken out."}};
  fit.calibration_residual = 0.0012;
  fit.provenance.version = "0.1.0";
  fit.provenance.command = "grouser identify rig.json -o mock";
  fit.provenance.inputs = {{"rig", "rig.json", std::string(64, 'c')}};
  return fit;
}

void write_fit_folder(const std::filesystem::path& folder, const std::string& specimen) {
  std::filesystem::create_directories(folder);
  write_fit(fit_record(specimen), folder / "fit.json");
  write_bushing(straight_bushing(), folder / "bushing.json");
}

}  // namespace grouser::mock
