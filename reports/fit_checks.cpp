#include "reports/fit_checks.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>

#include "reports/fit_figures.h"
#include "reports/loop_points.h"
#include "reports/number_text.h"
#include "reports/pages.h"

namespace grouser {
namespace {

using nlohmann::json;
using Value = std::optional<double>;

/// An axis and the tests that entered its fit.
struct Judged {
  const AxisFit& axis;
  std::vector<const TestFit*> tests;
};

Value largest(Value found, double value) { return found ? std::fmax(*found, value) : value; }

template <typename Of>
Value largest_of_loops(const Judged& judged, const Of& of) {
  Value found;
  for (const LoopPoint& loop : loop_points(judged.tests)) found = largest(found, std::abs(of(loop)));
  return found;
}

Value worst_nrmse(const Judged& judged) {
  Value found;
  for (const TestFit* test : judged.tests) found = largest(found, test->nrmse);
  return found;
}

Value energy_error(const Judged& judged) {
  return largest_of_loops(judged, [](const LoopPoint& loop) {
    return relative_error(loop.fitted.dissipated_energy, loop.measured.dissipated_energy);
  });
}

Value stiffness_error(const Judged& judged) {
  return largest_of_loops(judged, [](const LoopPoint& loop) {
    return relative_error(stiffness_of(loop.fitted), stiffness_of(loop.measured));
  });
}

template <typename Of>
Value widest_response(const Judged& judged, const Of& of) {
  Value found;
  for (const ResponsePoint& cell : judged.axis.responses) {
    const Interval& interval = of(cell);
    if (interval.value > 0.0) found = largest(found, 0.5 * (interval.high - interval.low) / interval.value);
  }
  return found;
}

Value energy_interval(const Judged& judged) {
  return widest_response(judged, [](const ResponsePoint& cell) -> const Interval& { return cell.energy; });
}

Value stiffness_interval(const Judged& judged) {
  return widest_response(judged, [](const ResponsePoint& cell) -> const Interval& { return cell.storage_stiffness; });
}

Value backbone_interval(const Judged& judged) {
  Value widest, force;
  for (const BandPoint& point : judged.axis.backbone) {
    widest = largest(widest, 0.5 * (point.high - point.low));
    force = largest(force, std::abs(point.value));
  }
  return force && *force > 0.0 ? Value(*widest / *force) : Value();
}

Value tangent_interval(const Judged& judged) {
  Value found;
  for (const BandPoint& point : judged.axis.tangent)
    if (point.value > 0.0) found = largest(found, 0.5 * (point.high - point.low) / point.value);
  return found;
}

Value left_out_error(const Judged& judged) {
  const auto chosen = std::ranges::find(judged.axis.selection, true, &LawCandidate::chosen);
  return chosen == judged.axis.selection.end() || chosen->left_out_error <= 0.0 ? Value() : chosen->left_out_error;
}

Value smallest_weight(const Judged& judged) {
  Value found;
  for (const TestFit* test : judged.tests) found = found ? std::fmin(*found, test->weight) : test->weight;
  return found;
}

/// Of a solver that ended otherwise than by convergence, no residual is small enough.
Value optimality(const Judged& judged) {
  const SolverSummary& solver = judged.axis.solver;
  return solver.termination == "CONVERGENCE" ? solver.kkt_residual : std::nan("");
}

enum class Style { percent, number };
struct Criterion {
  const char* label;
  Value (*value)(const Judged&);
  double limit;
  bool at_least = false;
  Style style = Style::percent;
};

constexpr std::array<Criterion, 10> k_criteria{{
    {"Largest residual of a test (nrmse)", worst_nrmse, k_fit_limits.nrmse},
    {"Largest error of a loop’s energy", energy_error, k_fit_limits.energy_error},
    {"Largest error of a loop’s stiffness", stiffness_error, k_fit_limits.stiffness_error},
    {"Widest 95 % interval of energy, ±", energy_interval, k_fit_limits.energy_interval},
    {"Widest 95 % interval of stiffness, ±", stiffness_interval, k_fit_limits.stiffness_interval},
    {"Widest 95 % interval of the tangent, ±", tangent_interval, k_fit_limits.stiffness_interval},
    {"Widest 95 % interval of the backbone, ± of its range", backbone_interval, k_fit_limits.backbone_interval},
    {"Error of tests left out of the fit", left_out_error, k_fit_limits.left_out_error},
    {"Smallest weight of a test", smallest_weight, k_fit_limits.weight, true, Style::number},
    {"Optimality (KKT residual)", optimality, k_fit_limits.kkt_residual, false, Style::number},
}};

std::string value_text(const Criterion& criterion, double value) {
  return criterion.style == Style::percent ? percent_text(value, 2) : number_text(value, 2);
}

json cell_facts(const Criterion& criterion, const Judged& judged) {
  const Value value = criterion.value(judged);
  json cell{{"axis", name_of(judged.axis.axis)}, {"known", value.has_value()}};
  if (!value) {
    cell.update({{"value", nullptr}, {"text", "–"}, {"pass", true}});
    return cell;
  }
  // Written so that a NaN fails.
  const bool pass = criterion.at_least ? *value >= criterion.limit : *value <= criterion.limit;
  cell.update({{"value", *value}, {"text", value_text(criterion, *value)}, {"pass", pass}});
  return cell;
}

}  // namespace

json axis_checks(const FitRecord& fit) {
  std::vector<Judged> judged;
  for (const AxisFit& axis : fit.axes) {
    judged.push_back({axis, tests_of(fit.tests, axis.axis)});
    std::erase_if(judged.back().tests, [](const TestFit* test) { return left_out(*test); });
  }
  json table{{"axes", json::array()}, {"rows", json::array()}};
  for (const Criterion& criterion : k_criteria) {
    json cells = json::array();
    for (const Judged& each : judged) cells.push_back(cell_facts(criterion, each));
    if (std::ranges::none_of(cells, [](const json& cell) { return cell["known"].get<bool>(); })) continue;
    table["rows"].push_back({{"label", criterion.label},
                             {"limit_value", criterion.limit},
                             {"limit", (criterion.at_least ? "≥ " : "≤ ") + value_text(criterion, criterion.limit)},
                             {"cells", cells}});
  }
  for (std::size_t i = 0; i < judged.size(); ++i) {
    const bool pass =
        std::ranges::all_of(table["rows"], [i](const json& row) { return row["cells"][i]["pass"].get<bool>(); });
    table["axes"].push_back({{"name", name_of(judged[i].axis.axis)},
                             {"title", axis_title(judged[i].axis.axis)},
                             {"pass", pass},
                             {"verdict", pass ? "pass" : "fail"}});
  }
  return table;
}

json campaign_checks(const FitRecord& fit) {
  json checks = json::array();
  if (fit.calibration_residual > 0.0)  // 0: the campaign has no calibration record
    checks.push_back({{"label", "Largest residual of a sensor calibration, of full scale"},
                      {"value", fit.calibration_residual},
                      {"text", percent_text(fit.calibration_residual, 2)},
                      {"limit", "≤ " + percent_text(k_fit_limits.calibration_residual)},
                      {"pass", fit.calibration_residual <= k_fit_limits.calibration_residual}});
  return checks;
}

namespace {

/// "x: largest error of a loop’s energy 7.2 % (limit ≤ 5 %)", the first few.
std::string failures_text(const json& table) {
  std::vector<std::string> failures;
  for (const json& row : table["rows"])
    for (const json& cell : row["cells"])
      if (!cell["pass"].get<bool>())
        failures.push_back(fmt::format("{}: {} {} (limit {})", cell["axis"].get<std::string>(),
                                       row["label"].get<std::string>(), cell["text"].get<std::string>(),
                                       row["limit"].get<std::string>()));
  constexpr std::size_t k_told = 3;
  const std::size_t more = failures.size() > k_told ? failures.size() - k_told : 0;
  failures.resize(failures.size() - more);
  return fmt::format("{}{}", fmt::join(failures, "; "), more > 0 ? fmt::format("; and {} more", more) : "");
}

}  // namespace

json fit_verdict(const FitRecord& fit) {
  const json table = axis_checks(fit), campaign = campaign_checks(fit);
  const auto passes = [](const json& item) { return item["pass"].get<bool>(); };
  const auto met = std::ranges::count_if(table["axes"], passes);
  const auto axes = static_cast<long>(fit.axes.size());
  const bool calibrated = std::ranges::all_of(campaign, passes), pass = axes > 0 && met == axes && calibrated;
  std::string text = "No axis could be identified";
  if (axes > 0 && met == axes)
    text = fmt::format("Every limit is met on {}", axes == 1 ? "the axis" : fmt::format("all {} axes", axes));
  else if (axes > 0)
    text = fmt::format("{}. Not met: {}",
                       axes == 1 ? "The axis misses a limit" : fmt::format("{} of {} axes meet every limit", met, axes),
                       failures_text(table));
  if (!calibrated) text += "; the sensors’ calibration record does not fit their calibration";
  const auto total = static_cast<long>(fit.tests.size());
  const long used = total - static_cast<long>(std::ranges::count_if(fit.tests, left_out));
  const bool partial = used < total;
  if (partial) text += fmt::format("; {} of {} tests used", used, total);
  const std::size_t warnings = fit.warnings.size();
  if (warnings > 0) text += fmt::format("; {} {} about the data", warnings, warnings == 1 ? "warning" : "warnings");
  return {{"pass", pass && !partial}, {"partial", pass && partial}, {"text", text}};
}

}  // namespace grouser
