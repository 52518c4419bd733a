#include "render/font.h"

#include <ft2build.h>
#include FT_FREETYPE_H

#include <array>
#include <cmath>
#include <stdexcept>

extern "C" const char font_regular_begin[], font_regular_end[], font_bold_begin[], font_bold_end[];

namespace grouser {

struct Font::Impl {
  FT_Library library = nullptr;
  std::array<FT_Face, 2> faces{};  ///< regular, bold

  ~Impl() { FT_Done_FreeType(library); }  // takes its faces along

  void open(std::size_t i, const char* begin, const char* end) {
    if (FT_New_Memory_Face(library, reinterpret_cast<const FT_Byte*>(begin), static_cast<FT_Long>(end - begin), 0,
                           &faces[i]) != 0)
      throw std::runtime_error("FreeType cannot read the embedded font");
  }
  [[nodiscard]] FT_GlyphSlot load(char32_t character, int pixels, bool bold, FT_Int32 flags) const {
    FT_Face face = faces[bold ? 1 : 0];
    FT_Set_Pixel_Sizes(face, 0, static_cast<FT_UInt>(pixels));
    if (FT_Load_Char(face, character, flags) != 0) throw std::runtime_error("FreeType cannot draw a character");
    return face->glyph;
  }
};

Font::Font() : impl_(std::make_unique<Impl>()) {
  if (FT_Init_FreeType(&impl_->library) != 0) throw std::runtime_error("FreeType does not start");
  impl_->open(0, font_regular_begin, font_regular_end);
  impl_->open(1, font_bold_begin, font_bold_end);
}

Font::~Font() = default;

GlyphBitmap Font::render(char32_t character, int pixels, bool bold) const {
  const FT_GlyphSlot slot = impl_->load(character, pixels, bold, FT_LOAD_RENDER | FT_LOAD_TARGET_LIGHT);
  const FT_Bitmap& bitmap = slot->bitmap;
  GlyphBitmap glyph{
      static_cast<int>(bitmap.width), static_cast<int>(bitmap.rows), slot->bitmap_left, slot->bitmap_top, 0.0f, {}};
  glyph.advance = static_cast<float>(static_cast<double>(slot->linearHoriAdvance) / 65536.0);
  for (int row = 0; row < glyph.height; ++row) {
    const unsigned char* from = bitmap.buffer + static_cast<std::ptrdiff_t>(row) * bitmap.pitch;
    glyph.coverage.insert(glyph.coverage.end(), from, from + glyph.width);
  }
  return glyph;
}

float Font::advance(char32_t character, int pixels, bool bold) const {
  const FT_GlyphSlot slot = impl_->load(character, pixels, bold, FT_LOAD_TARGET_LIGHT);
  return static_cast<float>(static_cast<double>(slot->linearHoriAdvance) / 65536.0);
}

namespace {

/// Code points of well-formed UTF-8; a broken byte becomes U+FFFD.
std::u32string decode_utf8(const std::string& text) {
  std::u32string decoded;
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const std::size_t length = lead < 0x80 ? 1 : lead >> 5 == 6 ? 2 : lead >> 4 == 14 ? 3 : lead >> 3 == 30 ? 4 : 0;
    if (length == 0 || i + length > text.size()) {
      decoded += U'\uFFFD';
      ++i;
      continue;
    }
    auto point = static_cast<char32_t>(length == 1 ? lead : lead & (0xFF >> (length + 1)));
    for (std::size_t k = 1; k < length; ++k) point = point << 6 | (static_cast<unsigned char>(text[i + k]) & 0x3F);
    decoded += point;
    i += length;
  }
  return decoded;
}

}  // namespace

TextLayout lay_out(const Font& font, const std::string& text, float size, bool bold) {
  const std::u32string decoded = decode_utf8(text);
  const auto pixels = [](float points) { return static_cast<int>(std::lround(points)); };
  TextLayout layout;
  int current = pixels(size);
  float shift = 0.0f;
  bool inside = false;
  for (std::size_t i = 0; i < decoded.size(); ++i) {
    const char32_t c = decoded[i];
    if ((c == U'_' || c == U'^') && i + 1 < decoded.size() && decoded[i + 1] == U'{') {
      current = pixels(0.72f * size);
      shift = c == U'_' ? 0.22f * size : -0.36f * size;
      inside = true;
      ++i;
      continue;
    }
    if (inside && c == U'}') {
      current = pixels(size);
      shift = 0.0f;
      inside = false;
      continue;
    }
    layout.glyphs.push_back({c, current, layout.width, shift});
    layout.width += font.advance(c, current, bold);
  }
  return layout;
}

}  // namespace grouser
