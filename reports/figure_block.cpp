#include "reports/figure_block.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <set>
#include <span>

#include "render/heat_map.h"
#include "reports/assets.h"
#include "reports/encode.h"
#include "reports/number_text.h"

namespace grouser {
namespace {

using nlohmann::json;

constexpr std::size_t k_max_chart_rows =
    8000;  // of one curve set: about ten points a pixel column, so that a zoom still shows peaks

/// Without its title: the page has it as a heading.
std::string untitled_svg(Figure figure, const std::string& label) {
  figure.title.clear();
  return draw_svg(figure, label);
}

const char* style_name(SeriesStyle style) {
  switch (style) {
    case SeriesStyle::line:
      return "line";
    case SeriesStyle::dashed:
      return "dashed";
    case SeriesStyle::points:
      return "points";
    case SeriesStyle::steps:
      return "steps";
    case SeriesStyle::bars:
      return "bars";
  }
  return "line";
}

/// Curves of a panel that stand over the same x share one table.
struct CurveSet {
  const std::vector<double>* x;
  std::vector<std::size_t> series;
};
std::vector<CurveSet> curve_sets(const Panel& panel) {
  std::vector<CurveSet> sets;
  for (std::size_t i = 0; i < panel.series.size(); ++i) {
    const auto same = std::ranges::find_if(sets, [&](const CurveSet& set) { return *set.x == panel.series[i].x; });
    if (same != sets.end())
      same->series.push_back(i);
    else
      sets.push_back({&panel.series[i].x, {i}});
  }
  return sets;
}

std::string css_color(const Rgb& rgb) {
  return fmt::format("rgb({:.0f},{:.0f},{:.0f})", 255.0f * rgb[0], 255.0f * rgb[1], 255.0f * rgb[2]);
}

/// Five digits: more than a picture shows, and no round-off to tell two equal pages apart.
double five_digits(double value) {
  std::array<char, 32> text{};
  const auto end = fmt::format_to_n(text.data(), text.size() - 1, "{:.5g}", value).out;
  std::from_chars(text.data(), end, value);
  return value;
}
json numbers(std::span<const double> values) {
  json list = json::array();
  for (const double value : values) {
    if (std::isfinite(value))
      list.emplace_back(five_digits(value));
    else
      list.push_back(nullptr);
  }
  return list;
}

/// The numbers of a chart twice: packed for the page, and in words and digits for the twin.
struct ChartNumbers {
  std::vector<float> packed;
  json data = json::array();  ///< by panel

  json add(const std::vector<double>& values, std::span<const std::size_t> rows) {
    std::vector<double> kept;
    for (const std::size_t row : rows) kept.push_back(values[row]);
    for (const double value : kept) packed.push_back(static_cast<float>(value));
    return numbers(kept);
  }
};

/// The cells go row by row, the lowest first.
json chart_map(const HeatMap& map, ChartNumbers& to) {
  json colors = json::array();
  for (const Rgb& rgb : map_colors()) colors.push_back(css_color(rgb));
  json cells = json::array();
  for (std::size_t row = 0; row < map.rows; ++row)
    cells.push_back(numbers({map.values.data() + row * map.columns, map.columns}));
  for (const double value : map.values) to.packed.push_back(static_cast<float>(value));
  json chart{{"columns", map.columns},
             {"rows", map.rows},
             {"colors", colors},
             {"label", map.label},
             {"x_span", numbers(map.x_span)},
             {"y_span", numbers(map.y_span)}};
  chart["range"] = numbers(map.color_range());
  json& data = to.data.back()["map"] = chart;
  for (const char* own : {"columns", "rows", "colors"}) data.erase(own);
  data["cells"] = std::move(cells);
  return chart;
}

/// Describes a panel for the page's script and adds its decimated numbers.
json chart_panel(const Panel& panel, bool over_time, ChartNumbers& to) {
  json chart{{"title", panel.title}, {"x_label", panel.x_label}, {"y_label", panel.y_label},
             {"log_x", panel.log_x}, {"log_y", panel.log_y},     {"over_time", over_time}};
  if (panel.y_range) chart["y_range"] = *panel.y_range;
  if (panel.x_range) chart["x_range"] = *panel.x_range;
  to.data.push_back({{"title", panel.title}, {"x_label", panel.x_label}, {"y_label", panel.y_label}});
  chart["marks"] = json::array();
  for (const Mark& mark : panel.marks)
    chart["marks"].push_back({{"at", mark.at}, {"vertical", mark.vertical}, {"label", mark.label}});
  to.data.back()["marks"] = chart["marks"];
  chart["series"] = json::array();
  for (const Series& series : panel.series) {
    json entry{{"name", series.name}, {"style", style_name(series.style)}, {"width", series.width}};
    if (series.color) entry["color"] = css_color(*series.color);
    if (series.hue) entry["hue"] = *series.hue;
    chart["series"].push_back(entry);
  }
  if (panel.map) chart["map"] = chart_map(*panel.map, to);
  chart["tables"] = json::array();
  json& tables = to.data.back()["tables"] = json::array();
  for (const CurveSet& set : curve_sets(panel)) {
    std::vector<const std::vector<double>*> curves;
    for (const std::size_t i : set.series) curves.push_back(&panel.series[i].y);
    const std::vector<std::size_t> rows = peak_preserving_rows(curves, k_max_chart_rows);
    chart["tables"].push_back({{"rows", rows.size()}, {"series", set.series}});
    json table{{"x", to.add(*set.x, rows)}, {"series", json::array()}};
    for (const std::size_t i : set.series)
      table["series"].push_back({{"name", panel.series[i].name}, {"y", to.add(panel.series[i].y, rows)}});
    tables.push_back(std::move(table));
  }
  return chart;
}

// --------------------------------------------------------------------------------------------------- small multiples

const char* look_of(SeriesStyle style) {
  if (style == SeriesStyle::bars) return "band";
  return style == SeriesStyle::points ? "dots" : style == SeriesStyle::dashed ? "dashed" : "line";
}

std::string page_color(const std::optional<Rgb>& color, int entry) {
  if (!color) return fmt::format("var(--s{})", entry % 8 + 1);
  return css_color(*color);
}

/// Every name of the panels once, in order of appearance.
json legend_facts(std::span<const Panel> panels) {
  json entries = json::array();
  std::set<std::string> seen;
  for (const Panel& panel : panels) {
    for (std::size_t i = 0; i < panel.series.size(); ++i) {
      const Series& series = panel.series[i];
      if (!series.name.empty() && seen.insert(series.name).second)
        entries.push_back({{"name", series.name},
                           {"look", look_of(series.style)},
                           {"color", page_color(series.color, series.hue.value_or(static_cast<int>(i)))}});
    }
    for (std::size_t i = 0; i < panel.bands.size(); ++i) {
      const Band& band = panel.bands[i];
      if (!band.name.empty() && seen.insert(band.name).second)
        entries.push_back({{"name", band.name},
                           {"look", "band"},
                           {"color", page_color(band.color, band.hue.value_or(static_cast<int>(i)))}});
    }
  }
  return entries.size() > 1 ? entries : json::array();
}

/// Whether one legend can serve all panels: none of them gives a colour to another name.
bool share_legend(const Figure& figure) {
  std::size_t largest = 0;
  for (const Panel& panel : figure.panels) largest = std::max(largest, legend_facts({&panel, 1}).size());
  return legend_facts(figure.panels).size() <= std::max<std::size_t>(largest, 1);
}

/// The plotted numbers, for the twin.
json panel_data(const Panel& panel) {
  json data{{"title", panel.title},    {"x_label", panel.x_label}, {"y_label", panel.y_label},
            {"series", json::array()}, {"bands", json::array()},   {"marks", json::array()}};
  for (const Series& series : panel.series)
    data["series"].push_back({{"name", series.name}, {"x", numbers(series.x)}, {"y", numbers(series.y)}});
  for (const Band& band : panel.bands)
    data["bands"].push_back(
        {{"name", band.name}, {"x", numbers(band.x)}, {"low", numbers(band.low)}, {"high", numbers(band.high)}});
  for (const Mark& mark : panel.marks)
    data["marks"].push_back({{"label", mark.label}, {"at", numbers({&mark.at, 1})[0]}});
  return data;
}

/// The panel alone, without what the page says around it: its title and its legend.
Figure tile_figure(const Figure& figure, const Panel& panel, int width, int height) {
  Figure tile{.name = figure.name, .title = "", .caption = "", .panels = {panel}};
  tile.width = width;
  tile.height = height;
  tile.panels[0].title.clear();
  for (Series& series : tile.panels[0].series) series.name.clear();
  for (Band& band : tile.panels[0].bands) band.name.clear();
  return tile;
}

json tile_facts(const Figure& figure) {
  const auto count = static_cast<int>(figure.panels.size());
  const int columns = std::max(1, figure.columns), rows = (count + columns - 1) / columns;
  const int width = figure.width / columns, height = figure.height / rows;
  const bool shared = share_legend(figure);
  json tiles = json::array();
  for (const Panel& panel : figure.panels) {
    Figure alone{.name = "", .title = figure.title, .caption = "", .panels = {panel}};
    tiles.push_back({{"title", panel.title},
                     {k_data_key, panel_data(panel)},
                     {"note", ""},
                     {"legend", shared ? json::array() : legend_facts({&panel, 1})},
                     {"payload_svg", draw_svg(tile_figure(figure, panel, width, height), text_alternative(alone))}});
  }
  return tiles;
}

}  // namespace

bool chartable(const Figure& figure) {
  if (figure.columns > 1) return false;  // small multiples are read as a whole
  for (const Panel& panel : figure.panels) {
    if (!panel.bands.empty() || (panel.series.empty() && !panel.map)) return false;
    for (const Series& series : panel.series)
      if (series.x.size() < 2 || !std::ranges::is_sorted(series.x)) return false;
  }
  return !figure.panels.empty();
}

std::vector<std::size_t> peak_preserving_rows(const std::vector<const std::vector<double>*>& curves,
                                              std::size_t max_rows) {
  std::size_t num_rows = 0;
  for (const std::vector<double>* curve : curves) num_rows = std::max(num_rows, curve->size());
  std::vector<std::size_t> rows;
  if (num_rows <= max_rows) {
    for (std::size_t i = 0; i < num_rows; ++i) rows.push_back(i);
    return rows;
  }
  const std::size_t stretches =
      std::max<std::size_t>(1, (max_rows - 2) / (2 * std::max<std::size_t>(1, curves.size())));
  std::set<std::size_t> kept{0, num_rows - 1};
  for (std::size_t s = 0; s < stretches; ++s) {
    const std::size_t begin = s * num_rows / stretches, end = (s + 1) * num_rows / stretches;
    for (const std::vector<double>* curve : curves) {
      std::size_t lowest = begin, highest = begin;
      for (std::size_t i = begin; i < std::min(end, curve->size()); ++i) {
        if ((*curve)[i] < (*curve)[lowest] || std::isnan((*curve)[lowest])) lowest = i;
        if ((*curve)[i] > (*curve)[highest] || std::isnan((*curve)[highest])) highest = i;
      }
      kept.insert(lowest);
      kept.insert(highest);
    }
  }
  rows.assign(kept.begin(), kept.end());
  return rows;
}

std::string text_alternative(const Figure& figure) {
  std::string text = figure.title + ".";
  for (const Panel& panel : figure.panels) {
    const std::string heading = panel.title.empty() ? "" : panel.title + ", ";
    text += " " + heading + panel.y_label + ":";
    for (std::size_t i = 0; i < panel.series.size(); ++i) {
      const Series& series = panel.series[i];
      double low = std::nan(""), high = std::nan("");
      for (const double value : series.y) {
        low = std::fmin(low, value);
        high = std::fmax(high, value);
      }
      const std::string name = series.name.empty() ? "" : series.name + " ";
      text += fmt::format("{}{}from {} to {}", i == 0 ? " " : ", ", name, number_text(low, 3), number_text(high, 3));
    }
    if (panel.map) {
      const std::array<double, 2> range = panel.map->color_range();
      text += fmt::format(" {} as colour, from {} to {}", panel.map->label, number_text(range[0], 3),
                          number_text(range[1], 3));
    }
    text += ".";
  }
  return text;
}

json figure_block(const Figure& figure, const std::string& id) {
  json block{{"id", id},
             {"name", figure.name},
             {"title", figure.title},
             {"caption", figure.caption},
             {"alt", text_alternative(figure)}};
  const bool tiled = !chartable(figure), interactive = !tiled && has_interactive_charts();
  block["chart"] = interactive;
  block["drawn"] = !interactive && !tiled;
  block["tiled"] = tiled;
  if (tiled) {
    block["tiles"] = tile_facts(figure);
    block["many"] = figure.panels.size() > 4;
    block["tile_width"] = figure.width / std::max(1, figure.columns);
    block["legend"] = share_legend(figure) ? legend_facts(figure.panels) : json::array();
    return block;
  }
  block["payload_svg"] = untitled_svg(figure, block["alt"]);
  ChartNumbers all;
  json chart{{"id", id}, {"panels", json::array()}};
  const bool partial = figure.name.ends_with("_zoom");
  for (const Panel& panel : figure.panels) {
    // Stacked panels name the shared axis on the last one only.
    const bool over_time = figure.panels.back().x_label.starts_with("Time") && !partial;
    chart["panels"].push_back(chart_panel(panel, over_time, all));
  }
  block[k_data_key] = std::move(all.data);
  if (!interactive) return block;
  block["payload_chart"] = script_json(chart);
  block["payload_values"] = packed(std::span<const float>(all.packed));
  return block;
}

}  // namespace grouser
