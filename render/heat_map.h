#pragma once
#include "render/figure.h"

/// A map's cells and the bar that tells its colours, as pictures.
namespace grouser {

/// One pixel a cell, the highest y at the top; cells without a value in `empty`.
[[nodiscard]] Image map_picture(const HeatMap& map, const Rgb& empty);
/// The colours from the highest value at the top to the lowest.
[[nodiscard]] Image color_bar();
/// sRGB of evenly spaced values from the lowest to the highest, straight lines between them.
[[nodiscard]] std::vector<Rgb> map_colors();

}  // namespace grouser
