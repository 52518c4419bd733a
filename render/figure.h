#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "render/image.h"

/// A plot as plain data, free of GL. draw() makes the picture on the OSMesa context.
namespace grouser {

using Rgb = std::array<float, 3>;  ///< sRGB, 0..1

/// `bars`: a histogram, y over the bin round each x; x evenly spaced.
enum class SeriesStyle { line, dashed, points, steps, bars };

struct Series {
  std::string name{};            ///< legend; empty = none
  std::vector<double> x{}, y{};  ///< same length; NaN breaks the line
  SeriesStyle style = SeriesStyle::line;
  float width = 1.4f;          ///< CSS pixels
  std::optional<Rgb> color{};  ///< default: the palette by order
  std::optional<int> hue{};    ///< entry of the palette to take instead of the one by order
  float opacity = 1.0f;        ///< of a line that others are to be seen on
};

/// Filled between low and high over x (interval bands).
struct Band {
  std::string name{};
  std::vector<double> x{}, low{}, high{};
  std::optional<Rgb> color{};
  std::optional<int> hue{};  ///< as of a series
};

/// Values over a grid of cells, shown by colour (tension over link number and time), with a bar that tells the colours.
struct HeatMap {
  std::size_t columns = 0, rows = 0;
  std::array<double, 2> x_span{}, y_span{};      ///< outer edges of the grid
  std::vector<double> values{};                  ///< row by row, the lowest y first; NaN = empty
  std::string label{};                           ///< of the values: "Tension [kN]"
  std::optional<std::array<double, 2>> range{};  ///< of the colours; default: of the values
  /// The colours' range.
  [[nodiscard]] std::array<double, 2> color_range() const;
};

/// A labelled vertical or horizontal line ("71.6 Hz link passing").
struct Mark {
  double at = 0.0;
  bool vertical = true;
  std::string label;
};

struct Panel {
  std::string title{};
  std::string x_label{}, y_label{};  ///< "Time t [s]"; markup _{..} and ^{..}
  std::vector<Series> series{};
  std::vector<Band> bands{};
  std::vector<Mark> marks{};
  std::optional<std::array<double, 2>> x_range{}, y_range{};
  bool log_x = false, log_y = false;
  bool zero_lines = false;  ///< draw x = 0 and y = 0
  std::optional<HeatMap> map{};
};

struct Figure {
  std::string name{};  ///< file and command name: "step_size"
  std::string title{};
  std::string caption{};        ///< one or two sentences for reports
  std::vector<Panel> panels{};  ///< stacked, sharing the x axis when share_x, else in a grid of `columns`
  bool share_x = false;
  int columns = 1;
  int width = 800, height = 400;  ///< CSS pixels of the whole figure
};

enum class Theme { light, dark };

/// Draws at `scale` device pixels a CSS pixel.
[[nodiscard]] Image draw(const Figure& figure, Theme theme = Theme::light, double scale = 2.0);

/// The same picture as an `<svg>` element for inside a page, in the page's own colours; `label` is its text
/// alternative.
[[nodiscard]] std::string draw_svg(const Figure& figure, const std::string& label);

/// The same as a file of its own.
[[nodiscard]] std::string svg_file(const Figure& figure, Theme theme = Theme::light);

}  // namespace grouser
