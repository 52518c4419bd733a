#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "reports/figure_block.h"
#include "reports/input_differences.h"
#include "reports/number_text.h"
#include "reports/pages.h"
#include "reports/run_measures.h"

namespace grouser {
namespace {

using nlohmann::json;

/// One measure over the parameter; NaN for a run that does not hold it.
struct Curve {
  const MeasureGroup* group;
  std::string name, unit;
  std::vector<double> values;

  [[nodiscard]] double first() const { return values.front(); }
  [[nodiscard]] double last() const { return values.back(); }
  [[nodiscard]] bool positive() const {
    return std::ranges::all_of(values, [](double v) { return v > 0.0; });
  }
};

std::vector<Curve> curves_of(const std::vector<RunFolder>& runs) {
  std::vector<Curve> curves;
  for (std::size_t k = 0; k < runs.size(); ++k)
    for (const Measure& measure : run_measures(runs[k])) {
      const auto same = [&](const Curve& c) { return c.group->key == measure.group && c.name == measure.name; };
      auto found = std::ranges::find_if(curves, same);
      if (found == curves.end()) {
        const auto group = std::ranges::find(measure_groups(), measure.group,
                                             [](const MeasureGroup& g) { return std::string(g.key); });
        curves.push_back({&*group, measure.name, measure.unit, std::vector<double>(runs.size(), std::nan(""))});
        found = std::prev(curves.end());
      }
      found->values[k] = measure.value;
    }
  // What is nothing in every run has nothing to follow.
  std::erase_if(curves,
                [](const Curve& c) { return std::ranges::all_of(c.values, [](double v) { return v == 0.0; }); });
  std::ranges::stable_sort(curves, {}, &Curve::group);
  return curves;
}

const Curve* find(const std::vector<Curve>& curves, const std::string& group, const std::string& name) {
  const auto found =
      std::ranges::find_if(curves, [&](const Curve& c) { return c.group->key == group && c.name == name; });
  const bool usable =
      found != curves.end() && std::ranges::all_of(found->values, [](double v) { return std::isfinite(v); });
  return usable ? &*found : nullptr;
}

/// Exponent b of the power law y = a x^b through the points: slope of the line through their logarithms by least
/// squares; NaN unless all numbers are positive.
double exponent(std::span<const double> x, std::span<const double> y) {
  const auto count = static_cast<double>(x.size());
  double mean_x = 0.0, mean_y = 0.0, moment = 0.0, spread = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!(x[i] > 0.0) || !(y[i] > 0.0)) return std::nan("");
    mean_x += std::log(x[i]) / count;
    mean_y += std::log(y[i]) / count;
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    moment += (std::log(x[i]) - mean_x) * (std::log(y[i]) - mean_y);
    spread += (std::log(x[i]) - mean_x) * (std::log(x[i]) - mean_x);
  }
  return moment / spread;
}

/// What a curve does from its first to its last point, in words.
std::string trend(const std::string& what, const Curve& curve, const std::vector<std::string>& at) {
  constexpr double k_steady = 0.02;
  const auto text = [&](double value) { return quantity_text(value, curve.unit, 3); };
  const auto [low, high] = std::ranges::minmax_element(curve.values);
  const double size = std::max(std::abs(*low), std::abs(*high));
  if (*high - *low <= k_steady * size)
    return fmt::format("{} stays within {} of {}", what, percent_text((*high - *low) / size, 2), text(curve.first()));
  const bool rises = std::ranges::is_sorted(curve.values),
             falls = std::ranges::is_sorted(curve.values, std::greater<>());
  if (rises || falls)
    return fmt::format("{} {} by {} ({} to {})", what, rises ? "rises" : "falls",
                       percent_text(std::abs(curve.last() / curve.first() - 1.0), 2), text(curve.first()),
                       text(curve.last()));
  // Not one way: its extreme inside tells most.
  const bool peak = *high > std::max(curve.first(), curve.last());
  const auto extreme = peak ? high : low;
  return fmt::format("{} goes from {} to {} over {} at {}", what, text(curve.first()), text(curve.last()),
                     text(*extreme), at[static_cast<std::size_t>(extreme - curve.values.begin())]);
}

/// The contact partner whose peaks change most by ratio.
const Curve* most_changed_contact(const std::vector<Curve>& curves) {
  const Curve* most = nullptr;
  const auto ratio = [](const Curve& c) { return std::abs(std::log(c.last() / c.first())); };
  for (const Curve& curve : curves)
    if (curve.group->key == std::string("contacts") && curve.positive() &&
        (most == nullptr || ratio(curve) > ratio(*most)))
      most = &curve;
  return most;
}

std::string first_sentence(const InputDifference& parameter, const std::vector<Curve>& curves) {
  std::vector<std::string> phrases;
  const auto add = [&](const std::string& what, const Curve* curve) {
    if (curve != nullptr) phrases.push_back(trend(what, *curve, parameter.texts));
  };
  add("the largest tension in a bushing", find(curves, "tension", "largest"));
  add("the mean tension of the upper run", find(curves, "spans", "upper run"));
  add("the torque at link passing", find(curves, "torque", "torque at link passing"));
  if (const Curve* contact = most_changed_contact(curves))
    add("the contact peak of the " + contact->name + ", which changes most,", contact);
  add("the rolling resistance", find(curves, "resistance", "rolling resistance"));
  std::string sentence =
      fmt::format("With {} from {} to {}, ", parameter.label, parameter.texts.front(), parameter.texts.back());
  for (std::size_t i = 0; i < phrases.size(); ++i)
    sentence += (i == 0 ? "" : i + 1 == phrases.size() ? "; and " : "; ") + phrases[i];
  return sentence + ".";
}

std::string second_sentence(const InputDifference& parameter, const std::vector<double>& x,
                            const std::vector<Curve>& curves) {
  const Curve* step = find(curves, "step", "mean");
  const Curve* cost = find(curves, "cost", "force evaluations a second");
  if (step == nullptr) return "";
  std::string sentence = trend("The mean step", *step, parameter.texts);
  const double power = exponent(x, step->values);
  if (std::isfinite(power)) {
    const std::size_t n = x.size();
    sentence +=
        fmt::format(", as the {} to the power {} over all and {} between the last two values", parameter.label,
                    number_text(power, 2),
                    number_text(exponent(std::span(x).subspan(n - 2), std::span(step->values).subspan(n - 2)), 2));
  }
  if (cost != nullptr && cost->positive())
    sentence +=
        fmt::format("; a simulated second costs {} times as many force evaluations at {} as at {}",
                    number_text(cost->last() / cost->first(), 3), parameter.texts.back(), parameter.texts.front());
  return sentence + ".";
}

Figure study_figure(const InputDifference& parameter, const std::vector<double>& x, const std::vector<Curve>& curves) {
  Figure figure;
  figure.name = "study";
  figure.title = "What follows " + parameter.label;
  figure.columns = 3;
  const bool log_x = x.front() > 0.0 && x.back() >= 4.0 * x.front();
  for (const Curve& curve : curves) {
    if (figure.panels.empty() || figure.panels.back().title != curve.group->title) {
      Panel& panel = figure.panels.emplace_back();
      panel.title = curve.group->title;
      panel.x_label = parameter.label + (parameter.unit.empty() ? "" : " [" + parameter.unit + "]");
      panel.x_label.front() = static_cast<char>(std::toupper(panel.x_label.front()));
      panel.y_label = curve.group->y_label;
      panel.log_x = log_x;
      panel.log_y = curve.group->log_y;
    }
    Panel& panel = figure.panels.back();
    const int hue = static_cast<int>(panel.series.size() / 2);
    Series line{.name = curve.name, .x = x, .y = curve.values, .width = 1.5f, .hue = hue};
    for (double& value : line.y) value *= curve.group->scale;
    Series points = line;
    points.name.clear();
    points.style = SeriesStyle::points;
    points.width = 2.5f;
    panel.series.push_back(std::move(line));
    panel.series.push_back(std::move(points));
  }
  figure.width = 1050;
  figure.height = 230 * static_cast<int>((figure.panels.size() + 2) / 3);
  return figure;
}

/// From the first to the last value: as a fraction where all have one sign, else as a difference.
json change_of(const Curve& curve) {
  const bool negative = std::ranges::all_of(curve.values, [](double v) { return v < 0.0; });
  const double difference = curve.last() - curve.first();
  if (!std::isfinite(difference)) return {{"value", nullptr}, {"text", "–"}};
  if (curve.positive() || negative) {
    const double change = difference / std::abs(curve.first());
    return {{"value", change}, {"text", signed_percent_text(change)}};
  }
  return {{"value", difference}, {"text", (difference > 0.0 ? "+" : "") + quantity_text(difference, curve.unit, 3)}};
}

json table_row(const Curve& curve, const std::vector<double>& x) {
  const bool share = curve.group->key == std::string("limits");
  json cells = json::array();
  for (const double value : curve.values) {
    cells.push_back(quantity_facts(value, curve.unit, 3));
    if (share) cells.back()["text"] = percent_text(value, 2);
  }
  const double power = exponent(x, curve.values);
  return {{"label", curve.name},
          {"cells", cells},
          {"change", change_of(curve)},
          {"power", {{"value", std::isfinite(power) ? json(power) : json()}, {"text", number_text(power, 2)}}}};
}

/// Where the rubber was driven furthest beyond what was identified, if it was.
std::string care_of(const InputDifference& parameter, const std::vector<Curve>& curves) {
  double most = 1.0;
  std::string text;
  for (const Curve& curve : curves) {
    if (curve.group->key != std::string("rubber")) continue;
    for (std::size_t k = 0; k < curve.values.size(); ++k) {
      if (!(curve.values[k] > most)) continue;
      most = curve.values[k];
      text = fmt::format(
          "At {} {} a bushing is deflected {} times as far as it was identified ({}); there its law goes "
          "on as a straight line, and the peaks are worth as much as that assumption.",
          parameter.label, parameter.texts[k], number_text(most, 2), curve.name);
    }
  }
  return text;
}

/// Of the paper's own words on the matter, where the parameter is theirs.
std::string note_of(const InputDifference& parameter) {
  if (!parameter.label.starts_with("bushing scale")) return "";
  return "The paper closes (Section 7, last sentence) with the statement that the stiffness of the bushings has a "
         "marked "
         "effect on how the tracked vehicle responds; it gives no numbers for it. An explicit step that only the "
         "bushings bound would go with the power −1/2 of their stiffness, for their highest frequency goes with +1/2.";
}

}  // namespace

std::optional<InputDifference> study_parameter(const std::vector<RunFolder>& runs) {
  constexpr std::size_t k_fewest = 3;
  if (runs.size() < k_fewest) return std::nullopt;
  const std::vector<InputDifference> differences = input_differences(runs);
  if (differences.size() != 1) return std::nullopt;
  std::set<double> values;
  for (const std::optional<double>& number : differences.front().numbers)
    if (!number || !values.insert(*number).second) return std::nullopt;
  return differences.front();
}

json study_facts(const std::vector<RunFolder>& runs, const InputDifference& parameter, const std::string& id,
                 int level) {
  std::vector<double> x;
  for (const std::optional<double>& number : parameter.numbers) x.push_back(number.value());
  const std::vector<Curve> curves = curves_of(runs);
  const Scenario& scenario = runs.front().scenario;
  json facts{{"id", id}, {"figure_level", level + 1}};
  facts["title"] = fmt::format("Study of {}", parameter.label);
  facts["parameter_text"] = parameter.label;
  facts["parameter"] = {{"label", parameter.label}, {"unit", parameter.unit}, {"values", x}};
  facts["lead"] = fmt::format("{} runs of “{}”, {} each, that differ in nothing else.", runs.size(), scenario.name,
                              quantity_text(scenario.duration, "s"));
  facts["is_synthetic"] =
      std::ranges::any_of(runs, [](const RunFolder& run) { return run.scenario.bushing.synthetic; });
  facts["conclusion"] = {first_sentence(parameter, curves), second_sentence(parameter, x, curves)};
  facts["care"] = care_of(parameter, curves);
  facts["paper"] = note_of(parameter);
  facts["figure"] = figure_block(study_figure(parameter, x, curves), id + "-figure");
  facts["columns"] = json::array();
  for (std::size_t k = 0; k < runs.size(); ++k) facts["columns"].push_back({{"text", parameter.texts[k]}});
  facts["span"] = runs.size() + 3;
  facts["groups"] = json::array();
  for (const Curve& curve : curves) {
    json& groups = facts["groups"];
    if (groups.empty() || groups.back()["title"] != curve.group->title)
      groups.push_back({{"title", curve.group->title}, {"rows", json::array()}});
    groups.back()["rows"].push_back(table_row(curve, x));
  }
  return facts;
}

}  // namespace grouser
