#pragma once
#include <Eigen/Core>
#include <span>
#include <string>

#include "render/figure.h"

/// What a figure is drawn on: device pixels, origin at the top left, y down. Tests record the calls.
namespace grouser {

using Eigen::Vector2f;
using Eigen::Vector3f;

struct Color {
  Rgb rgb{};  ///< sRGB
  float alpha = 1.0f;
};

struct Box {
  float left = 0.0f, top = 0.0f, right = 0.0f, bottom = 0.0f;
  [[nodiscard]] float width() const { return right - left; }
  [[nodiscard]] float height() const { return bottom - top; }
  [[nodiscard]] bool contains(const Vector2f& p) const {
    return p.x() >= left && p.x() <= right && p.y() >= top && p.y() <= bottom;
  }
};

struct Dash {
  float drawn = 0.0f, period = 0.0f;  ///< pixels; period 0 = solid
};

enum class TextAlign { left, center, right };

struct TextStyle {
  float size = 12.0f;  ///< pixels
  Color color;
  TextAlign align = TextAlign::left;
  bool bold = false;
  bool upwards = false;  ///< runs up the page
};

class Canvas {
 public:
  virtual ~Canvas() = default;
  [[nodiscard]] virtual Vector2f size() const = 0;
  virtual void fill(const Box& box, const Color& color) = 0;
  /// A polyline with round joins; overlaps of a translucent line with itself are not darker.
  virtual void line(std::span<const Vector2f> points, float width, const Color& color, const Dash& dash = {}) = 0;
  virtual void dots(std::span<const Vector2f> points, float diameter, const Color& color) = 0;
  /// The area between two curves, each point (x, upper y, lower y), x not falling.
  virtual void band(std::span<const Vector3f> points, const Color& color) = 0;
  /// A picture stretched over a box, each of its pixels a plain rectangle.
  virtual void image(const Box& box, const Image& picture) = 0;
  /// Restricts drawing to a box of whole pixels.
  virtual void clip(const Box& box) = 0;
  virtual void unclip() = 0;
  /// UTF-8 with `_{..}` and `^{..}`; `at` is on the base line.
  virtual void text(const Vector2f& at, const std::string& text, const TextStyle& style) = 0;
  [[nodiscard]] virtual float text_width(const std::string& text, float size, bool bold = false) const = 0;
};

}  // namespace grouser
