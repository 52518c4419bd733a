#include "render/figure_layout.h"

#include <algorithm>
#include <cmath>

namespace grouser {
namespace {

/// Margins round the plots, CSS pixels.
constexpr float k_edge = 14.0f, k_right = 20.0f, k_title_height = 32.0f, k_header = 12.0f, k_header_titled = 28.0f;
constexpr float k_x_numbers = 24.0f, k_x_name = 22.0f, k_y_name = 24.0f, k_tick_gap = 9.0f, k_shared_gap = 4.0f;
constexpr float k_map_gap = 12.0f, k_map_bar = 12.0f;
constexpr float k_legend_margin = 10.0f, k_legend_padding = 8.0f;

std::vector<LegendEntry> legend_of(const Panel& panel, const std::vector<Rgb>& palette) {
  std::vector<LegendEntry> entries;
  for (std::size_t i = 0; i < panel.bands.size(); ++i) {
    if (!panel.bands[i].name.empty())
      entries.push_back({panel.bands[i].name, band_color(panel, i, palette), LegendEntry::Look::band, 0.0f});
  }
  for (std::size_t i = 0; i < panel.series.size(); ++i) {
    const Series& series = panel.series[i];
    if (series.name.empty()) continue;
    const auto look = series.style == SeriesStyle::dashed   ? LegendEntry::Look::dashed
                      : series.style == SeriesStyle::points ? LegendEntry::Look::dots
                      : series.style == SeriesStyle::bars   ? LegendEntry::Look::band
                                                            : LegendEntry::Look::line;
    entries.push_back({series.name, series_color(panel, i, palette), look, series.width});
  }
  if (entries.size() == 1 && entries[0].name == panel.title) entries.clear();  // the title says it already
  return entries;
}

bool rises(const std::vector<double>& values) { return std::is_sorted(values.begin(), values.end()); }

PlotAxis x_axis(const Panel& panel) {
  ValueRange range(panel.log_x);
  bool sorted = true, dots = false;
  for (const Series& series : panel.series) {
    const double reach = series.style == SeriesStyle::bars ? half_bin(series) : 0.0;
    for (const double value : series.x) {
      range.add(value - reach);
      range.add(value + reach);
    }
    sorted = sorted && rises(series.x);
    dots = dots || series.style == SeriesStyle::points;
  }
  for (const Band& band : panel.bands) {
    for (const double value : band.x) range.add(value);
  }
  if (panel.map)
    for (const double value : panel.map->x_span) range.add(value);
  return range.axis(sorted && !dots ? 0.0 : 0.04, panel.x_range);
}

PlotAxis y_axis(const Panel& panel, const PlotAxis& x) {
  ValueRange range(panel.log_y);
  const auto seen = [&x](double value) { return value >= x.low && value <= x.high; };
  const auto add = [&](const std::vector<double>& at, const std::vector<double>& values) {
    for (std::size_t i = 0; i < std::min(at.size(), values.size()); ++i) {
      if (seen(at[i])) range.add(values[i]);
    }
  };
  for (const Series& series : panel.series) add(series.x, series.y);
  for (const Band& band : panel.bands) {
    add(band.x, band.low);
    add(band.x, band.high);
  }
  for (const Mark& mark : panel.marks) {
    if (!mark.vertical) range.add(mark.at);
  }
  if (panel.map && panel.series.empty()) return range.axis(0.0, panel.y_range.value_or(panel.map->y_span));
  return range.axis(0.06, panel.y_range);
}

/// Of a panel with a map: where its colours begin and end.
void measure_map(const Panel& panel, PanelLayout& layout) {
  const std::array<double, 2> range = panel.map->color_range();
  layout.map_axis = {range[0], range[1], false};
  layout.map_ticks = make_ticks(layout.map_axis, 5.0);
}

/// All x axes of a shared figure span the values of all panels.
void share_x_axes(const Figure& figure, std::vector<PanelLayout>& panels) {
  PlotAxis all = panels.front().frame.x;
  for (const PanelLayout& panel : panels) {
    all.low = std::min(all.low, panel.frame.x.low);
    all.high = std::max(all.high, panel.frame.x.high);
  }
  for (std::size_t i = 0; i < panels.size(); ++i) {
    if (!figure.panels[i].x_range) panels[i].frame.x = all;
  }
}

/// Rows that the legend takes above a plot of that width, when it shares the first row with the title.
int legend_rows(const Canvas& canvas, const Panel& panel, const PanelLayout& layout, float width, float scale) {
  float used = panel.title.empty() ? 0.0f : canvas.text_width(panel.title, k_panel_title_size * scale, true);
  int rows = 1;
  for (const LegendEntry& entry : layout.legend) {
    const float entry_width = legend_entry_width(canvas, entry, scale);
    if (used > 0.0f && used + entry_width > width) {
      ++rows;
      used = 0.0f;
    }
    used += entry_width;
  }
  return rows;
}

struct Grid {
  int columns, rows;
  explicit Grid(const Figure& figure)
      : columns(figure.share_x ? 1 : std::max(1, figure.columns)),
        rows((static_cast<int>(figure.panels.size()) + columns - 1) / columns) {}
};

/// Room above and below each row's plots, then the plots share what is left.
class Placing {
 public:
  Placing(const Canvas& canvas, const Figure& figure, FigureLayout& layout)
      : canvas_(canvas), figure_(figure), layout_(layout), grid_(figure), k_(layout.scale) {}

  void place() {
    const float top = (k_edge + (figure_.title.empty() ? 0.0f : k_title_height)) * k_;
    const float cell_width = (canvas_.size().x() - 0.5f * k_edge * k_) / static_cast<float>(grid_.columns);
    std::vector<float> above(rows(), 0.0f), below(rows(), 0.0f);
    for (std::size_t i = 0; i < layout_.panels.size(); ++i) {
      above[row(i)] = std::max(above[row(i)], header(i, cell_width - 70.0f * k_));
      below[row(i)] = std::max(below[row(i)], footer(i));
    }
    float margins = top + 0.4f * k_edge * k_;
    for (std::size_t r = 0; r < rows(); ++r) margins += above[r] + below[r];
    const float height = std::max(20.0f * k_, (canvas_.size().y() - margins) / static_cast<float>(rows()));
    float y = top;
    for (std::size_t r = 0; r < rows(); ++r) {
      y += above[r];
      for (std::size_t i = 0; i < layout_.panels.size(); ++i) {
        if (row(i) == r) place_panel(i, std::round(y), std::round(y + height), cell_width);
      }
      y += height + below[r];
    }
  }

 private:
  [[nodiscard]] std::size_t rows() const { return static_cast<std::size_t>(grid_.rows); }
  [[nodiscard]] std::size_t row(std::size_t i) const { return i / static_cast<std::size_t>(grid_.columns); }
  [[nodiscard]] std::size_t column(std::size_t i) const { return i % static_cast<std::size_t>(grid_.columns); }

  float header(std::size_t i, float width) const {
    const PanelLayout& panel = layout_.panels[i];
    const Panel& of = figure_.panels[i];
    float height = of.title.empty() ? k_header : k_header_titled;
    if (!panel.legend.empty() && !panel.legend_inside)
      height = k_header_titled + k_legend_row * static_cast<float>(legend_rows(canvas_, of, panel, width, k_) - 1);
    if (!panel.y_ticks.factor.empty()) height = std::max(height, 26.0f);
    return height * k_;
  }
  float footer(std::size_t i) const {
    if (!layout_.panels[i].x_labels) return k_shared_gap * k_;
    return (k_x_numbers + (figure_.panels[i].x_label.empty() ? 0.0f : k_x_name)) * k_;
  }
  /// Of all panels of a column, so that their plots stand under one another.
  float left_margin(std::size_t of_column) const {
    float margin = 0.0f;
    for (std::size_t i = 0; i < layout_.panels.size(); ++i) {
      if (column(i) != of_column) continue;
      float numbers = 0.0f;
      for (const Tick& tick : layout_.panels[i].y_ticks.major)
        numbers = std::max(numbers, canvas_.text_width(tick.label, k_tick_size * k_));
      const float name = figure_.panels[i].y_label.empty() ? 0.0f : k_y_name * k_;
      margin = std::max(margin, numbers + name + k_tick_gap * k_);
    }
    return margin + 0.7f * k_edge * k_;
  }
  /// Room right of the plots of a column: for the widest colour bar with its numbers and name.
  float right_margin(std::size_t of_column) const {
    float margin = k_right * k_;
    for (std::size_t i = 0; i < layout_.panels.size(); ++i)
      if (column(i) == of_column && figure_.panels[i].map)
        margin =
            std::max(margin, (k_map_gap + k_map_bar + k_tick_gap + k_y_name + 0.5f * k_edge) * k_ + map_numbers(i));
    return margin;
  }
  float map_numbers(std::size_t i) const {
    float width = 0.0f;
    for (const Tick& tick : layout_.panels[i].map_ticks.major)
      width = std::max(width, canvas_.text_width(tick.label, k_tick_size * k_));
    return width;
  }
  void place_bar(std::size_t i) {
    PanelLayout& panel = layout_.panels[i];
    const Box& plot = panel.frame.box;
    const float left = std::round(plot.right + k_map_gap * k_);
    panel.map_bar = {left, plot.top, std::round(left + k_map_bar * k_), plot.bottom};
    panel.map_ticks = make_ticks(panel.map_axis, std::max(3.0f, plot.height() / (38.0f * k_)));
    panel.map_label_center = panel.map_bar.right + k_tick_gap * k_ + map_numbers(i) + 0.5f * k_y_name * k_;
  }
  void place_panel(std::size_t i, float top, float bottom, float cell_width) {
    PanelLayout& panel = layout_.panels[i];
    const float start = cell_width * static_cast<float>(column(i));
    panel.frame.box = {std::round(start + left_margin(column(i))), top,
                       std::round(start + cell_width - right_margin(column(i))), bottom};
    panel.y_label_center = start + 0.7f * k_edge * k_ + 0.5f * k_label_size * k_;
    const float rows_above =
        panel.legend.empty() || panel.legend_inside
            ? 0.0f
            : static_cast<float>(legend_rows(canvas_, figure_.panels[i], panel, panel.frame.box.width(), k_) - 1);
    panel.title_baseline = top - (9.0f + rows_above * k_legend_row) * k_;
    panel.y_ticks = make_ticks(panel.frame.y, std::max(3.0f, (bottom - top) / (38.0f * k_)));
    panel.x_ticks = make_ticks(panel.frame.x, std::max(3.0f, panel.frame.box.width() / (84.0f * k_)));
    if (figure_.panels[i].map) place_bar(i);
  }

  const Canvas& canvas_;
  const Figure& figure_;
  FigureLayout& layout_;
  Grid grid_;
  float k_;
};

/// Whether a curve passes through the box, looked at every few pixels of its way.
bool crosses(const std::vector<Vector2f>& points, const Box& box, float step) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (box.contains(points[i])) return true;
    if (i == 0) continue;
    const Vector2f from = points[i - 1], along = points[i] - from;
    const int count = std::min(2000, static_cast<int>(along.norm() / step));
    for (int k = 1; k < count; ++k) {
      if (box.contains(from + along * (static_cast<float>(k) / static_cast<float>(count)))) return true;
    }
  }
  return false;
}

void find_obstacles(const Panel& panel, PanelLayout& layout, float scale) {
  layout.obstacles.clear();
  for (const Series& series : panel.series) {
    for (auto& piece : pixel_pieces(series.x, series.y, layout.frame, series.style == SeriesStyle::steps))
      layout.obstacles.push_back(std::move(piece));
  }
  for (const Band& band : panel.bands) {
    for (const auto* edge : {&band.low, &band.high}) {
      for (auto& piece : pixel_pieces(band.x, *edge, layout.frame)) layout.obstacles.push_back(std::move(piece));
    }
  }
  const Box& box = layout.frame.box;
  for (const Mark& mark : panel.marks) {  // its label stands at the top of a vertical line, at the right of another
    const Vector2f at = layout.frame.pixel(mark.vertical ? mark.at : layout.frame.x.high,
                                           mark.vertical ? layout.frame.y.high : mark.at);
    if (mark.vertical)
      layout.obstacles.push_back({at, {at.x(), box.bottom}, at, {at.x() + 120.0f * scale, at.y() + 14.0f * scale}});
    if (!mark.vertical) layout.obstacles.push_back({at, {box.left, at.y()}});
  }
}

/// Tries the corners; true when one is free of data.
bool place_legend_inside(const Canvas& canvas, PanelLayout& panel, float scale) {
  float width = 0.0f;
  for (const LegendEntry& entry : panel.legend) width = std::max(width, legend_entry_width(canvas, entry, scale));
  const float padding = k_legend_padding * scale, margin = k_legend_margin * scale;
  width += 2.0f * padding - 8.0f * scale;
  const float height = static_cast<float>(panel.legend.size()) * k_legend_row * scale + 2.0f * padding - 4.0f * scale;
  const Box& plot = panel.frame.box;
  // A map leaves no corner free.
  if (panel.map_bar.width() > 0.0f) return false;
  if (width > 0.6f * plot.width() || height > 0.75f * plot.height()) return false;
  const float right = std::round(plot.right - margin - width), bottom = std::round(plot.bottom - margin - height);
  const float left = std::round(plot.left + margin), top = std::round(plot.top + margin);
  for (const auto& [x, y] : {std::pair{right, top}, {left, top}, {right, bottom}, {left, bottom}}) {
    const Box box{x, y, x + std::round(width), y + std::round(height)};
    const float gap = 5.0f * scale;
    const Box around{box.left - gap, box.top - gap, box.right + gap, box.bottom + gap};
    const bool taken = std::any_of(panel.obstacles.begin(), panel.obstacles.end(),
                                   [&](const auto& curve) { return crosses(curve, around, 4.0f * scale); });
    if (taken) continue;
    panel.legend_box = box;
    return true;
  }
  return false;
}

}  // namespace

double half_bin(const Series& series) {
  return series.x.size() < 2 ? 0.5
                             : 0.5 * (series.x.back() - series.x.front()) / static_cast<double>(series.x.size() - 1);
}

Rgb series_color(const Panel& panel, std::size_t series, const std::vector<Rgb>& palette) {
  const Series& one = panel.series[series];
  return one.color.value_or(
      palette[static_cast<std::size_t>(one.hue.value_or(static_cast<int>(series))) % palette.size()]);
}

Rgb band_color(const Panel& panel, std::size_t band, const std::vector<Rgb>& palette) {
  const Band& one = panel.bands[band];
  return one.color.value_or(
      palette[static_cast<std::size_t>(one.hue.value_or(static_cast<int>(band))) % palette.size()]);
}

float legend_entry_width(const Canvas& canvas, const LegendEntry& entry, float scale) {
  return (k_legend_swatch + 8.0f + 16.0f) * scale + canvas.text_width(entry.name, k_tick_size * scale);
}

FigureLayout lay_out_figure(const Canvas& canvas, const Figure& figure, const std::vector<Rgb>& palette, float scale) {
  FigureLayout layout;
  layout.scale = scale;
  layout.title_baseline = (k_edge + k_title_size) * scale;
  layout.panels.resize(figure.panels.size());
  if (figure.panels.empty()) return layout;
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    PanelLayout& panel = layout.panels[i];
    panel.frame.x = x_axis(figure.panels[i]);
    panel.legend = legend_of(figure.panels[i], palette);
    if (figure.panels[i].map) measure_map(figure.panels[i], panel);
    panel.x_labels = !figure.share_x || i + 1 == figure.panels.size();
  }
  if (figure.share_x) share_x_axes(figure, layout.panels);
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    PanelLayout& panel = layout.panels[i];
    panel.frame.y = y_axis(figure.panels[i], panel.frame.x);
    panel.y_ticks = make_ticks(panel.frame.y, 6.0);
  }
  Placing placing(canvas, figure, layout);
  placing.place();
  placing.place();  // with the tick labels of the true heights
  bool moved = false;
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    find_obstacles(figure.panels[i], layout.panels[i], scale);
    layout.panels[i].legend_inside =
        layout.panels[i].legend.empty() || place_legend_inside(canvas, layout.panels[i], scale);
    moved = moved || !layout.panels[i].legend_inside;
  }
  if (!moved) return layout;
  placing.place();  // some legends stand above their plots
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    PanelLayout& panel = layout.panels[i];
    find_obstacles(figure.panels[i], panel, scale);
    if (panel.legend_inside && !panel.legend.empty()) (void)place_legend_inside(canvas, panel, scale);
  }
  return layout;
}

}  // namespace grouser
