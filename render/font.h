#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace grouser {

/// One rendered character.
struct GlyphBitmap {
  int width = 0, height = 0;           ///< pixels
  int left = 0, top = 0;               ///< of the bitmap's corner: right of the pen, above the base line
  float advance = 0.0f;                ///< pixels, unhinted
  std::vector<std::uint8_t> coverage;  ///< width * height, top row first
};

/// DejaVu Sans, regular and bold, embedded at build. FreeType is known to this class only.
class Font {
 public:
  Font();
  ~Font();
  Font(const Font&) = delete;
  Font& operator=(const Font&) = delete;
  /// A character that the font lacks is drawn as its box.
  [[nodiscard]] GlyphBitmap render(char32_t character, int pixels, bool bold) const;
  [[nodiscard]] float advance(char32_t character, int pixels, bool bold) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// One character of a marked-up text.
struct TextGlyph {
  char32_t character = 0;
  int pixels = 0;      ///< size
  float x = 0.0f;      ///< pen, from the text's start
  float shift = 0.0f;  ///< of the base line, downwards
};

/// Pens of a UTF-8 text with the markup `_{..}` (subscript) and `^{..}` (superscript), and its width.
struct TextLayout {
  std::vector<TextGlyph> glyphs;
  float width = 0.0f;
};
[[nodiscard]] TextLayout lay_out(const Font& font, const std::string& text, float size, bool bold);

}  // namespace grouser
