#pragma once
#include <map>
#include <tuple>

#include "render/canvas.h"
#include "render/font.h"
#include "render/gl_objects.h"

namespace grouser {

/// Canvas on an OpenGL context. Lines and bands are drawn as coverage into a one-channel texture (union by GL_MAX),
/// which one pass then blends in its colour onto the page; text comes from an atlas at its exact pixel size.
class GlCanvas : public Canvas {
 public:
  /// An own page, white. The context must outlive the canvas. Throws GlError.
  GlCanvas(const GlContext& context, int width, int height);
  /// Draws onto a framebuffer of that size, which must outlive the canvas.
  GlCanvas(const GlContext& context, int width, int height, const GlFramebuffer& page);

  [[nodiscard]] Vector2f size() const override;
  void fill(const Box& box, const Color& color) override;
  void line(std::span<const Vector2f> points, float width, const Color& color, const Dash& dash = {}) override;
  void dots(std::span<const Vector2f> points, float diameter, const Color& color) override;
  void band(std::span<const Vector3f> points, const Color& color) override;
  void image(const Box& box, const Image& picture) override;
  void clip(const Box& box) override;
  void unclip() override;
  void text(const Vector2f& at, const std::string& text, const TextStyle& style) override;
  [[nodiscard]] float text_width(const std::string& text, float size, bool bold = false) const override;

  /// Prepares GL for drawing; needed again after another renderer used the context.
  void begin();
  [[nodiscard]] Image read() const;

 private:
  struct Cell {
    GlyphBitmap glyph;  ///< without its pixels
    int x = 0, y = 0;   ///< in the atlas
  };
  struct Programs {
    GlProgram line, band, box, cover, glyph;
  };
  void draw_capsules(std::span<const Vector2f> points, float width, const Color& color, const Dash& dash, bool joined);
  void cover(const Box& reach, const Color& color, const GlProgram& program, GLsizei instances);
  void onto_page() const;
  void set_scissor(const Box& box) const;
  [[nodiscard]] const Cell& cell_of(char32_t character, int pixels, bool bold);

  const GlContext& context_;
  int width_, height_;
  Font font_;
  Programs programs_;
  GlTexture page_color_, coverage_color_, atlas_;
  GlFramebuffer own_page_, coverage_;
  const GlFramebuffer* page_;
  GlBuffer points_;
  GlVertexArray no_vertices_;
  Box clip_;
  std::map<std::tuple<char32_t, int, bool>, Cell> cells_;
  int atlas_x_ = 1, atlas_y_ = 1, atlas_row_ = 0;
};

}  // namespace grouser
