#include "render/base64.h"

#include <cstdint>

namespace grouser {

std::string base64(std::string_view bytes) {
  static constexpr char k_alphabet[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  const auto byte = [&](std::size_t i) -> std::uint32_t {
    return i < bytes.size() ? static_cast<unsigned char>(bytes[i]) : 0u;
  };
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::uint32_t triple = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
    text += k_alphabet[triple >> 18 & 63];
    text += k_alphabet[triple >> 12 & 63];
    text += i + 1 < bytes.size() ? k_alphabet[triple >> 6 & 63] : '=';
    text += i + 2 < bytes.size() ? k_alphabet[triple & 63] : '=';
  }
  return text;
}

}  // namespace grouser
