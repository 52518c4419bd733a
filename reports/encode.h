#pragma once
#include <cstddef>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>

#include "render/base64.h"

/// How binary and structured data travel inside one HTML file.
namespace grouser {

/// One gzip member, best compression, no clock time in the header: the same input gives the same bytes.
[[nodiscard]] std::string gzip(std::string_view bytes);
/// The values' bytes, gzip, base64: undone in the page by DecompressionStream("gzip").
template <typename T>
[[nodiscard]] std::string packed(std::span<const T> values) {
  return base64(gzip({reinterpret_cast<const char*>(values.data()), values.size_bytes()}));
}
/// JSON that is safe inside <script>: no "</", no "<!--".
[[nodiscard]] std::string script_json(const nlohmann::json& value);

}  // namespace grouser
