#include <fmt/format.h>

#include <cmath>

#include "model/errors.h"
#include "reports/channels.h"
#include "reports/figure_block.h"
#include "reports/input_differences.h"
#include "reports/number_text.h"
#include "reports/pages.h"
#include "reports/rating_block.h"
#include "reports/result_names.h"
#include "reports/run_figures.h"

namespace grouser {
namespace {

using nlohmann::json;
using Folders = std::vector<RunFolder>;

// ----------------------------------------------------------------------------------------------------------- tables

json no_number() { return {{"value", nullptr}, {"text", "–"}}; }

/// Change from the first run as a fraction of it; none where the first is 0 or round-off, or of the other sign.
json change_facts(const std::optional<double>& first, const std::optional<double>& other) {
  constexpr double k_round_off = 1e-9;
  if (!first || !other || std::abs(*first) < k_round_off || *first * *other < 0.0) return no_number();
  const double change = (*other - *first) / std::abs(*first);
  constexpr double k_many_times = 10.0;  // from there on a factor says more than per cent
  if (change >= k_many_times) return {{"value", change}, {"text", "× " + number_text(*other / *first, 3)}};
  return {{"value", change}, {"text", signed_percent_text(change)}};
}

json difference_facts(const std::optional<double>& first, const std::optional<double>& other, const std::string& unit) {
  if (!first || !other) return no_number();
  json facts = result_facts(*other - *first, unit, 3);
  if (*other > *first && !facts["text"].get<std::string>().starts_with("0 ") && facts["text"] != "0")
    facts["text"] = "+" + facts["text"].get<std::string>();
  return facts;
}

/// One line: the value of each run, "–" where a run does not have it; of two runs difference and change from the first,
/// of more the change beside each value.
template <typename Value>
json row(const Folders& runs, const std::string& label, const std::string& unit, const Value& value) {
  std::vector<std::optional<double>> numbers;
  for (const RunFolder& run : runs) numbers.push_back(value(run.summary));
  json cells = json::array();
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    json cell = numbers[k] ? result_facts(*numbers[k], unit) : no_number();
    cell["change"] = k > 0 && numbers.size() > 2 ? change_facts(numbers.front(), numbers[k]) : json(false);
    cells.push_back(cell);
  }
  json facts{{"label", label}, {"cells", cells}, {"difference", false}, {"change", false}};
  if (numbers.size() == 2) {
    facts["difference"] = difference_facts(numbers[0], numbers[1], unit);
    facts["change"] = change_facts(numbers[0], numbers[1]);
  }
  return facts;
}

/// Rows under their headings, in order of appearance.
class GroupedRows {
 public:
  void add(const std::string& group, json row) {
    for (json& known : groups_) {
      if (known["title"] != group) continue;
      known["rows"].push_back(std::move(row));
      return;
    }
    groups_.push_back({{"title", group}, {"rows", json::array({std::move(row)})}});
  }
  [[nodiscard]] json groups() const { return groups_; }

 private:
  json groups_ = json::array();
};

void add_summary_rows(const Folders& runs, GroupedRows& rows) {
  using Optional = std::optional<double>;
  const auto add = [&](const char* group, const char* label, const char* unit, auto&& value) {
    rows.add(group, row(runs, label, unit, [&](const RunSummary& s) -> Optional { return value(s); }));
  };
  add("Energy", "Sprocket work", "J", [](const RunSummary& s) { return s.energy.input; });
  add("Energy", "Dissipated", "J", [](const RunSummary& s) { return s.energy.dissipated; });
  add("Energy", "Residual over ∫|P| dt", "1", [](const RunSummary& s) { return s.energy.residual_fraction; });
  add("Integration", "Simulated time", "s", [](const RunSummary& s) { return s.simulated_time; });
  add("Integration", "Wall time", "s", [](const RunSummary& s) { return s.wall_time; });
  add("Integration", "Force evaluations", "1",
      [](const RunSummary& s) { return static_cast<double>(s.steps.force_evaluations); });
  add("Integration", "Mean step", "s", [](const RunSummary& s) { return s.steps.mean; });
  add("Integration", "Least step", "s", [](const RunSummary& s) { return s.steps.min; });
}

/// Every result of every run once; contact cases that no run met are left out, and the mean step, which stands already.
json result_groups(const Folders& runs) {
  GroupedRows rows;
  std::vector<std::string> seen{"mean_step_s"};
  const auto value_in = [](const RunSummary& summary, const std::string& name) -> std::optional<double> {
    const auto found = std::ranges::find(summary.results, name, &RunResult::name);
    return found == summary.results.end() ? std::nullopt : std::optional{found->value};
  };
  const auto met = [&](const std::string& name) {
    return std::ranges::any_of(runs,
                               [&](const RunFolder& run) { return value_in(run.summary, name).value_or(0.0) != 0.0; });
  };
  for (const RunFolder& run : runs)
    for (const RunResult& result : run.summary.results) {
      if (std::ranges::find(seen, result.name) != seen.end()) continue;
      seen.push_back(result.name);
      if (is_contact_count(result) && !met(result.name)) continue;
      rows.add(result_group(result), row(runs, result_label(result), result.unit,
                                         [&](const RunSummary& s) { return value_in(s, result.name); }));
    }
  add_summary_rows(runs, rows);
  return rows.groups();
}

/// Every check of every run once, with what each run measured.
json check_rows(const Folders& runs) {
  json rows = json::array();
  std::vector<std::string> seen;
  for (const RunFolder& run : runs)
    for (const RunCheck& check : run.summary.checks) {
      if (std::ranges::find(seen, check.name) != seen.end()) continue;
      seen.push_back(check.name);
      json cells = json::array();
      for (const RunFolder& other : runs) {
        const auto found = std::ranges::find(other.summary.checks, check.name, &RunCheck::name);
        const bool known = found != other.summary.checks.end();
        json cell = known ? result_facts(found->value, found->unit) : no_number();
        cell["known"] = known;
        cell["pass"] = known && found->pass;
        cell["limit"] = known ? found->limit : "";
        cells.push_back(cell);
      }
      rows.push_back({{"label", check.name}, {"limit", check.limit}, {"cells", cells}});
    }
  return rows;
}

json difference_rows(const Folders& runs) {
  json rows = json::array();
  for (const InputDifference& difference : input_differences(runs)) {
    json cells = json::array();
    for (std::size_t k = 0; k < runs.size(); ++k)
      cells.push_back(
          {{"value", difference.numbers[k] ? json(*difference.numbers[k]) : json()}, {"text", difference.texts[k]}});
    rows.push_back({{"label", difference.label}, {"unit", difference.unit}, {"cells", cells}});
  }
  return rows;
}

// ----------------------------------------------------------------------------------------------------------- figures

/// The main channels of the first run against those of each other run; runs without one are passed over.
struct ComparedChannel {
  RunChannel channel;
  std::vector<RatedChannel> rated;
  std::vector<std::size_t> runs;  ///< of each rated one
};

std::vector<ComparedChannel> compared_channels(const Folders& runs, const TimeSpan& window) {
  std::vector<ComparedChannel> compared;
  for (const RunChannel& channel : main_channels(runs.front())) {
    ComparedChannel& entry = compared.emplace_back(ComparedChannel{channel, {}, {}});
    const TimeSeries reference = read_channel(runs.front(), channel);
    for (std::size_t k = 1; k < runs.size(); ++k) {
      const std::vector<RunChannel> own = main_channels(runs[k]);
      if (std::ranges::find(own, channel.name, &RunChannel::name) == own.end()) continue;
      entry.rated.push_back(rate_channel(channel, reference, read_channel(runs[k], channel), window));
      entry.runs.push_back(k);
    }
  }
  // What stands still in the first run and in every other tells nothing.
  std::erase_if(compared, [](const ComparedChannel& entry) {
    return std::ranges::all_of(entry.rated, [](const RatedChannel& rated) {
      return is_flat(rated.reference.value) && is_flat(rated.other.value);
    });
  });
  return compared;
}

/// How like the first run each other one is, run by run.
json rating_blocks(const Folders& runs, const std::vector<ComparedChannel>& compared, const RatingLimits& limits) {
  json blocks = json::array();
  for (std::size_t k = 1; k < runs.size(); ++k) {
    std::vector<RatedChannel> rated;
    for (const ComparedChannel& entry : compared)
      for (std::size_t i = 0; i < entry.rated.size(); ++i)
        if (entry.runs[i] == k) rated.push_back(entry.rated[i]);
    if (rated.empty()) continue;
    json block = ratings_facts(rated, limits, false);
    block["caption"] =
        fmt::format("How like the channels of {} are to those of {}", runs[k].summary.name, runs.front().summary.name);
    blocks.push_back(block);
  }
  return blocks;
}

/// The step sizes of all runs; runs without them are passed over.
Figure step_figure(const Folders& runs) {
  Panel panel = time_panel("", "Step [ms]");
  for (const RunFolder& run : runs) {
    try {
      panel.series.push_back({.name = run.summary.name,
                              .x = require_column(run, "/steps/time"),
                              .y = scaled(require_column(run, "/steps/size"), 1e3),
                              .width = 1.3f});
    } catch (const InputError&) {
      continue;
    }
  }
  return stacked_figure("step", "Step size", "Accepted steps of the integrator.", {std::move(panel)}, 260);
}

json overlay_figures(const Folders& runs, const std::vector<ComparedChannel>& compared, const std::string& id) {
  std::vector<Figure> figures;
  for (const ComparedChannel& entry : compared) {
    std::vector<const RatedChannel*> rated;
    std::vector<std::string> names;
    for (std::size_t i = 0; i < entry.rated.size(); ++i) {
      rated.push_back(&entry.rated[i]);
      names.push_back(runs[entry.runs[i]].summary.name);
    }
    if (!rated.empty()) figures.push_back(overlay_figure(rated, runs.front().summary.name, names));
  }
  if (Figure steps = step_figure(runs); !steps.panels.front().series.empty()) figures.push_back(std::move(steps));
  json blocks = json::array();
  for (const Figure& figure : figures) blocks.push_back(figure_block(figure, id + "-figure-" + figure.name));
  return blocks;
}

}  // namespace

json comparison_facts(const Folders& runs, const ComparisonOptions& options, const std::string& id, int level) {
  const std::vector<ComparedChannel> compared = compared_channels(runs, options.window);
  json facts{{"id", id},
             {"figure_level", level + 1},
             {"runs", json::array()},
             {"two", runs.size() == 2},
             {"span", runs.size() + (runs.size() == 2 ? 3 : 1)},
             {"inputs", difference_rows(runs)},
             {"groups", result_groups(runs)},
             {"checks", check_rows(runs)},
             {"ratings", rating_blocks(runs, compared, options.limits)},
             {"figures", overlay_figures(runs, compared, id)}};
  facts["rating_note"] = facts["ratings"].empty()
                             ? ""
                             : "The first run is the reference, not the truth. What rings at link passing soon has no "
                               "phase in common from run to run; of such channels Sprague-Geers M, the size, tells "
                               "more than correlation does.";
  facts["connection"] = connection_facts(runs);
  facts["has_inputs"] = !facts["inputs"].empty();
  facts["has_checks"] = !facts["checks"].empty();
  facts["is_synthetic"] = std::ranges::any_of(runs, [](const RunFolder& run) {
    return run.scenario.bushing.synthetic || !run.summary.provenance.synthetic.empty();
  });
  for (const RunFolder& run : runs) {
    json verdict = run_verdict(run.summary);
    verdict["name"] = run.summary.name;
    verdict["status"] = name_of(run.summary.status);
    facts["runs"].push_back(verdict);
  }
  return facts;
}

}  // namespace grouser
