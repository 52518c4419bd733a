#include "reports/test_blocks.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "reports/figure_block.h"
#include "reports/fit_checks.h"
#include "reports/fit_figures.h"
#include "reports/loop_points.h"
#include "reports/number_text.h"
#include "reports/pages.h"

namespace grouser {
namespace {

using nlohmann::json;

constexpr std::size_t k_shown_cycles = 40;  // of one test: a settled loop repeats itself

json absent() { return {{"value", nullptr}, {"text", "–"}}; }

/// A value in SI whose text is in the unit of its column.
json scaled(double si, double scale) { return {{"value", si}, {"text", number_text(si * scale, 3)}}; }

json percent(double fraction, int digits = 2) {
  return {{"value", fraction}, {"text", percent_text(fraction, digits)}};
}

json signed_percent(double fraction) { return {{"value", fraction}, {"text", signed_percent_text(fraction)}}; }

json error_facts(double computed, double measured) {
  return measured != 0.0 ? signed_percent(relative_error(computed, measured)) : absent();
}

/// "left out: reversed polarity", by the notes on its cycles, else by the warnings about the test.
std::string left_out_text(const TestFit& test, const std::vector<FitWarning>& warnings) {
  std::vector<std::string> reasons;
  const auto add = [&reasons](std::string reason) {
    std::ranges::replace(reason, '_', ' ');
    if (!reason.empty() && std::ranges::find(reasons, reason) == reasons.end()) reasons.push_back(std::move(reason));
  };
  for (const CycleFit& cycle : test.per_cycle) add(cycle.note);
  if (reasons.empty())
    for (const FitWarning& warning : warnings)
      if (warning.test == test.name) add(warning.code);
  return reasons.empty() ? "left out" : fmt::format("left out: {}", fmt::join(reasons, ", "));
}

json row_facts(const TestFit& test, const TestSet& set) {
  const AxisUnits units = units_of(test.axis);
  const LoopMeasures &m = test.measured, &f = test.fitted;
  const bool cyclic = test.kind == TestKind::cyclic, used = !left_out(test);
  const auto if_used = [used](json facts) { return used ? std::move(facts) : absent(); };
  const auto if_measured = [&](json facts) { return used && !test.prediction ? std::move(facts) : absent(); };
  const auto joint = [&](bool known, json facts) {
    return used && set.joint_fit && known ? std::move(facts) : absent();
  };
  return {
      {"name", test.name},
      {"kind", cyclic ? "cyclic" : "static"},
      {"cycles", used ? fmt::format("{} of {}", test.cycles_used, test.cycles) : left_out_text(test, set.warnings)},
      {"left_out", !used},
      {"samples", {{"value", test.samples}, {"text", count_text(test.samples)}}},
      {"frequency", cyclic && test.frequency > 0.0 ? scaled(test.frequency, 1.0) : absent()},
      {"amplitude", if_used(scaled(test.amplitude, units.displacement_scale))},
      {"nrmse", if_measured(percent(test.nrmse))},
      {"r_squared", if_measured({{"value", test.r_squared}, {"text", number_text(test.r_squared, 5)}})},
      {"stiffness", if_measured(scaled(stiffness_of(m), units.stiffness_scale))},
      {"stiffness_fit", if_used(scaled(stiffness_of(f), units.stiffness_scale))},
      {"stiffness_error", if_measured(error_facts(stiffness_of(f), stiffness_of(m)))},
      {"secant", if_measured(m.secant_stiffness > 0.0 ? scaled(m.secant_stiffness, units.stiffness_scale) : absent())},
      {"energy", if_measured(scaled(m.dissipated_energy, 1.0))},
      {"energy_fit", if_used(scaled(f.dissipated_energy, 1.0))},
      {"energy_error", if_measured(error_facts(f.dissipated_energy, m.dissipated_energy))},
      {"loss_factor", if_measured(scaled(loss_factor_of(m), 1.0))},
      {"loss_factor_fit", if_used(scaled(loss_factor_of(f), 1.0))},
      {"weight", joint(true, scaled(test.weight, 1.0))},
      {"gain", joint(true, signed_percent(test.gain))},
      {"left_out_nrmse", joint(test.left_out_nrmse > 0.0, percent(test.left_out_nrmse))},
      {"force_zero", joint(true, scaled(test.force_zero, units.force_scale))},
      {"force_drift", joint(true, scaled(test.force_drift, units.force_scale))}};
}

/// What a reader asks of a loop before looking at the table.
std::string tile_note(const TestFit& test) {
  if (left_out(test)) return "left out of the fit";
  if (test.prediction) return "prediction, not measured";
  std::string note = "nrmse " + percent_text(test.nrmse, 2);
  if (test.measured.dissipated_energy > 0.0)
    note += ", energy " +
            error_facts(test.fitted.dissipated_energy, test.measured.dissipated_energy)["text"].get<std::string>();
  return note;
}

/// The gallery as a figure block with a note under each loop; false where there is nothing to show.
json gallery(const std::optional<Figure>& figure, const TestSet& set, const std::string& id, bool notes) {
  if (!figure) return false;
  json block = figure_block(*figure, id + "-" + figure->name);
  if (notes) {
    std::size_t tile = 0;
    for (const TestFit* test : set.tests)
      if (!test->curve.displacement.empty()) block["tiles"][tile++]["note"] = tile_note(*test);
  }
  return block;
}

json cycle_facts(const TestFit& test, const CycleFit& cycle) {
  const AxisUnits units = units_of(test.axis);
  const LoopMeasures& m = cycle.measured;
  const auto known = [](double value, double scale) { return value != 0.0 ? scaled(value, scale) : absent(); };
  return {{"test", test.name},
          {"index", {{"value", cycle.index}, {"text", count_text(cycle.index)}}},
          {"used", cycle.used},
          {"note", cycle.used           ? "used"
                   : cycle.note.empty() ? "not used"
                                        : cycle.note},
          {"amplitude", known(cycle.amplitude, units.displacement_scale)},
          {"stiffness", known(m.effective_stiffness, units.stiffness_scale)},
          {"secant", known(m.secant_stiffness, units.stiffness_scale)},
          {"energy", known(m.dissipated_energy, 1.0)},
          {"loss_factor", known(m.loss_factor, 1.0)},
          {"nrmse", cycle.used && !test.prediction ? percent(cycle.nrmse) : absent()}};
}

/// Every cycle of every test; of a very long test its first and its last.
json cycles_facts(const TestSet& set, long& left_away) {
  json rows = json::array();
  for (const TestFit* test : set.tests) {
    const std::size_t count = test->per_cycle.size();
    for (std::size_t i = 0; i < count; ++i) {
      if (count > k_shown_cycles && i >= k_shown_cycles / 2 && i < count - k_shown_cycles / 2) {
        ++left_away;
        continue;
      }
      rows.push_back(cycle_facts(*test, test->per_cycle[i]));
    }
  }
  return rows;
}

}  // namespace

json tests_facts(const TestSet& set, const std::string& id) {
  const AxisUnits units = units_of(set.axis);
  json facts{
      {"law_name", set.law},       {"joint_fit", set.joint_fit},        {"displacement_unit", units.displacement},
      {"force_unit", units.force}, {"stiffness_unit", units.stiffness}, {"tests", json::array()}};
  facts["loops"] = gallery(figure_loops(set.tests, set.law), set, id, true);
  facts["residuals"] = gallery(figure_residuals(set.tests), set, id, false);
  for (const TestFit* test : set.tests) facts["tests"].push_back(row_facts(*test, set));
  facts["has_tests"] = !set.tests.empty();
  long left_away = 0;
  facts["cycles"] = cycles_facts(set, left_away);
  facts["has_cycles"] = !facts["cycles"].empty();
  facts["cycle_count"] = count_text(static_cast<long>(facts["cycles"].size()));
  facts["cycles_left_away"] =
      left_away > 0
          ? fmt::format("{} cycles of long tests are left away here; fit.json holds them all.", count_text(left_away))
          : std::string();
  return facts;
}

}  // namespace grouser
