#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/figure_block.h"
#include "reports/fit_checks.h"
#include "reports/fit_figures.h"
#include "reports/loop_points.h"
#include "reports/number_text.h"
#include "reports/pages.h"
#include "reports/test_blocks.h"

namespace grouser {
namespace {

using nlohmann::json;

std::vector<const TestFit*> compared_tests(const ReplayRecord& replay) {
  std::vector<const TestFit*> tests;
  for (const TestFit& test : replay.tests)
    if (!left_out(test) && !test.prediction) tests.push_back(&test);
  return tests;
}

struct LargestErrors {
  double nrmse = 0.0, energy = 0.0, stiffness = 0.0;
};

LargestErrors largest_errors(const ReplayRecord& replay) {
  const std::vector<const TestFit*> tests = compared_tests(replay);
  LargestErrors found;
  for (const TestFit* test : tests) found.nrmse = std::fmax(found.nrmse, test->nrmse);
  for (const LoopPoint& loop : loop_points(tests)) {
    const LoopMeasures &m = loop.measured, &f = loop.fitted;
    found.energy = std::fmax(found.energy, std::abs(relative_error(f.dissipated_energy, m.dissipated_energy)));
    found.stiffness = std::fmax(found.stiffness, std::abs(relative_error(stiffness_of(f), stiffness_of(m))));
  }
  return found;
}

/// The limits of an identification, for the same law in another program part must meet them too.
json check_facts(const ReplayRecord& replay) {
  if (compared_tests(replay).empty()) return json::array();
  const LargestErrors errors = largest_errors(replay);
  const auto check = [](const char* label, double value, double limit) {
    return json{{"label", label},
                {"value", value},
                {"unit", "1"},
                {"text", percent_text(value, 2)},
                {"limit", "≤ " + percent_text(limit, 2)},
                {"pass", value <= limit}};
  };
  return json::array({check("Largest error of a test (nrmse)", errors.nrmse, k_fit_limits.nrmse),
                      check("Largest error of a loop’s energy", errors.energy, k_fit_limits.energy_error),
                      check("Largest error of a loop’s stiffness", errors.stiffness, k_fit_limits.stiffness_error)});
}

std::vector<Axis> tested_axes(const ReplayRecord& replay) {
  std::vector<Axis> axes;
  for (int a = 0; a < k_num_axes; ++a)
    if (std::ranges::find(replay.tests, static_cast<Axis>(a), &TestFit::axis) != replay.tests.end())
      axes.push_back(static_cast<Axis>(a));
  return axes;
}

json axis_facts(const ReplayRecord& replay, Axis axis, const std::string& id) {
  const std::string key = id + "-axis-" + name_of(axis);
  json facts = tests_facts({.axis = axis,
                            .tests = tests_of(replay.tests, axis),
                            .law = "virtual rig",
                            .joint_fit = false,
                            .warnings = replay.warnings},
                           key);
  facts["key"] = key;
  facts["axis_title"] = axis_title(axis);
  return facts;
}

}  // namespace

json rig_verdict(const ReplayRecord& replay) {
  const json checks = check_facts(replay);
  const auto failed = std::ranges::count_if(checks, [](const json& check) { return !check["pass"].get<bool>(); });
  const auto total = static_cast<long>(replay.tests.size());
  const auto compared = static_cast<long>(compared_tests(replay).size());
  std::string text = compared == 0 ? "A prediction: no test holds a measurement to compare with"
                     : failed == 0 ? "The simulator’s bushing meets every limit on the measured tests"
                                   : fmt::format("{} of {} limits are not met", failed, checks.size());
  const bool partial = compared < total;
  if (partial && compared > 0) text += fmt::format("; {} of {} tests compared", compared, total);
  if (!replay.warnings.empty())
    text += fmt::format("; {} {}", replay.warnings.size(), replay.warnings.size() == 1 ? "warning" : "warnings");
  return {{"pass", failed == 0 && !partial}, {"partial", failed == 0 && partial}, {"text", text}};
}

json rig_headline(const ReplayRecord& replay) {
  const LargestErrors errors = largest_errors(replay);
  const auto tests = static_cast<long>(replay.tests.size()), axes = static_cast<long>(tested_axes(replay).size());
  const auto tile = [](const char* label, double value) {
    return json{{"label", label}, {"value", value}, {"text", percent_text(value, 2)}};
  };
  json headline = json::array({{{"label", "axes driven"}, {"value", axes}, {"text", count_text(axes)}},
                               {{"label", "tests"}, {"value", tests}, {"text", count_text(tests)}}});
  if (compared_tests(replay).empty()) return headline;
  headline.push_back(tile("largest error of a test (nrmse)", errors.nrmse));
  headline.push_back(tile("largest error of a loop’s energy", errors.energy));
  return headline;
}

json rig_facts(const RigFolder& folder, const std::string& id, int level) {
  const ReplayRecord& replay = folder.replay;
  json facts{{"id", id}, {"kind", "rig"}, {"level", level}, {"sublevel", level + 1}, {"figure_level", level + 2}};
  facts["title"] = "Virtual rig: " + replay.bushing;
  facts["subtitle"] = fmt::format("The simulator’s bushing element on the tests of {}", replay.specimen);
  facts["checks"] = check_facts(replay);
  facts["has_checks"] = !facts["checks"].empty();
  facts["verdict"] = rig_verdict(replay);
  facts["headline"] = rig_headline(replay);
  facts["tile_columns"] = tile_columns(facts["headline"].size());
  facts["synthetic"] = replay.provenance.synthetic;
  facts["is_synthetic"] = !replay.provenance.synthetic.empty();
  facts["warnings"] = warning_facts(replay.warnings);
  facts["has_warnings"] = !replay.warnings.empty();
  facts["corrections"] = correction_facts(replay.corrections);
  facts["has_corrections"] = !replay.corrections.empty();
  facts["axes"] = json::array();
  for (const Axis axis : tested_axes(replay)) facts["axes"].push_back(axis_facts(replay, axis, id));
  const std::string name = folder.path.filename().string();
  facts["provenance"] =
      provenance_facts(replay.provenance, {replay.provenance.command, fmt::format("grouser identify {}/rig.json", name),
                                           fmt::format("grouser report {} -o {}/report.html", name, name)});
  return facts;
}

}  // namespace grouser
