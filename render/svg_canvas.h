#pragma once
#include <string>

#include "render/canvas.h"
#include "render/font.h"

namespace grouser {

/// Canvas that writes scalable vector graphics for inside an HTML page. The colours of the plot themes are written as
/// the page's own (`var(--plot-ink)`, `var(--s1)`, ..., with the light theme's colour where the page has none), so that
/// one picture serves light, dark and paper.
class SvgCanvas : public Canvas {
 public:
  SvgCanvas(float width, float height) : size_(width, height) {}

  [[nodiscard]] Vector2f size() const override { return size_; }
  void fill(const Box& box, const Color& color) override;
  void line(std::span<const Vector2f> points, float width, const Color& color, const Dash& dash = {}) override;
  void dots(std::span<const Vector2f> points, float diameter, const Color& color) override;
  void band(std::span<const Vector3f> points, const Color& color) override;
  void image(const Box& box, const Image& picture) override;
  void clip(const Box& box) override;
  void unclip() override;
  void text(const Vector2f& at, const std::string& text, const TextStyle& style) override;
  [[nodiscard]] float text_width(const std::string& text, float size, bool bold = false) const override;

  /// The `<svg>` element with `label` as its text alternative; what is drawn later is not in it.
  [[nodiscard]] std::string element(const std::string& label) const;

 private:
  Vector2f size_;
  Font font_;
  std::string body_;
};

}  // namespace grouser
