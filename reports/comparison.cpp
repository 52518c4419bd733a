#include <fmt/format.h>

#include "model/errors.h"
#include "reports/channels.h"
#include "reports/figure_block.h"
#include "reports/number_text.h"
#include "reports/pages.h"
#include "reports/run_figures.h"

namespace grouser {
namespace {

using nlohmann::json;

/// One curve a run over time; runs without the data are passed over.
template <typename Curve>
Figure overlay(const std::vector<RunFolder>& runs, const std::string& name, const std::string& title,
               const std::string& caption, const std::string& y_label, const std::string& time, const Curve& curve) {
  Panel panel = time_panel("", y_label);
  for (const RunFolder& run : runs) {
    try {
      panel.series.push_back(
          {.name = run.summary.name, .x = require_column(run, time), .y = curve(run), .width = 1.3f});
    } catch (const InputError&) {
      continue;
    }
  }
  return stacked_figure(name, title, caption, {std::move(panel)}, 260);
}

/// The value of each run for one line of the table, "–" where a run does not have it.
template <typename Value>
json row(const std::vector<RunFolder>& runs, const std::string& label, const std::string& unit, const Value& value) {
  json cells = json::array();
  for (const RunFolder& run : runs) {
    const std::optional<double> number = value(run.summary);
    cells.push_back(number ? quantity_facts(*number, unit) : json{{"value", nullptr}, {"text", "–"}});
  }
  return {{"label", label}, {"cells", cells}};
}

json table(const std::vector<RunFolder>& runs) {
  using Optional = std::optional<double>;
  json rows = json::array();
  rows.push_back(row(runs, "simulated time", "s", [](const RunSummary& s) -> Optional { return s.simulated_time; }));
  rows.push_back(row(runs, "wall time", "s", [](const RunSummary& s) -> Optional { return s.wall_time; }));
  rows.push_back(row(runs, "mean step", "s", [](const RunSummary& s) -> Optional { return s.steps.mean; }));
  rows.push_back(row(runs, "sprocket work", "J", [](const RunSummary& s) -> Optional { return s.energy.input; }));
  rows.push_back(row(runs, "energy residual over ∫|P| dt", "1",
                     [](const RunSummary& s) -> Optional { return s.energy.residual_fraction; }));
  std::vector<std::string> seen;
  for (const RunFolder& run : runs)
    for (const RunResult& result : run.summary.results) {
      if (std::ranges::find(seen, result.name) != seen.end()) continue;
      seen.push_back(result.name);
      rows.push_back(row(runs, result_label(result), result.unit, [&](const RunSummary& s) -> Optional {
        const auto found = std::ranges::find(s.results, result.name, &RunResult::name);
        return found == s.results.end() ? Optional{} : Optional{found->value};
      }));
    }
  return rows;
}

}  // namespace

json comparison_facts(const std::vector<RunFolder>& runs, const std::string& id, int level) {
  json facts{{"id", id},
             {"figure_level", level + 1},
             {"runs", json::array()},
             {"rows", table(runs)},
             {"figures", json::array()}};
  for (const RunFolder& run : runs) {
    const bool pass =
        run.summary.status == RunStatus::completed && std::ranges::all_of(run.summary.checks, &RunCheck::pass);
    facts["runs"].push_back({{"name", run.summary.name}, {"verdict", name_of(run.summary.status)}, {"pass", pass}});
  }
  const std::vector<Figure> figures{
      overlay(runs, "compare_speed", "Speed", "Forward speed of each run.", "Speed v [m/s]", "/time",
              [](const RunFolder& run) { return forward_speed(run); }),
      overlay(runs, "compare_tension", "Tension of the upper run",
              "Mean over the bushings of the upper run of the right track.", "Tension [kN]", "/probes/time",
              [](const RunFolder& run) { return scaled(upper_run_tension(run, Side::right), 1e-3); }),
      overlay(runs, "compare_torque", "Sprocket torque", "Drive torque of the right sprocket.", "Drive torque [kN m]",
              "/probes/time", [](const RunFolder& run) { return scaled(sprocket_torque(run, Side::right), 1e-3); })};
  for (const Figure& figure : figures)
    if (!figure.panels.front().series.empty())
      facts["figures"].push_back(figure_block(figure, id + "-figure-" + figure.name));
  return facts;
}

}  // namespace grouser
