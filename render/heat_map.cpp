#include "render/heat_map.h"

#include <algorithm>
#include <cmath>

#include "render/legend.h"

namespace grouser {
namespace {

void put(const Rgb& color, std::vector<std::uint8_t>& bgr) {
  for (const std::size_t channel : {2u, 1u, 0u})
    bgr.push_back(static_cast<std::uint8_t>(std::lround(255.0f * color[channel])));
}

}  // namespace

std::array<double, 2> HeatMap::color_range() const {
  if (range) return *range;
  double low = std::nan(""), high = std::nan("");
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    low = std::fmin(low, value);
    high = std::fmax(high, value);
  }
  if (!std::isfinite(low)) return {0.0, 1.0};
  return high > low ? std::array{low, high} : std::array{low - 0.5, low + 0.5};
}

std::vector<Rgb> map_colors() { return viridis(); }

Image map_picture(const HeatMap& map, const Rgb& empty) {
  const auto [low, high] = map.color_range();
  const ColorScale scale{map_colors(), low, high};
  Image picture{static_cast<int>(map.columns), static_cast<int>(map.rows), {}};
  picture.bgr.reserve(3 * map.columns * map.rows);
  for (std::size_t row = map.rows; row-- > 0;)
    for (std::size_t column = 0; column < map.columns; ++column) {
      const double value = map.values[row * map.columns + column];
      put(std::isfinite(value) ? scale.at(value) : empty, picture.bgr);
    }
  return picture;
}

Image color_bar() {
  constexpr int k_steps = 128;
  const ColorScale scale{map_colors(), 0.0, 1.0};
  Image picture{1, k_steps, {}};
  for (int i = 0; i < k_steps; ++i) put(scale.at(1.0 - (i + 0.5) / k_steps), picture.bgr);
  return picture;
}

}  // namespace grouser
