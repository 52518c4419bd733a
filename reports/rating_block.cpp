#include "reports/rating_block.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>

#include "reports/channels.h"
#include "reports/number_text.h"
#include "reports/pages.h"
#include "reports/run_figures.h"

namespace grouser {
namespace {

using nlohmann::json;

json value_facts(const RatedMeasure& measure, const std::optional<double>& value) {
  if (!value) return {{"value", nullptr}, {"text", "–"}};
  constexpr double k_nothing = 5e-5;  // of what is told in per cent
  const bool percent = measure.unit == std::string("%");
  std::string text = !percent                       ? quantity_text(*value, measure.unit, 3)
                     : std::abs(*value) < k_nothing ? "0 %"
                                                    : percent_text(*value, 3);
  if (measure.key == std::string("iso")) text += fmt::format(" {}", iso_grade(*value));
  return {{"value", *value}, {"text", text}};
}

json cell_facts(const RatedMeasure& measure, const RatedChannel& rated, const RatingLimits& limits, bool judged) {
  const std::optional<double> value = rated.base.problem.empty() ? measure.value(rated.ratings) : std::nullopt;
  const std::optional<double> limit = limits.of(measure.key);
  json cell = value_facts(measure, value);
  cell["key"] = measure.key;
  cell["limit"] = limit ? json(*limit) : json();
  cell["pass"] = value && limit ? json(measure.meets(*value, *limit)) : json();
  cell["mark"] = judged && cell["pass"] == false ? "fail" : "";
  return cell;
}

/// The four parts of the ISO rating.
json part_facts(const Ratings& ratings) {
  json parts = json::array();
  const auto add = [&](const char* key, double IsoRating::*part) {
    parts.push_back({{"key", key},
                     {"value", ratings.iso ? json((*ratings.iso).*part) : json()},
                     {"text", ratings.iso ? number_text((*ratings.iso).*part, 3) : "–"}});
  };
  add("corridor", &IsoRating::corridor);
  add("phase", &IsoRating::phase);
  add("magnitude", &IsoRating::magnitude);
  add("slope", &IsoRating::slope);
  return parts;
}

/// What lies beyond its limit; empty when nothing does.
std::string missed_limits(const RatedChannel& rated, const RatingLimits& limits) {
  std::string failing;
  for (const RatedMeasure& measure : rated_measures()) {
    const std::optional<double> limit = limits.of(measure.key), value = measure.value(rated.ratings);
    if (limit && !(value && measure.meets(*value, *limit)))
      failing += (failing.empty() ? "" : ", ") + std::string(measure.brief);
  }
  return failing;
}

/// Of two runs, neither of which is the truth.
std::string likeness(const RatedChannel& rated, const RatingLimits& limits) {
  if (!rated.unrated.empty()) return "not rated: " + rated.unrated;
  const std::string missed = missed_limits(rated, limits);
  return missed.empty() ? "alike" : "differs: " + missed;
}

json row_facts(const RatedChannel& rated, const RatingLimits& limits, bool judged) {
  const bool based = rated.base.problem.empty(), is_rated = rated.unrated.empty();
  json row{{"name", rated.name}, {"label", channel_label(rated.name)}, {"cells", json::array()}};
  row["further"] = json::array();
  for (const RatedMeasure& measure : rated_measures())
    row[limits.of(measure.key) ? "cells" : "further"].push_back(cell_facts(measure, rated, limits, judged));
  row["parts"] = part_facts(based ? rated.ratings : Ratings{});
  row["rmse"] = based ? quantity_facts(rated.ratings.rmse, rated.unit, 3) : json{{"text", "–"}};
  row["rated"] = is_rated;
  row["pass"] = is_rated && meets_limits(rated, limits);
  row["verdict"] = judged ? rating_verdict(rated, limits) : likeness(rated, limits);
  row["mark"] = !judged || !is_rated ? "" : row["pass"] == true ? "pass" : "fail";
  row["from"] = based ? quantity_facts(rated.base.begin, "s") : json{{"text", "–"}};
  row["to"] = based ? quantity_facts(rated.base.end(), "s") : json{{"text", "–"}};
  row["points"] = {{"value", rated.base.reference.size()},
                   {"text", count_text(static_cast<long>(rated.base.reference.size()))}};
  row["step"] = based ? quantity_facts(rated.base.step, "s", 3) : json{{"text", "–"}};
  return row;
}

double largest(const std::vector<double>& values) {
  double most = 0.0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

std::string unit_label(const ShownUnit& unit) { return unit.unit == "1" ? "" : " [" + unit.unit + "]"; }

TimeSeries cut(const TimeSeries& curve, const TimeSpan& span) {
  TimeSeries part;
  for (std::size_t i = 0; i < curve.time.size(); ++i) {
    if (curve.time[i] < span.from || curve.time[i] > span.to) continue;
    part.time.push_back(curve.time[i]);
    part.value.push_back(curve.value[i]);
  }
  return part;
}

}  // namespace

RatedChannel rate_channel(const RunChannel& channel, TimeSeries reference, TimeSeries other, const TimeSpan& window) {
  RatedChannel rated{channel.name, channel.unit, channel.meaning, std::move(reference), std::move(other), {}, {}, ""};
  rated.base = common_base(rated.reference, rated.other, window);
  rated.unrated = rated.base.problem;
  if (!rated.unrated.empty()) return rated;
  rated.ratings = rate(rated.base.reference, rated.base.other, rated.base.step);
  if (is_flat(rated.base.reference)) rated.unrated = "the reference does not change in the window";
  return rated;
}

std::string channel_label(const std::string& name) {
  std::string label = name.starts_with("probes_") ? name.substr(7) : name;
  std::ranges::replace(label, '_', ' ');
  if (!label.empty()) label.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(label.front())));
  return label;
}

bool meets_limits(const RatedChannel& rated, const RatingLimits& limits) {
  return std::ranges::all_of(rated_measures(), [&](const RatedMeasure& measure) {
    const std::optional<double> limit = limits.of(measure.key), value = measure.value(rated.ratings);
    return !limit || (value && measure.meets(*value, *limit));
  });
}

std::string rating_verdict(const RatedChannel& rated, const RatingLimits& limits) {
  if (!rated.unrated.empty()) return "not rated: " + rated.unrated;
  const std::string missed = missed_limits(rated, limits);
  return missed.empty() ? "all limits met" : "missed: " + missed;
}

json ratings_facts(const std::vector<RatedChannel>& rated, const RatingLimits& limits, bool judged) {
  json facts{{"judged", judged},      {"heads", json::array()},   {"further_heads", json::array()},
             {"rows", json::array()}, {"sources", json::array()}, {"remarks", json::array()}};
  facts["verdict_head"] = judged ? "Verdict" : "Likeness";
  facts["parts_caption"] =
      "The four parts of the rating by ISO/TS 18571:2014 (weights 0.4, 0.2, 0.2, 0.2) and further measures";
  for (const RatedMeasure& measure : rated_measures()) {
    const std::optional<double> limit = limits.of(measure.key);
    facts[limit ? "heads" : "further_heads"].push_back(
        {{"key", measure.key}, {"label", measure.label}, {"limit", measure.text(limit)}});
    if (limit)
      facts["sources"].push_back({{"label", measure.label},
                                  {"limit", measure.text(limit)},
                                  {"source", limits.is_set(measure.key) ? "set for this report" : measure.source}});
  }
  for (const RatedChannel& channel : rated) {
    facts["rows"].push_back(row_facts(channel, limits, judged));
    if (!channel.base.remark.empty())
      facts["remarks"].push_back({{"label", channel_label(channel.name)}, {"text", channel.base.remark}});
  }
  facts["has_remarks"] = !facts["remarks"].empty();
  return facts;
}

Figure overlay_figure(const std::vector<const RatedChannel*>& rated, const std::string& reference,
                      const std::vector<std::string>& others, const TimeSpan& shown) {
  const RatedChannel& first = *rated.front();
  const ShownUnit unit = shown_unit(first.unit, std::max(largest(first.reference.value), largest(first.other.value)));
  const std::string in = unit_label(unit);
  Panel overlay = time_panel("", channel_label(first.name) + in);
  Panel difference =
      time_panel(rated.size() > 1 ? "" : "Difference from " + reference, (rated.size() > 1 ? "Difference" : "Δ") + in);
  const auto add = [&](const std::string& name, const TimeSeries& curve, int hue) {
    TimeSeries part = cut(curve, shown);
    overlay.series.push_back({.name = name,
                              .x = std::move(part.time),
                              .y = scaled(std::move(part.value), unit.scale),
                              .width = 1.3f,
                              .hue = hue});
  };
  add(reference, first.reference, 0);
  std::string instants;
  for (std::size_t k = 0; k < rated.size(); ++k) {
    const CommonBase& base = rated[k]->base;
    const int hue = static_cast<int>(k) + 1;
    add(others[k], rated[k]->other, hue);
    if (!base.problem.empty()) continue;
    std::vector<double> gap = base.other;
    for (std::size_t i = 0; i < gap.size(); ++i) gap[i] -= base.reference[i];
    difference.series.push_back({.name = rated.size() > 1 ? others[k] : "",
                                 .x = base.time(),
                                 .y = scaled(std::move(gap), unit.scale),
                                 .width = 1.1f,
                                 .hue = hue});
    if (instants.empty()) instants = count_text(static_cast<long>(base.reference.size()));
  }
  std::string caption = first.meaning;
  if (!caption.empty()) caption.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(caption.front())));
  if (!caption.empty()) caption += ". ";
  std::vector<Panel> panels{std::move(overlay)};
  if (!difference.series.empty()) {
    caption += fmt::format("Below, the difference from “{}” at {} common instants.", reference, instants);
    panels.push_back(std::move(difference));
  }
  return stacked_figure(first.name, channel_label(first.name) + " over time", caption, std::move(panels), 190);
}

TimeSpan rated_span(const RatedChannel& rated) {
  constexpr double k_margin = 0.1;
  if (!rated.base.problem.empty()) return k_all_time;
  const double margin = k_margin * (rated.base.end() - rated.base.begin);
  return {rated.base.begin - margin, rated.base.end() + margin};
}

std::optional<Figure> close_figure(const RatedChannel& rated, const std::string& reference, const std::string& other) {
  constexpr std::size_t k_instants = 150;
  const CommonBase& base = rated.base;
  if (base.reference.size() < 3 * k_instants) return std::nullopt;
  std::size_t worst = 0;
  const auto distance = [&](std::size_t i) { return std::abs(base.other[i] - base.reference[i]); };
  for (std::size_t i = 0; i < base.reference.size(); ++i)
    if (distance(i) > distance(worst)) worst = i;
  const std::size_t half = k_instants / 2;
  const std::size_t begin = std::clamp(worst, half, base.reference.size() - half) - half;
  const TimeSpan span{base.begin + base.step * static_cast<double>(begin),
                      base.begin + base.step * static_cast<double>(begin + k_instants)};
  const ShownUnit unit = shown_unit(rated.unit, std::max(largest(rated.reference.value), largest(rated.other.value)));
  Panel panel = time_panel("", channel_label(rated.name) + unit_label(unit));
  for (const auto& [name, curve] : {std::pair(reference, &rated.reference), {other, &rated.other}}) {
    TimeSeries part = cut(*curve, span);
    panel.series.push_back(
        {.name = name, .x = std::move(part.time), .y = scaled(std::move(part.value), unit.scale), .width = 1.5f});
  }
  const double at = base.begin + base.step * static_cast<double>(worst);
  panel.marks.push_back({at, true, ""});
  return stacked_figure(rated.name + "_zoom", channel_label(rated.name) + ", where they differ most",
                        fmt::format("The largest difference, {}, at {}.", quantity_text(distance(worst), rated.unit, 3),
                                    quantity_text(at, "s")),
                        {std::move(panel)}, 230);
}

Figure cross_figure(const std::vector<RatedChannel>& rated, const std::string& reference, const std::string& other) {
  constexpr std::size_t k_most_points = 800;
  Figure figure;
  figure.name = "cross_plots";
  figure.title = "One curve over the other";
  figure.caption = "Sample by sample; on the line both are equal.";
  figure.columns = 3;
  for (const RatedChannel& channel : rated) {
    if (!channel.base.problem.empty()) continue;
    const std::vector<double>&x = channel.base.reference, &y = channel.base.other;
    const ShownUnit unit = shown_unit(channel.unit, std::max(largest(x), largest(y)));
    const std::string in = unit_label(unit);
    Panel panel{.title = channel_label(channel.name), .x_label = reference + in, .y_label = other + in};
    Series points{.name = "", .style = SeriesStyle::points, .width = 1.6f, .hue = 0, .opacity = 0.5f};
    const std::size_t every = (x.size() + k_most_points - 1) / k_most_points;
    for (std::size_t i = 0; i < x.size(); i += every) {
      points.x.push_back(unit.scale * x[i]);
      points.y.push_back(unit.scale * y[i]);
    }
    const auto [low, high] = std::ranges::minmax(x);
    Series equal{.name = "", .x = {unit.scale * low, unit.scale * high}, .y = {unit.scale * low, unit.scale * high}};
    equal.style = SeriesStyle::dashed;
    equal.hue = 7;
    panel.series.push_back(std::move(points));
    panel.series.push_back(std::move(equal));
    figure.panels.push_back(std::move(panel));
  }
  figure.width = 960;
  figure.height = 290 * static_cast<int>((figure.panels.size() + 2) / 3);
  return figure;
}

}  // namespace grouser
