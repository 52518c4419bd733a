#include "identification/identify.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>
#include <thread>

#include "identification/axis_fit.h"
#include "identification/corrections.h"
#include "identification/cycle_findings.h"
#include "identification/draws.h"
#include "identification/evaluate_fit.h"
#include "identification/joint_limits.h"
#include "identification/prepared_test.h"
#include "identification/robust_weights.h"
#include "identification/uncertainty.h"
#include "model/errors.h"

namespace grouser {
namespace {

struct AxisResult {
  AxisLaw law;
  std::vector<AxisLaw> draws;
  AxisFit fit;
  std::map<const PreparedTest*, double> left_out_nrmse, weights;  // where they are known
};

std::vector<const PreparedTest*> usable_tests(const std::vector<PreparedTest>& tests, Axis axis) {
  std::vector<const PreparedTest*> result;
  for (const PreparedTest& test : tests) {
    if (test.source->axis == axis && test.unusable.empty() && test.cycles_used() > 0) result.push_back(&test);
  }
  return result;
}

double largest_rate(const PreparedTest& test) {
  double rate = 0.0;
  for (const Cycle& cycle : test.cycles) {
    for (std::size_t i = cycle.span.begin + 1; cycle.used && i <= cycle.span.end; ++i) {
      const double dx = test.displacement[i] - test.displacement[i - 1], h = test.time[i] - test.time[i - 1];
      rate = std::max(rate, std::abs(dx / h));
    }
  }
  return rate;
}

ValidRange valid_range(const AxisData& data, const std::vector<const PreparedTest*>& tests) {
  ValidRange valid;
  valid.amplitude = std::max(std::abs(data.low), std::abs(data.high));
  valid.frequency_low = data.lowest_frequency;
  valid.frequency_high = data.highest_frequency;
  for (const PreparedTest* test : tests) {
    if (test->rate_known) valid.rate = std::max(valid.rate, largest_rate(*test));
  }
  return valid;
}

// Of a test whose blocks were left out together; with a single test its blocks were left out one by one.
void note_tests(const AxisData& data, const AxisSolution& solution, AxisResult& result) {
  const std::vector<std::vector<std::size_t>> groups = replicates(data);
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const DataBlock& block = data.blocks[groups[i].front()];
    result.weights[block.test] = block.robust_weight;
    if (i < solution.left_out_nrmse.size()) {
      double& worst = result.left_out_nrmse[block.test];
      worst = std::max(worst, solution.left_out_nrmse[i]);
    }
  }
}

// What the data of these tests show, for whoever reads that their fit failed.
std::string evidence(const std::vector<const PreparedTest*>& tests, const std::vector<FitWarning>& warnings) {
  std::string text;
  for (const FitWarning& warning : warnings) {
    const auto is_it = [&](const PreparedTest* test) { return test->source->name == warning.test; };
    if (std::ranges::any_of(tests, is_it))
      text += fmt::format("; {} ({}): {}", warning.code, warning.test, warning.text);
  }
  return text;
}

AxisResult identify_axis(Axis axis, const std::vector<const PreparedTest*>& tests,
                         const std::vector<FitWarning>& warnings) {
  AxisData data = gather(tests);
  weigh_tests(data);
  AxisResult result;
  result.fit.axis = axis;
  try {
    const AxisSolution solution = fit_axis(data);
    result.law = make_law(solution.dictionary, solution.coefficients);
    result.law.valid = valid_range(data, tests);
    result.fit.solver = solution.summary;
    result.fit.selection = solution.selection;
    note_tests(data, solution, result);
    result.draws = estimate_uncertainty(data, solution, result.law, result.fit);
    find_joint_limits(result.fit);
  } catch (const NumericalError& error) {
    throw NumericalError(fmt::format("axis {}: {}{}", name_of(axis), error.what(), evidence(tests, warnings)));
  }
  return result;
}

void report_progress(const Progress& progress, double fraction, const std::string& what) {
  if (progress && !progress({fraction, what})) throw Interrupted("before: " + what);
}

using AxisResults = std::array<std::optional<AxisResult>, k_num_axes>;

// Axes are independent; each result has its own place, so the number of threads changes nothing.
AxisResults identify_axes(const std::vector<PreparedTest>& tests, const std::vector<FitWarning>& warnings, int threads,
                          const Progress& progress) {
  AxisResults results;
  std::array<std::exception_ptr, k_num_axes> errors;
  std::atomic<int> next{0};
  const auto work = [&](bool reports) {
    for (int a = next++; a < k_num_axes; a = next++) {
      const auto at = static_cast<std::size_t>(a);
      try {
        const auto usable = usable_tests(tests, static_cast<Axis>(a));
        if (reports)
          report_progress(progress, (1.0 + a) / (2.0 + k_num_axes), fmt::format("fitting axis {}", k_axis_names[at]));
        if (!usable.empty()) results[at] = identify_axis(static_cast<Axis>(a), usable, warnings);
      } catch (...) {
        errors[at] = std::current_exception();
        next = k_num_axes;
      }
    }
  };
  {
    std::vector<std::jthread> helpers;
    try {
      for (int i = 1; i < std::min(threads, k_num_axes); ++i) helpers.emplace_back(work, false);
    } catch (const std::system_error&) {  // the system gives no more threads; those that there are do the same work
    }
    work(true);
  }
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
  return results;
}

void require_usable_data(const RigRecord& rig, const std::vector<PreparedTest>& tests,
                         const std::vector<FitWarning>& warnings) {
  std::vector<InputFinding> findings;
  for (const PreparedTest& test : tests) {
    if (test.unusable.empty()) return;
    findings.push_back({rig.path.string(), fmt::format("/tests/{}", test.source - rig.tests.data()),
                        "a test that closes cycles of force over displacement", test.unusable,
                        "test " + test.source->name + evidence({&test}, warnings)});
  }
  if (findings.empty()) {
    findings.push_back({rig.path.string(), "/tests", "at least one test with a measurement", "none",
                        rig.tests.empty() ? "" : "a protocol is for grouser rig to drive"});
  }
  throw InputError(findings);
}

void warn_of_missing_axes(const AxisResults& results, std::vector<FitWarning>& warnings) {
  std::vector<std::string_view> missing;
  for (std::size_t a = 0; a < results.size(); ++a) {
    if (!results[a]) missing.emplace_back(k_axis_names[a]);
  }
  if (missing.empty()) return;
  const bool one = missing.size() == 1;
  warnings.push_back({"axis_without_test", "",
                      fmt::format("{} {} {} no usable test and {} no law; a bushing without {} cannot be simulated",
                                  one ? "axis" : "axes", fmt::join(missing, ", "), one ? "has" : "have",
                                  one ? "gets" : "get", one ? "it" : "them")});
}

// Draw k of every axis makes bushing k: axes are tested apart, so their draws are independent.
std::vector<Bushing> whole_bushings(const Bushing& fitted, const AxisResults& axes) {
  std::vector<Bushing> draws(k_num_draws, fitted);
  for (std::size_t a = 0; a < axes.size(); ++a) {
    for (std::size_t k = 0; axes[a] && k < draws.size(); ++k) draws[k].axes[a] = axes[a]->draws[k];
  }
  for (std::size_t k = 0; k < draws.size(); ++k) {
    draws[k].name = fmt::format("{}, draw {} of {}", fitted.name, k + 1, draws.size());
  }
  return draws;
}

double worst_calibration(const RigRecord& rig) {
  double worst = rig.force_sensor ? calibration_residual(*rig.force_sensor) : 0.0;
  if (rig.torque_sensor) worst = std::max(worst, calibration_residual(*rig.torque_sensor));
  for (const SensorCalibration& sensor : rig.displacement_sensors)
    worst = std::max(worst, calibration_residual(sensor));
  return worst;
}

}  // namespace

IdentifyResult identify(const RigRecord& rig, const IdentifyOptions& options, const Progress& progress) {
  IdentifyResult result;
  result.fit.specimen = result.bushing.name = rig.specimen;
  result.fit.synthetic = result.bushing.synthetic = rig.synthetic;
  result.fit.synthetic_note = rig.synthetic_note;
  result.fit.provenance = result.bushing.provenance = rig.provenance;
  result.fit.calibration_residual = worst_calibration(rig);

  report_progress(progress, 0.0, "cutting cycles");
  std::vector<PreparedTest> tests;
  for (const RigTest& test : rig.tests) {
    if (test.protocol) {
      result.fit.warnings.push_back(
          {"no_measurement", test.name, "the test states a protocol to be driven and holds no measurement: left out"});
      continue;
    }
    tests.push_back(prepare_test(test, rig, result.fit.warnings, result.fit.corrections));
  }
  gather_common_findings(result.fit.warnings);
  for (AppliedCorrection& one : campaign_corrections(tests, rig)) result.fit.corrections.push_back(std::move(one));
  require_usable_data(rig, tests, result.fit.warnings);

  const AxisResults axes = identify_axes(tests, result.fit.warnings, options.threads, progress);
  warn_of_missing_axes(axes, result.fit.warnings);
  for (std::size_t a = 0; a < axes.size(); ++a) {
    if (!axes[a]) continue;
    result.bushing.axes[a] = axes[a]->law;
    result.fit.axes.push_back(axes[a]->fit);
  }
  result.draws = whole_bushings(result.bushing, axes);
  report_progress(progress, (1.0 + k_num_axes) / (2.0 + k_num_axes), "comparing fit and measurement");
  for (const PreparedTest& test : tests) {
    const auto& axis = axes[static_cast<std::size_t>(index_of(test.source->axis))];
    const bool fitted = axis && test.unusable.empty();
    result.fit.tests.push_back(
        evaluate_fit(test, fitted ? replay(axis->law, test.time, test.displacement) : std::vector<double>{}));
    if (!fitted || !axis->weights.contains(&test)) continue;
    result.fit.tests.back().weight = axis->weights.at(&test);
    if (axis->left_out_nrmse.contains(&test)) result.fit.tests.back().left_out_nrmse = axis->left_out_nrmse.at(&test);
  }
  return result;
}

}  // namespace grouser
