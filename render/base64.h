#pragma once
#include <string>
#include <string_view>

namespace grouser {

/// RFC 4648, with padding: how bytes travel inside HTML and SVG.
[[nodiscard]] std::string base64(std::string_view bytes);

}  // namespace grouser
