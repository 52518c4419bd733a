#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "reports/figure_block.h"
#include "reports/fit_checks.h"
#include "reports/fit_figures.h"
#include "reports/gain_trend.h"
#include "reports/loop_points.h"
#include "reports/number_text.h"
#include "reports/pages.h"
#include "reports/test_blocks.h"

namespace grouser {
namespace {

using nlohmann::json;

std::string stiffness_unit(Axis axis) { return is_rotation(axis) ? "N m/rad" : "N/m"; }

long count_used(const FitRecord& fit) {
  return static_cast<long>(std::ranges::count_if(fit.tests, [](const TestFit& test) { return !left_out(test); }));
}

json count_row(const std::string& label, long value) {
  return {{"label", label}, {"value", value}, {"text", count_text(value)}};
}

// ------------------------------------------------------------------------------------------------------ an axis

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
                      count_row("starts", solver.starts),
                      count_row("iterations of the best", solver.iterations),
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
  if (law.yield_growth > 0.0) {
    const double reach = law.valid ? law.valid->amplitude : 0.0, factor = 1.0 + law.yield_growth * reach * reach;
    rows.push_back({{"label", "yield at the largest displacement over that at 0"},
                    {"value", factor},
                    {"text", number_text(factor, 3)}});
  }
  if (!law.valid) return rows;
  rows.push_back(
      {{"label", "valid up to an amplitude of"},
       {"value", law.valid->amplitude},
       {"text", number_text(units.displacement_scale * law.valid->amplitude, 3) + " " + units.displacement}});
  rows.push_back({{"label", "valid at frequencies"},
                  {"value", {law.valid->frequency_low, law.valid->frequency_high}},
                  {"text", law.valid->frequency_high > 0.0 ? number_text(law.valid->frequency_low, 3) + " to " +
                                                                 number_text(law.valid->frequency_high, 3) + " Hz"
                                                           : "unknown: the records hold no rate"}});
  rows.push_back(
      {{"label", "largest rate seen"},
       {"value", law.valid->rate},
       {"text", number_text(units.displacement_scale * law.valid->rate, 3) + " " + units.displacement + "/s"}});
  return rows;
}

/// Play, hard stops and preset, each a line of a table.
json joint_limit_facts(const AxisFit& axis) {
  const AxisUnits units = units_of(axis.axis);
  const auto place = [&](double si) {
    return number_text(units.displacement_scale * si, 3) + " " + units.displacement;
  };
  json rows = json::array();
  if (axis.preset != 0.0) rows.push_back({{"label", "preset"}, {"value", axis.preset}, {"text", place(axis.preset)}});
  if (const auto& play = axis.clearance)
    rows.push_back({{"label", "play"},
                    {"value", {play->low, play->high}},
                    {"stiffness_ratio", play->stiffness_ratio},
                    {"text", fmt::format("{} to {}; stiffness in it {} of that outside", place(play->low),
                                         place(play->high), percent_text(play->stiffness_ratio, 2))}});
  for (const HardStop& stop : axis.hard_stops)
    rows.push_back({{"label", "hard stop"},
                    {"value", stop.at},
                    {"stiffness_ratio", stop.stiffness_ratio},
                    {"text", fmt::format("{}; {} times as stiff beyond it", place(stop.at),
                                         number_text(stop.stiffness_ratio, 2))}});
  return rows;
}

std::string trend_sentence(const Trend& trend, const char* quantity, const char* missing) {
  return fmt::format("Over {}: {} a decade, ± {} (95 %): {}.", quantity, signed_percent_text(trend.per_decade, 2),
                     fixed_percent_text(trend.half_width, 2),
                     trend.is_real() ? fmt::format("a trend, {} may be missing", missing) : "no trend");
}

json gain_facts(const std::vector<const TestFit*>& tests, const std::string& id) {
  json facts{{"figure", false}, {"trends", json::array()}};
  if (const std::optional<Figure> figure = figure_gain(tests))
    facts["figure"] = figure_block(*figure, id + "-" + figure->name);
  else
    return false;
  const GainTrends trends = gain_trends(tests);
  const auto add = [&](const std::optional<Trend>& trend, const char* quantity, const char* missing) {
    if (trend)
      facts["trends"].push_back({{"over", quantity},
                                 {"per_decade", trend->per_decade},
                                 {"half_width", trend->half_width},
                                 {"text", trend_sentence(*trend, quantity, missing)}});
  };
  add(trends.frequency, "frequency", "a Maxwell branch");
  add(trends.amplitude, "amplitude", "a friction stop or a yield that grows with strain");
  return facts;
}

std::string size_text(const LawCandidate& law) {
  return fmt::format("{} spring intervals, {} stops, {} branches{}", law.spring_intervals, law.stops, law.branches,
                     law.strain_dependent_yield ? ", yield growing with strain" : "");
}

json selection_facts(const AxisFit& axis, const std::string& id) {
  if (axis.selection.empty()) return false;
  json facts{{"rows", json::array()}, {"figure", false}, {"sentence", ""}};
  for (const LawCandidate& law : axis.selection)
    facts["rows"].push_back(
        {{"spring_intervals", {{"value", law.spring_intervals}, {"text", count_text(law.spring_intervals)}}},
         {"stops", {{"value", law.stops}, {"text", count_text(law.stops)}}},
         {"branches", {{"value", law.branches}, {"text", count_text(law.branches)}}},
         {"growth", law.strain_dependent_yield ? "yes" : "no"},
         {"error", {{"value", law.left_out_error}, {"text", percent_text(law.left_out_error, 3)}}},
         {"chosen", law.chosen}});
  facts["count"] = count_text(static_cast<long>(axis.selection.size()));
  const auto chosen = std::ranges::find(axis.selection, true, &LawCandidate::chosen);
  const auto best = std::ranges::min_element(axis.selection, {}, &LawCandidate::left_out_error);
  if (chosen != axis.selection.end())
    facts["sentence"] =
        fmt::format("Chosen: {}, with an error of {} on tests left out; the least of all tried is {}.",
                    size_text(*chosen), percent_text(chosen->left_out_error, 3), percent_text(best->left_out_error, 3));
  if (const std::optional<Figure> figure = figure_selection(axis))
    facts["figure"] = figure_block(*figure, id + "-" + figure->name);
  return facts;
}

/// The intervals behind the bands of the figures.
json response_facts(const AxisFit& axis) {
  const AxisUnits units = units_of(axis.axis);
  const auto interval = [](const Interval& of, double scale) {
    const double half = 0.5 * (of.high - of.low);
    return json{{"value", of.value},
                {"low", of.low},
                {"high", of.high},
                {"text", number_text(scale * of.value, 3)},
                {"half", of.value != 0.0 ? "± " + percent_text(half / std::abs(of.value), 2) : "–"}};
  };
  json rows = json::array();
  for (const ResponsePoint& cell : axis.responses)
    rows.push_back(
        {{"amplitude",
          {{"value", cell.amplitude}, {"text", number_text(units.displacement_scale * cell.amplitude, 3)}}},
         {"frequency",
          {{"value", cell.frequency}, {"text", cell.frequency > 0.0 ? number_text(cell.frequency, 3) : "–"}}},
         {"energy", interval(cell.energy, 1.0)},
         {"storage", interval(cell.storage_stiffness, units.stiffness_scale)},
         {"loss", interval(cell.loss_stiffness, units.stiffness_scale)},
         {"loss_factor", interval(cell.loss_factor, 1.0)}});
  return rows;
}

json axis_facts(const FitFolder& folder, const AxisFit& axis, const std::string& id) {
  const FitRecord& fit = folder.fit;
  const std::string key = id + "-axis-" + name_of(axis.axis);
  const std::vector<const TestFit*> tests = tests_of(fit.tests, axis.axis);
  json facts =
      tests_facts({.axis = axis.axis, .tests = tests, .law = "fit", .joint_fit = true, .warnings = fit.warnings}, key);
  facts["key"] = key;
  facts["axis_title"] = axis_title(axis.axis);
  facts["figures"] = json::array();
  for (const std::optional<Figure>& figure :
       {figure_stiffness(axis, tests), figure_energy(axis, tests), figure_backbone(axis)})
    if (figure) facts["figures"].push_back(figure_block(*figure, key + "-" + figure->name));
  facts["gain"] = gain_facts(tests, key);
  facts["responses"] = response_facts(axis);
  facts["has_responses"] = !axis.responses.empty();
  facts["response_count"] = count_text(static_cast<long>(axis.responses.size()));
  facts["joint_limits"] = joint_limit_facts(axis);
  facts["has_joint_limits"] = !facts["joint_limits"].empty();
  facts["not_identified"] = axis.not_identified;
  facts["has_not_identified"] = !axis.not_identified.empty();
  facts["solver"] = solver_facts(axis);
  facts["law"] = law_facts(folder.bushing.axis(axis.axis), axis.axis);
  facts["selection"] = selection_facts(axis, key);
  facts["parameters"] = json::array();
  for (const FitParameter& parameter : axis.parameters) facts["parameters"].push_back(parameter_facts(parameter));
  facts["has_parameters"] = !axis.parameters.empty();
  facts["parameter_count"] = count_text(static_cast<long>(axis.parameters.size()));
  return facts;
}

// ---------------------------------------------------------------------------------------------------- the whole

/// How the drawn bushings are used; false where the fit has none.
json draw_facts(const FitFolder& folder) {
  int draws = 0;
  for (const AxisFit& axis : folder.fit.axes) draws = std::max(draws, axis.draws);
  if (draws == 0) return false;
  const std::string example = fmt::format("bushing_{:02}.json", std::min(7, draws));
  return {{"value", draws},
          {"text", count_text(draws)},
          {"example", "draws/" + example},
          {"command", fmt::format("grouser simulate SCENARIO.json --bushing {}/draws/{}",
                                  folder.path.filename().string(), example)}};
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
  const long used = count_used(fit), total = static_cast<long>(fit.tests.size());
  json tests = count_row("tests", used);
  if (used < total) {
    tests["label"] = "tests used";
    tests["text"] = fmt::format("{} of {}", count_text(used), count_text(total));
  }
  json tiles = json::array(
      {count_row("axes identified", static_cast<long>(fit.axes.size())), tests, count_row("samples", samples)});
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

json fit_facts(const FitFolder& folder, const std::string& id, int level) {
  const FitRecord& fit = folder.fit;
  json facts{{"id", id}, {"kind", "fit"}, {"level", level}, {"sublevel", level + 1}, {"figure_level", level + 2}};
  facts["title"] = fit.specimen;
  facts["subtitle"] =
      fmt::format("Stiffness and damping along {} {} from {} {}", fit.axes.size(),
                  fit.axes.size() == 1 ? "axis" : "axes", count_used(fit), count_used(fit) == 1 ? "test" : "tests");
  facts["checks"] = axis_checks(fit);
  facts["campaign_checks"] = campaign_checks(fit);
  facts["has_campaign_checks"] = !facts["campaign_checks"].empty();
  facts["verdict"] = fit_verdict(fit);
  facts["headline"] = fit_headline(fit);
  facts["tile_columns"] = tile_columns(facts["headline"].size());
  facts["synthetic"] = json::array();
  if (fit.synthetic)
    facts["synthetic"].push_back(fit.synthetic_note.empty() ? "The rig data are generated, not measured."
                                                            : fit.synthetic_note);
  facts["is_synthetic"] = fit.synthetic;
  facts["warnings"] = warning_facts(fit.warnings);
  facts["has_warnings"] = !fit.warnings.empty();
  facts["corrections"] = correction_facts(fit.corrections);
  facts["has_corrections"] = !fit.corrections.empty();
  facts["axes"] = json::array();
  for (const AxisFit& axis : fit.axes) facts["axes"].push_back(axis_facts(folder, axis, id));
  facts["draws"] = draw_facts(folder);
  const std::string name = folder.path.filename().string();
  facts["provenance"] = provenance_facts(
      fit.provenance, {fit.provenance.command, fmt::format("grouser report {} -o {}/report.html", name, name)});
  return facts;
}

}  // namespace grouser
