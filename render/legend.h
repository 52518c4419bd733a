#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/canvas.h"

namespace grouser {

/// Colours for a range of values: a few of them, with straight lines in sRGB between.
struct ColorScale {
  std::vector<Rgb> stops;
  double low = 0.0, high = 1.0;
  /// Of a value; held at the ends.
  [[nodiscard]] Rgb at(double value) const;
};
/// "viridis" (S. van der Walt, N. Smith 2015, CC0): even steps to the eye, also to a colour-blind one.
[[nodiscard]] std::vector<Rgb> viridis();
/// Pale yellow to dark red, safe for the colour-blind ("YlOrRd", ColorBrewer, C. Brewer).
[[nodiscard]] std::vector<Rgb> yellow_to_red();

/// What the colours of a picture mean.
struct Legend {
  struct Key {
    Rgb color{};
    std::string text;
  };
  struct Bar {
    ColorScale scale;
    double unit = 1.0;  ///< of the numbers at the bar, in SI
  };
  std::string title;  ///< "Track tension [kN]"
  std::vector<Key> keys;
  std::optional<Bar> bar;
  std::string note;
};

/// On dark cards in the top left corner, legible before any picture. `unit`: pixels of 1/720 of the height.
void draw_legends(Canvas& canvas, std::span<const Legend> legends, float unit);

}  // namespace grouser
