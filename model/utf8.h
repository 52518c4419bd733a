#pragma once
#include <cstddef>
#include <string>
#include <string_view>

namespace grouser {

/// Bytes of the UTF-8 character at `at`; 0 where none begins there (Unicode 15, table 3-7).
[[nodiscard]] std::size_t utf8_length(std::string_view text, std::size_t at);

[[nodiscard]] bool is_utf8(std::string_view text);

/// With U+FFFD in place of every byte that belongs to no character, as names of files may hold.
[[nodiscard]] std::string to_utf8(std::string_view text);

}  // namespace grouser
