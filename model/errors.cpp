#include "model/errors.h"

#include <algorithm>

#include "model/utf8.h"

namespace grouser {
namespace {

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
  constexpr std::size_t k_longest = 1000;
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
  std::string text = printable(file);
  if (!place.empty()) text += (place.front() == '/' ? "#" : ": ") + printable(place);
  text += ": expected " + printable(expected);
  if (!found.empty()) text += ", found " + printable(found);
  if (!hint.empty()) text += " (" + printable(hint) + ")";
  return text;
}

InputError::InputError(std::vector<InputFinding> findings)
    : std::runtime_error(text_of(findings)), findings_(std::move(findings)) {}

}  // namespace grouser
