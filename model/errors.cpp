#include "model/errors.h"

#include <algorithm>

namespace grouser {
namespace {

/// Bytes of the UTF-8 character at `at`; 0 where none begins there (Unicode 15, table 3-7).
std::size_t utf8_length(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return at + i < text.size() ? static_cast<unsigned char>(text[at + i]) : 0U; };
  const unsigned first = byte(0), second = byte(1);
  if (first < 0x80) return 1;
  if (first < 0xC2 || first > 0xF4 || (second & 0xC0) != 0x80) return 0;
  const bool overlong = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
  const bool beyond = (first == 0xED && second > 0x9F) || (first == 0xF4 && second > 0x8F);
  const std::size_t length = first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
  for (std::size_t i = 2; i < length; ++i)
    if ((byte(i) & 0xC0) != 0x80) return 0;
  return overlong || beyond ? 0 : length;
}

/// Characters that move a terminal's cursor or colour what follows: C0, DEL and C1.
bool is_control(std::string_view character) {
  const auto first = static_cast<unsigned char>(character[0]);
  return first < 0x20 || first == 0x7F || (first == 0xC2 && static_cast<unsigned char>(character[1]) < 0xA0);
}

std::string text_of(const std::vector<InputFinding>& findings) {
  std::string text;
  for (const InputFinding& finding : findings) {
    if (!text.empty()) text += '\n';
    text += finding.text();
  }
  return text;
}

}  // namespace

std::string printable(std::string_view text) {
  constexpr std::size_t k_longest = 2000;
  constexpr std::string_view k_digits = "0123456789abcdef";
  std::string printed;
  for (std::size_t at = 0; at < text.size();) {
    if (printed.size() > k_longest) return printed + "...";
    const std::size_t length = utf8_length(text, at);
    const std::string_view character = text.substr(at, std::max<std::size_t>(length, 1));
    if (length > 0 && !is_control(character)) {
      printed += character;
    } else {
      for (const char c : character) {
        const auto byte = static_cast<unsigned char>(c);
        printed.append("\\x").append(1, k_digits[byte >> 4]).append(1, k_digits[byte & 15]);
      }
    }
    at += character.size();
  }
  return printed;
}

std::string InputFinding::text() const {
  std::string text = file;
  if (!place.empty()) text += (place.front() == '/' ? "#" : ": ") + place;
  text += ": expected " + expected;
  if (!found.empty()) text += ", found " + found;
  if (!hint.empty()) text += " (" + hint + ")";
  return printable(text);
}

InputError::InputError(std::vector<InputFinding> findings)
    : std::runtime_error(text_of(findings)), findings_(std::move(findings)) {}

}  // namespace grouser
