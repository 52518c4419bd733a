#include "render/draw_figure.h"

#include <algorithm>
#include <cmath>

#include "model/errors.h"
#include "render/figure_layout.h"
#include "render/gl_canvas.h"
#include "render/heat_map.h"
#include "render/plot_theme.h"

namespace grouser {
namespace {

/// Middle of the pixel, where a line of odd width is crisp.
float snapped(float v) { return std::floor(v) + 0.5f; }

class FigurePainter {
 public:
  FigurePainter(Canvas& canvas, const Figure& figure, const PlotTheme& theme, float scale)
      : canvas_(canvas),
        figure_(figure),
        theme_(theme),
        k_(scale),
        hair_(std::max(1.0f, std::round(scale))),
        layout_(lay_out_figure(canvas, figure, theme.palette, scale)) {}

  void paint() {
    canvas_.fill({0.0f, 0.0f, canvas_.size().x(), canvas_.size().y()}, theme_.page);
    const float left = layout_.panels.empty() ? 14.0f * k_ : layout_.panels.front().frame.box.left;
    if (!figure_.title.empty())
      write({left, layout_.title_baseline}, figure_.title, k_title_size, theme_.ink, TextAlign::left, true);
    for (std::size_t i = 0; i < layout_.panels.size(); ++i) {
      const Panel& panel = figure_.panels[i];
      const PanelLayout& at = layout_.panels[i];
      grid(panel, at);
      canvas_.clip(at.frame.box);
      map(panel, at);
      mark_lines(panel, at);
      bands(panel, at);
      series(panel, at);
      canvas_.unclip();
      axes(panel, at);
      color_legend(panel, at);
      mark_labels(panel, at);
      legend(panel, at);
    }
  }

 private:
  void write(const Vector2f& at, const std::string& text, float size, const Color& color, TextAlign align,
             bool bold = false, bool upwards = false) {
    canvas_.text(at, text, {size * k_, color, align, bold, upwards});
  }
  void rule(const Vector2f& from, const Vector2f& to, const Color& color, const Dash& dash = {}) {
    const std::array<Vector2f, 2> points{Vector2f(snapped(from.x()), snapped(from.y())),
                                         Vector2f(snapped(to.x()), snapped(to.y()))};
    canvas_.line(points, hair_, color, dash);
  }
  float x_of(const PanelLayout& at, double value) const { return at.frame.pixel(value, at.frame.y.low).x(); }
  float y_of(const PanelLayout& at, double value) const { return at.frame.pixel(at.frame.x.low, value).y(); }

  void grid(const Panel& panel, const PanelLayout& at) {
    const Box& box = at.frame.box;
    const auto vertical = [&](double v, const Color& c) { rule({x_of(at, v), box.top}, {x_of(at, v), box.bottom}, c); };
    const auto level = [&](double v, const Color& c) { rule({box.left, y_of(at, v)}, {box.right, y_of(at, v)}, c); };
    for (const double value : at.x_ticks.minor) vertical(value, theme_.minor_grid);
    for (const double value : at.y_ticks.minor) level(value, theme_.minor_grid);
    for (const Tick& tick : at.x_ticks.major) vertical(tick.value, theme_.grid);
    for (const Tick& tick : at.y_ticks.major) level(tick.value, theme_.grid);
    const auto inside = [](const PlotAxis& axis) { return !axis.logarithmic && axis.low < 0.0 && axis.high > 0.0; };
    if (panel.zero_lines && inside(at.frame.x)) vertical(0.0, theme_.zero);
    if (panel.zero_lines && inside(at.frame.y)) level(0.0, theme_.zero);
  }

  void map(const Panel& panel, const PanelLayout& at) {
    if (!panel.map) return;
    const HeatMap& of = *panel.map;
    const Vector2f low = at.frame.pixel(of.x_span[0], of.y_span[0]), high = at.frame.pixel(of.x_span[1], of.y_span[1]);
    canvas_.image({low.x(), high.y(), high.x(), low.y()}, map_picture(of, theme_.page.rgb));
  }

  void color_legend(const Panel& panel, const PanelLayout& at) {
    if (!panel.map) return;
    const Box& bar = at.map_bar;
    canvas_.image(bar, color_bar());
    for (const Tick& tick : at.map_ticks.major) {
      const float y = bar.bottom - static_cast<float>(at.map_axis.share(tick.value)) * bar.height();
      rule({bar.right, y}, {bar.right + 4.0f * k_, y}, theme_.axis);
      write({bar.right + 7.0f * k_, y + 0.36f * k_tick_size * k_}, tick.label, k_tick_size, theme_.muted,
            TextAlign::left);
    }
    write({at.map_label_center + 0.36f * k_label_size * k_, 0.5f * (bar.top + bar.bottom)}, panel.map->label,
          k_label_size, theme_.ink, TextAlign::center, false, true);
    if (!at.map_ticks.factor.empty())
      write({bar.left, bar.top - 8.0f * k_}, at.map_ticks.factor, k_tick_size, theme_.muted, TextAlign::left);
  }

  /// Bins stand on y = 0, or on the foot of a logarithmic axis, and are outlined.
  void bars(const Series& one, const PanelLayout& at, const Color& color) {
    const float foot = at.frame.y.logarithmic ? at.frame.box.bottom : y_of(at, 0.0);
    const double half = half_bin(one);
    std::vector<Vector3f> area;
    std::vector<Vector2f> outline;
    for (std::size_t i = 0; i < one.x.size(); ++i) {
      const bool drawn = std::isfinite(one.y[i]) && (!at.frame.y.logarithmic || one.y[i] > 0.0);
      const float top = drawn ? y_of(at, one.y[i]) : foot;
      for (const double edge : {one.x[i] - half, one.x[i] + half}) {
        area.emplace_back(x_of(at, edge), std::min(top, foot), std::max(top, foot));
        outline.emplace_back(x_of(at, edge), top);
      }
    }
    canvas_.band(area, {color.rgb, 0.22f * color.alpha});
    canvas_.line(outline, one.width * k_, color);
  }

  void bands(const Panel& panel, const PanelLayout& at) {
    for (std::size_t i = 0; i < panel.bands.size(); ++i) {
      const Band& band = panel.bands[i];
      std::vector<Vector3f> points;
      const auto flush = [&] {
        canvas_.band(points, {band_color(panel, i, theme_.palette), 0.22f});
        points.clear();
      };
      for (std::size_t k = 0; k < band.x.size(); ++k) {
        const bool good = std::isfinite(band.x[k]) && std::isfinite(band.low[k]) && std::isfinite(band.high[k]);
        if (!good) {
          flush();
          continue;
        }
        const Vector2f low = at.frame.pixel(band.x[k], band.low[k]), high = at.frame.pixel(band.x[k], band.high[k]);
        points.emplace_back(low.x(), std::min(low.y(), high.y()), std::max(low.y(), high.y()));
      }
      flush();
    }
  }

  void series(const Panel& panel, const PanelLayout& at) {
    for (std::size_t i = 0; i < panel.series.size(); ++i) {
      const Series& one = panel.series[i];
      const Color color{series_color(panel, i, theme_.palette), one.opacity};
      const Dash dash = one.style == SeriesStyle::dashed ? Dash{6.0f * k_, 10.0f * k_} : Dash{};
      if (one.style == SeriesStyle::bars) {
        bars(one, at, color);
        continue;
      }
      for (const auto& piece : pixel_pieces(one.x, one.y, at.frame, one.style == SeriesStyle::steps)) {
        if (one.style == SeriesStyle::points || piece.size() == 1) {
          canvas_.dots(piece, std::max(1.0f, 2.6f * one.width) * k_, color);
        } else {
          canvas_.line(piece, one.width * k_, color, dash);
        }
      }
    }
  }

  void axes(const Panel& panel, const PanelLayout& at) {
    const Box& box = at.frame.box;
    rule({box.left, box.top}, {box.left, box.bottom}, theme_.axis);
    rule({box.left, box.bottom}, {box.right, box.bottom}, theme_.axis);
    for (const Tick& tick : at.y_ticks.major)
      write({box.left - 8.0f * k_, y_of(at, tick.value) + 0.36f * k_tick_size * k_}, tick.label, k_tick_size,
            theme_.muted, TextAlign::right);
    for (const Tick& tick : at.x_ticks.major) {
      const float x = x_of(at, tick.value);
      rule({x, box.bottom}, {x, box.bottom + 4.0f * k_}, theme_.axis);
      if (at.x_labels) write({x, box.bottom + 17.5f * k_}, tick.label, k_tick_size, theme_.muted, TextAlign::center);
    }
    if (at.x_labels)
      write({0.5f * (box.left + box.right), box.bottom + 37.0f * k_}, panel.x_label, k_label_size, theme_.ink,
            TextAlign::center);
    if (at.x_labels && !at.x_ticks.factor.empty())
      write({box.right, box.bottom + 37.0f * k_}, at.x_ticks.factor, k_tick_size, theme_.muted, TextAlign::right);
    name_y_axis(panel, at);
    write({box.left, at.title_baseline}, panel.title, k_panel_title_size, theme_.ink, TextAlign::left, true);
  }

  /// Small enough for the height of its plot, and a little beyond.
  void name_y_axis(const Panel& panel, const PanelLayout& at) {
    const Box& box = at.frame.box;
    const float room = box.height() + 16.0f * k_, width = canvas_.text_width(panel.y_label, k_label_size * k_);
    const float size = std::max(0.72f * k_label_size, k_label_size * std::min(1.0f, room / std::max(width, 1.0f)));
    write({at.y_label_center + 0.36f * size * k_, 0.5f * (box.top + box.bottom)}, panel.y_label, size, theme_.ink,
          TextAlign::center, false, true);
    if (!at.y_ticks.factor.empty())
      write({box.left - 8.0f * k_, box.top - 8.0f * k_}, at.y_ticks.factor, k_tick_size, theme_.muted,
            TextAlign::right);
  }

  static bool shown(const Mark& mark, const PanelLayout& at) {
    const double share = mark.vertical ? at.frame.x.share(mark.at) : at.frame.y.share(mark.at);
    return share >= 0.0 && share <= 1.0;
  }

  void mark_lines(const Panel& panel, const PanelLayout& at) {
    const Box& plot = at.frame.box;
    const Dash dash{4.0f * k_, 7.0f * k_};
    for (const Mark& mark : panel.marks) {
      if (!shown(mark, at)) continue;
      const float x = x_of(at, mark.at), y = y_of(at, mark.at);
      if (mark.vertical) rule({x, plot.top}, {x, plot.bottom}, theme_.mark, dash);
      if (!mark.vertical) rule({plot.left, y}, {plot.right, y}, theme_.mark, dash);
    }
  }

  /// Beside the upper end of a vertical line, above the right end of another; one below the other where they would
  /// meet.
  void mark_labels(const Panel& panel, const PanelLayout& at) {
    const Box& plot = at.frame.box;
    const float size = k_tick_size * k_, gap = 5.0f * k_, halo = 3.0f * k_;
    std::vector<Box> taken;
    for (const Mark& mark : panel.marks) {
      if (!shown(mark, at) || mark.label.empty()) continue;
      const float width = canvas_.text_width(mark.label, size);
      float x = plot.right - width - gap, base = y_of(at, mark.at) - gap;
      if (mark.vertical) {
        const float line = x_of(at, mark.at);
        x = line + gap + width < plot.right ? line + gap : line - gap - width;
        base = plot.top + size + 0.5f * gap;
      } else if (base - size < plot.top) {
        base += size + 2.0f * gap;
      }
      const auto around = [&](float y) { return Box{x - halo, y - size, x + width + halo, y + 0.3f * size}; };
      const auto meets = [&](const Box& a) {
        return std::any_of(taken.begin(), taken.end(), [&](const Box& b) {
          return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
        });
      };
      while (meets(around(base)) && base < plot.bottom) base += 1.35f * size;
      taken.push_back(around(base));
      canvas_.fill(around(base), {theme_.page.rgb, 0.8f});
      canvas_.text({x, base}, mark.label, {size, theme_.mark, TextAlign::left, false, false});
    }
  }

  void swatch(const LegendEntry& entry, const Vector2f& from) {
    const float to = from.x() + k_legend_swatch * k_;
    const Color color{entry.color};
    if (entry.look == LegendEntry::Look::band) {
      canvas_.fill({from.x(), std::round(from.y() - 5.0f * k_), to, std::round(from.y() + 5.0f * k_)},
                   {entry.color, 0.28f});
      return;
    }
    const std::array<Vector2f, 2> points{from, Vector2f(to, from.y())};
    if (entry.look == LegendEntry::Look::dots) {
      const std::array<Vector2f, 1> middle{0.5f * (points[0] + points[1])};
      canvas_.dots(middle, std::max(3.0f, 2.6f * entry.width) * k_, color);
      return;
    }
    const Dash dash = entry.look == LegendEntry::Look::dashed ? Dash{6.0f * k_, 9.0f * k_} : Dash{};
    canvas_.line(points, std::max(1.8f, entry.width) * k_, color, dash);
  }

  void entry_at(const LegendEntry& entry, float x, float middle) {
    swatch(entry, {x, snapped(middle)});
    canvas_.text({x + (k_legend_swatch + 8.0f) * k_, middle + 0.36f * k_tick_size * k_}, entry.name,
                 {k_tick_size * k_, theme_.ink, TextAlign::left, false, false});
  }

  void legend(const Panel& panel, const PanelLayout& at) {
    if (at.legend.empty()) return;
    if (at.legend_inside) {
      const Box& box = at.legend_box;
      canvas_.fill({box.left - hair_, box.top - hair_, box.right + hair_, box.bottom + hair_}, theme_.legend_border);
      canvas_.fill(box, theme_.page);
      float middle = box.top + (6.0f + 0.5f * k_legend_row) * k_;
      for (const LegendEntry& entry : at.legend) {
        entry_at(entry, box.left + 9.0f * k_, middle);
        middle += k_legend_row * k_;
      }
      return;
    }
    // Rows above the plot, beside the title while there is room; the same walk as legend_rows() in the layout.
    const Box& plot = at.frame.box;
    float used = panel.title.empty() ? 0.0f : canvas_.text_width(panel.title, k_panel_title_size * k_, true);
    if (used > 0.0f) used += 22.0f * k_;
    float middle = at.title_baseline - 0.36f * k_tick_size * k_;
    for (const LegendEntry& entry : at.legend) {
      const float width = legend_entry_width(canvas_, entry, k_);
      if (used > 0.0f && used + width > plot.width()) {
        used = 0.0f;
        middle += k_legend_row * k_;
      }
      entry_at(entry, plot.left + used, middle);
      used += width;
    }
  }

  Canvas& canvas_;
  const Figure& figure_;
  const PlotTheme& theme_;
  float k_, hair_;
  FigureLayout layout_;
};

void require_equal_lengths(const Figure& figure) {
  for (const Panel& panel : figure.panels) {
    for (const Series& series : panel.series) {
      if (series.x.size() != series.y.size())
        throw InputError({"", "figure " + figure.name + ", series " + series.name, "as many x as y",
                          std::to_string(series.x.size()) + " and " + std::to_string(series.y.size()), ""});
    }
    if (panel.map && panel.map->values.size() != panel.map->columns * panel.map->rows)
      throw InputError({"", "figure " + figure.name + ", map", "columns x rows values",
                        std::to_string(panel.map->values.size()), ""});
    for (const Band& band : panel.bands) {
      if (band.x.size() != band.low.size() || band.x.size() != band.high.size())
        throw InputError({"", "figure " + figure.name + ", band " + band.name, "as many edges as x",
                          std::to_string(band.low.size()) + ", " + std::to_string(band.high.size()) + " and " +
                              std::to_string(band.x.size()),
                          ""});
    }
  }
}

}  // namespace

void draw_on(Canvas& canvas, const Figure& figure, Theme theme, float scale) {
  require_equal_lengths(figure);
  FigurePainter(canvas, figure, plot_theme(theme), scale).paint();
}

Image draw(const Figure& figure, Theme theme, double scale) {
  const auto pixels = [scale](int css) { return static_cast<int>(std::lround(css * scale)); };
  const int width = pixels(figure.width), height = pixels(figure.height);
  if (width < 16 || height < 16 || width > 8192 || height > 8192)
    throw InputError({"", "figure " + figure.name, "16 to 8192 pixels along each side",
                      std::to_string(width) + " x " + std::to_string(height), ""});
  const GlContext context(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  GlCanvas canvas(context, width, height);
  draw_on(canvas, figure, theme, static_cast<float>(scale));
  return canvas.read();
}

}  // namespace grouser
