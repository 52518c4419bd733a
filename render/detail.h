#pragma once
#include <algorithm>
#include <cmath>

namespace grouser {

/// How finely a part is modelled: so that no chord leaves its circle by more than 0.45 pixels, and nothing is there
/// that would be smaller than two.
struct Detail {
  enum Level { coarse, middle, fine };
  static constexpr float k_coarse = 140.0f;  ///< pixels a metre: a whole vehicle in a film
  static constexpr float k_middle = 320.0f;  ///< a whole vehicle in a still
  static constexpr float k_fine = 800.0f;    ///< a wheel that fills the picture

  float pixels_per_metre = k_middle;

  [[nodiscard]] static Level level_for(float pixels_per_metre) {
    if (pixels_per_metre <= k_coarse) return coarse;
    return pixels_per_metre <= k_middle ? middle : fine;
  }
  /// Chords of a circle of radius r [m]: r (1 - cos(pi / n)) = 0.45 pixels.
  [[nodiscard]] int segments(float radius) const {
    return std::clamp(static_cast<int>(std::ceil(3.1416f * std::sqrt(radius * pixels_per_metre / 0.9f))), 5, 96);
  }
  /// Whether something of `size` [m] is seen.
  [[nodiscard]] bool shows(float size) const { return size * pixels_per_metre >= 2.0f; }
};
inline constexpr std::size_t k_num_details = 3;

}  // namespace grouser
