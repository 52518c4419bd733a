#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

namespace grouser {

/// 8-bit BGR picture, row 0 at the top, rows packed.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> bgr;  ///< width * height * 3
};

/// PNG, whole or not at all. Throws FileError.
void write_png(const Image& image, const std::filesystem::path& file);
/// `level`: effort of the compression, 0..9.
[[nodiscard]] std::vector<std::uint8_t> encode_png(const Image& image, int level = 3);
/// WebP, for photographs in pages. `quality`: 1..100.
[[nodiscard]] std::vector<std::uint8_t> encode_webp(const Image& image, int quality);
[[nodiscard]] Image read_png(const std::filesystem::path& file);

}  // namespace grouser
