#pragma once
#include <memory>
#include <utility>
#include <vector>

#include "render/canvas.h"
#include "render/font.h"

namespace grouser {

/// A canvas that keeps what was drawn on it.
class RecordingCanvas : public Canvas {
 public:
  RecordingCanvas(float width, float height) : size_(width, height) {}
  struct Line {
    std::vector<Vector2f> points;
    Color color;
    Dash dash;
  };
  struct Text {
    Vector2f at;
    std::string text;
    TextStyle style;
  };
  std::vector<Line> lines;
  std::vector<Text> texts;
  std::vector<std::vector<Vector3f>> bands;
  std::vector<Box> boxes;
  std::vector<std::pair<Box, Image>> images;

  [[nodiscard]] Vector2f size() const override { return size_; }
  void fill(const Box& box, const Color&) override { boxes.push_back(box); }
  void line(std::span<const Vector2f> points, float, const Color& color, const Dash& dash) override {
    lines.push_back({{points.begin(), points.end()}, color, dash});
  }
  void dots(std::span<const Vector2f>, float, const Color&) override {}
  void band(std::span<const Vector3f> points, const Color&) override {
    bands.emplace_back(points.begin(), points.end());
  }
  void image(const Box& box, const Image& picture) override { images.emplace_back(box, picture); }
  void clip(const Box&) override {}
  void unclip() override {}
  void text(const Vector2f& at, const std::string& text, const TextStyle& style) override {
    if (!text.empty()) texts.push_back({at, text, style});
  }
  [[nodiscard]] float text_width(const std::string& text, float size, bool bold) const override {
    return lay_out(*font_, text, size, bold).width;
  }
  [[nodiscard]] bool wrote(const std::string& text) const {
    for (const Text& each : texts) {
      if (each.text == text) return true;
    }
    return false;
  }
  /// Lines in one colour.
  [[nodiscard]] std::vector<Line> lines_of(const Rgb& color) const {
    std::vector<Line> found;
    for (const Line& each : lines) {
      if (each.color.rgb == color) found.push_back(each);
    }
    return found;
  }

 private:
  Vector2f size_;
  std::shared_ptr<const Font> font_ = std::make_shared<Font>();
};

}  // namespace grouser
