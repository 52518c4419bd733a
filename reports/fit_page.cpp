#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "reports/figure_block.h"
#include "reports/fit_figures.h"
#include "reports/number_text.h"
#include "reports/pages.h"

namespace grouser {
namespace {

using nlohmann::json;

/// What a fit must reach for its bushing to be trusted in a run (I 2: a law that fits the reference rubber reaches all
/// of it).
constexpr double k_max_nrmse = 0.06, k_max_stiffness_error = 0.10, k_max_energy_error = 0.10,
                 k_max_calibration_residual = 0.01;

std::string stiffness_unit(Axis axis) { return is_rotation(axis) ? "N m/rad" : "N/m"; }

/// A test of which no cycle entered the fit: it says nothing of how well the law holds.
bool left_out(const TestFit& test) { return test.cycles_used == 0; }

long count_used(const FitRecord& fit) {
  return static_cast<long>(std::ranges::count_if(fit.tests, [](const TestFit& test) { return !left_out(test); }));
}

/// "left out: reversed polarity", by the notes on its cycles, else by the warnings about the test.
std::string left_out_text(const FitRecord& fit, const TestFit& test) {
  std::vector<std::string> reasons;
  const auto add = [&reasons](std::string reason) {
    std::ranges::replace(reason, '_', ' ');
    if (!reason.empty() && std::ranges::find(reasons, reason) == reasons.end()) reasons.push_back(std::move(reason));
  };
  for (const CycleFit& cycle : test.per_cycle) add(cycle.note);
  if (reasons.empty())
    for (const FitWarning& warning : fit.warnings)
      if (warning.test == test.name) add(warning.code);
  return reasons.empty() ? "left out" : fmt::format("left out: {}", fmt::join(reasons, ", "));
}

double relative_error(double fitted, double measured) { return measured != 0.0 ? fitted / measured - 1.0 : 0.0; }

json check(const std::string& name, double value, double limit) {
  return {{"label", name},
          {"value", value},
          {"unit", "1"},
          {"text", percent_text(value)},
          {"limit", "at most " + percent_text(limit)},
          {"pass", value <= limit}};
}

json check_facts(const FitRecord& fit) {
  double nrmse = 0.0, stiffness = 0.0, energy = 0.0;
  for (const TestFit& test : fit.tests) {
    if (left_out(test)) continue;
    nrmse = std::max(nrmse, test.nrmse);
    if (test.kind != TestKind::cyclic) continue;
    stiffness = std::max(stiffness,
                         std::abs(relative_error(test.fitted.effective_stiffness, test.measured.effective_stiffness)));
    energy = std::max(energy, std::abs(relative_error(test.fitted.dissipated_energy, test.measured.dissipated_energy)));
  }
  json checks = json::array();
  const auto converged =
      std::ranges::count_if(fit.axes, [](const AxisFit& axis) { return axis.solver.termination == "CONVERGENCE"; });
  const auto total = static_cast<long>(fit.axes.size());
  checks.push_back({{"label", "Axes whose solver converged"},
                    {"value", converged},
                    {"text", count_text(converged)},
                    {"limit", "all " + count_text(total)},
                    {"pass", converged == total}});
  checks.push_back(check("Largest residual of a test (nrmse)", nrmse, k_max_nrmse));
  checks.push_back(check("Largest error of a loop's effective stiffness", stiffness, k_max_stiffness_error));
  checks.push_back(check("Largest error of a loop's dissipated energy", energy, k_max_energy_error));
  if (fit.calibration_residual > 0.0)  // 0: the campaign has no calibration record
    checks.push_back(check("Largest residual of a sensor calibration, of full scale", fit.calibration_residual,
                           k_max_calibration_residual));
  return checks;
}

json error_facts(double fitted, double measured) {
  const double error = relative_error(fitted, measured);
  const std::string digits = fmt::format("{:.1f} %", 100.0 * std::abs(error));
  const char* sign = digits == "0.0 %" ? "" : error > 0.0 ? "+" : "\u2212";
  return {{"value", error}, {"text", fmt::format("{}{}", sign, digits)}};
}

/// The row of a test that did not enter the fit: what was recorded, why it stands apart, dashes for the rest.
json left_out_facts(const FitRecord& fit, const TestFit& test) {
  json facts{{"name", test.name},
             {"kind", test.kind == TestKind::cyclic ? "cyclic" : "static"},
             {"cycles", left_out_text(fit, test)},
             {"left_out", true},
             {"samples", {{"value", test.samples}, {"text", count_text(test.samples)}}}};
  for (const char* key : {"frequency", "amplitude", "nrmse", "stiffness", "stiffness_fit", "stiffness_error", "energy",
                          "energy_fit", "energy_error", "loss_factor", "loss_factor_fit"})
    facts[key] = {{"value", nullptr}, {"text", "–"}};
  return facts;
}

json test_facts(const TestFit& test) {
  const AxisUnits units = units_of(test.axis);
  const auto in_units = [](double si, double scale, const std::string& unit) {
    return json{{"value", si}, {"unit", unit}, {"text", number_text(si * scale, 3)}};
  };
  const LoopMeasures &m = test.measured, &f = test.fitted;
  const bool cyclic = test.kind == TestKind::cyclic;
  return {
      {"name", test.name},
      {"kind", cyclic ? "cyclic" : "static"},
      {"cycles", fmt::format("{} of {}", test.cycles_used, test.cycles)},
      {"left_out", false},
      {"samples", {{"value", test.samples}, {"text", count_text(test.samples)}}},
      {"frequency",
       {{"value", test.frequency}, {"text", cyclic && test.frequency > 0.0 ? number_text(test.frequency, 3) : "–"}}},
      {"amplitude", in_units(test.amplitude, units.displacement_scale, units.displacement)},
      {"nrmse", {{"value", test.nrmse}, {"text", percent_text(test.nrmse, 2)}}},
      {"stiffness", in_units(m.effective_stiffness, units.stiffness_scale, units.stiffness)},
      {"stiffness_fit", in_units(f.effective_stiffness, units.stiffness_scale, units.stiffness)},
      {"stiffness_error", error_facts(f.effective_stiffness, m.effective_stiffness)},
      {"energy", in_units(m.dissipated_energy, 1.0, "J")},
      {"energy_fit", in_units(f.dissipated_energy, 1.0, "J")},
      {"energy_error", error_facts(f.dissipated_energy, m.dissipated_energy)},
      {"loss_factor", in_units(m.loss_factor, 1.0, "1")},
      {"loss_factor_fit", in_units(f.loss_factor, 1.0, "1")}};
}

json parameter_facts(const FitParameter& parameter) {
  const auto text = [&](double value) {
    return json{{"value", value}, {"text", quantity_text(value, parameter.unit, 3)}};
  };
  return {{"name", parameter.name},
          {"unit", parameter.unit},
          {"estimate", text(parameter.value)},
          {"error", text(parameter.standard_error)},
          {"low", text(parameter.low)},
          {"high", text(parameter.high)},
          {"identified", parameter.identified}};
}

json solver_facts(const AxisFit& axis) {
  const SolverSummary& solver = axis.solver;
  return json::array({{{"label", "termination"}, {"text", solver.termination}},
                      {{"label", "iterations"}, {"value", solver.iterations}, {"text", count_text(solver.iterations)}},
                      labelled_quantity("initial cost", solver.initial_cost, "1", 3),
                      labelled_quantity("final cost", solver.final_cost, "1", 3),
                      labelled_quantity("optimality (KKT) residual", solver.kkt_residual, "1", 2),
                      labelled_quantity("condition number", axis.condition_number, "1", 2)});
}

/// What the law of this axis consists of and where it holds.
json law_facts(const AxisLaw& law, Axis axis) {
  const AxisUnits units = units_of(axis);
  double stops = 0.0, branches = 0.0;
  for (const FrictionStop& stop : law.stops) stops += stop.stiffness;
  for (const MaxwellBranch& branch : law.branches) branches += branch.stiffness;
  json rows = json::array({labelled_quantity(fmt::format("stiffness of {} friction stops", law.stops.size()), stops,
                                             stiffness_unit(axis), 3),
                           labelled_quantity(fmt::format("stiffness of {} Maxwell branches", law.branches.size()),
                                             branches, stiffness_unit(axis), 3)});
  if (law.valid) {
    rows.push_back(
        {{"label", "identified up to an amplitude of"},
         {"value", law.valid->amplitude},
         {"text", number_text(units.displacement_scale * law.valid->amplitude, 3) + " " + units.displacement}});
    rows.push_back({{"label", "identified at frequencies"},
                    {"value", {law.valid->frequency_low, law.valid->frequency_high}},
                    {"text", number_text(law.valid->frequency_low, 3) + " to " +
                                 number_text(law.valid->frequency_high, 3) + " Hz"}});
  }
  return rows;
}

json axis_facts(const FitFolder& folder, const AxisFit& axis, const std::string& id) {
  const FitRecord& fit = folder.fit;
  const AxisUnits units = units_of(axis.axis);
  json facts{{"key", id + "-axis-" + name_of(axis.axis)},
             {"axis_title", axis_title(axis.axis)},
             {"displacement_unit", units.displacement},
             {"stiffness_unit", units.stiffness},
             {"figures", json::array()},
             {"tests", json::array()},
             {"parameters", json::array()},
             {"not_identified", axis.not_identified},
             {"has_not_identified", !axis.not_identified.empty()},
             {"solver", solver_facts(axis)},
             {"law", law_facts(folder.bushing.axis(axis.axis), axis.axis)}};
  for (const std::optional<Figure>& figure :
       {figure_loops(fit, axis.axis), figure_backbone(axis), figure_dynamic_stiffness(fit, axis.axis)})
    if (figure) facts["figures"].push_back(figure_block(*figure, id + "-figure-" + figure->name));
  for (const TestFit& test : fit.tests)
    if (test.axis == axis.axis) facts["tests"].push_back(left_out(test) ? left_out_facts(fit, test) : test_facts(test));
  for (const FitParameter& parameter : axis.parameters) facts["parameters"].push_back(parameter_facts(parameter));
  facts["has_tests"] = !facts["tests"].empty();
  facts["has_parameters"] = !axis.parameters.empty();
  facts["parameter_count"] = count_text(static_cast<long>(axis.parameters.size()));
  return facts;
}

}  // namespace

FitFolder open_fit(const std::filesystem::path& folder) {
  return {folder, read_fit(folder / "fit.json"), read_bushing(folder / "bushing.json")};
}

json fit_headline(const FitRecord& fit) {
  long samples = 0;
  double worst = 0.0;
  for (const TestFit& test : fit.tests) {
    samples += test.samples;
    if (!left_out(test)) worst = std::max(worst, test.nrmse);
  }
  const auto count = [](const std::string& label, long value) {
    return json{{"label", label}, {"value", value}, {"text", count_text(value)}};
  };
  const long used = count_used(fit), total = static_cast<long>(fit.tests.size());
  json tests = count("tests", used);
  if (used < total) {
    tests["label"] = "tests used";
    tests["text"] = fmt::format("{} of {}", count_text(used), count_text(total));
  }
  json tiles =
      json::array({count("axes identified", static_cast<long>(fit.axes.size())), tests, count("samples", samples)});
  tiles.push_back(
      {{"label", "largest residual of a test (nrmse)"}, {"value", worst}, {"text", percent_text(worst, 2)}});
  for (const AxisFit& axis : fit.axes)
    if (axis.axis == Axis::x && !axis.tangent.empty()) {
      const auto centre = std::ranges::min_element(axis.tangent, {}, [](const BandPoint& p) { return std::abs(p.x); });
      tiles.push_back(
          labelled_quantity("radial tangent stiffness near zero", centre->value, stiffness_unit(axis.axis), 3));
    }
  return tiles;
}

json fit_verdict(const FitRecord& fit) {
  const json checks = check_facts(fit);
  const auto failed = std::ranges::count_if(checks, [](const json& c) { return !c["pass"].get<bool>(); });
  std::string text = failed == 0 ? fmt::format("All {} checks of the fit pass", checks.size())
                                 : fmt::format("{} of {} checks of the fit fail", failed, checks.size());
  const long used = count_used(fit), total = static_cast<long>(fit.tests.size());
  const bool partial = used < total;
  if (partial) text += fmt::format("; {} of {} tests used", used, total);
  const std::size_t warnings = fit.warnings.size();
  if (warnings > 0) text += fmt::format("; {} {} about the data", warnings, warnings == 1 ? "warning" : "warnings");
  return {{"pass", failed == 0 && !partial}, {"partial", failed == 0 && partial}, {"text", text}};
}

json fit_facts(const FitFolder& folder, const std::string& id, int level) {
  const FitRecord& fit = folder.fit;
  json facts{{"id", id}, {"kind", "fit"}, {"level", level}, {"sublevel", level + 1}, {"figure_level", level + 2}};
  facts["title"] = fit.specimen;
  facts["subtitle"] = fmt::format("Stiffness and damping along {} {} from {} tests", fit.axes.size(),
                                  fit.axes.size() == 1 ? "axis" : "axes", count_used(fit));
  facts["checks"] = check_facts(fit);
  facts["has_checks"] = true;
  facts["verdict"] = fit_verdict(fit);
  facts["headline"] = fit_headline(fit);
  facts["tile_columns"] = tile_columns(facts["headline"].size());
  facts["synthetic"] = json::array();
  if (fit.synthetic)
    facts["synthetic"].push_back(fit.synthetic_note.empty() ? "The rig data are generated, not measured."
                                                            : fit.synthetic_note);
  facts["is_synthetic"] = fit.synthetic;
  facts["warnings"] = json::array();
  for (const FitWarning& warning : fit.warnings)
    facts["warnings"].push_back({{"code", warning.code},
                                 {"test", warning.test.empty() ? "whole campaign" : warning.test},
                                 {"text", warning.text}});
  facts["has_warnings"] = !fit.warnings.empty();
  facts["axes"] = json::array();
  for (const AxisFit& axis : fit.axes) facts["axes"].push_back(axis_facts(folder, axis, id));
  const std::string name = folder.path.filename().string();
  facts["provenance"] = provenance_facts(
      fit.provenance, {fit.provenance.command, fmt::format("grouser report {} -o {}/report.html", name, name)});
  return facts;
}

}  // namespace grouser
