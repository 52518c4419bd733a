#pragma once
#include <vector>

#include "render/canvas.h"

namespace grouser {

/// Colours of a figure.
struct PlotTheme {
  Color page, ink, muted, grid, minor_grid, axis, zero, mark, legend_border;
  std::vector<Rgb> palette;  ///< of the series, by order
};

[[nodiscard]] const PlotTheme& plot_theme(Theme theme);

}  // namespace grouser
