#pragma once
#include <span>
#include <vector>

#include "render/canvas.h"
#include "render/plot_axis.h"

namespace grouser {

/// Where a panel's values lie on the page.
struct PlotFrame {
  Box box;
  PlotAxis x, y;
  [[nodiscard]] Vector2f pixel(double px, double py) const;
};

/// The pieces of a curve in pixels, parted where a value is not finite (or not positive on a logarithmic axis), with no
/// more points than the eye can tell apart:
///  - x never falling: first, lowest, highest and last point of each third of a pixel column (M4, in thirds because
///  lines
///    are antialiased: nearly the same pixels as all points);
///  - else: points nearer than 0.35 px to the last kept one go.
[[nodiscard]] std::vector<std::vector<Vector2f>> pixel_pieces(std::span<const double> x, std::span<const double> y,
                                                              const PlotFrame& frame, bool steps = false);

}  // namespace grouser
