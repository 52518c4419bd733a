#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "model/findings.h"

namespace grouser {

/// Keys keep their order, so that the same content gives the same bytes.
using Json = nlohmann::ordered_json;

/// Strict JSON of a size that ours can have (32 MB, 64 levels, 10 000 keys an object): syntax errors with line and
/// column, and keys given twice, become findings (nlohmann alone keeps the last of two equal keys in silence). Null
/// when the syntax is wrong.
[[nodiscard]] Json parse_json(const std::string& text, Findings& findings);

/// "/left/track" + "pitch_mm"; escapes `~` and `/` as RFC 6901 asks.
[[nodiscard]] std::string pointer_to(const std::string& pointer, const std::string& key);

/// A value as it is shown in a finding, shortened.
[[nodiscard]] std::string shown(const Json& value);

/// Indented text, one line for an array of plain values; numbers shortest round-trip; ends with a newline.
[[nodiscard]] std::string json_text(const Json& value);

}  // namespace grouser
