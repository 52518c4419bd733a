#pragma once
#include <vector>

#include "render/decimation.h"

namespace grouser {

struct LegendEntry {
  std::string name;
  Rgb color{};
  enum class Look { line, dashed, dots, band } look = Look::line;
  float width = 1.4f;  ///< CSS pixels
};

/// Where the parts of one panel lie, in device pixels.
struct PanelLayout {
  PlotFrame frame;
  Ticks x_ticks, y_ticks;
  bool x_labels = true;         ///< numbers and name of the x axis; only the lowest panel of a shared axis has them
  float y_label_center = 0.0f;  ///< x of the y axis' name
  float title_baseline = 0.0f;
  std::vector<LegendEntry> legend;  ///< empty: none
  bool legend_inside = true;        ///< in `legend_box`, where no data are; else in rows above the plot
  Box legend_box;
  std::vector<std::vector<Vector2f>> obstacles;  ///< curves as drawn
  PlotAxis map_axis;                             ///< values of a map, up its colour bar
  Ticks map_ticks;
  Box map_bar;                    ///< right of the plot
  float map_label_center = 0.0f;  ///< x of the values' name
};

struct FigureLayout {
  float scale = 1.0f;  ///< device pixels a CSS pixel
  float title_baseline = 0.0f;
  std::vector<PanelLayout> panels;
};

/// Type sizes, CSS pixels.
inline constexpr float k_tick_size = 11.5f, k_label_size = 12.5f, k_panel_title_size = 13.0f, k_title_size = 15.5f;
inline constexpr float k_legend_row = 18.0f, k_legend_swatch = 24.0f;

[[nodiscard]] FigureLayout lay_out_figure(const Canvas& canvas, const Figure& figure, const std::vector<Rgb>& palette,
                                          float scale);

/// Colour of each series: its own or the palette's, by order.
[[nodiscard]] Rgb series_color(const Panel& panel, std::size_t series, const std::vector<Rgb>& palette);
[[nodiscard]] Rgb band_color(const Panel& panel, std::size_t band, const std::vector<Rgb>& palette);

/// Half the width of a histogram's bins.
[[nodiscard]] double half_bin(const Series& series);

/// Width of one legend entry with its swatch [device pixels].
[[nodiscard]] float legend_entry_width(const Canvas& canvas, const LegendEntry& entry, float scale);

}  // namespace grouser
