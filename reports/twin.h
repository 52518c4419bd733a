#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

/// The machine-readable twin of a page.
namespace grouser {

inline constexpr const char* k_report_format = "grouser.report/1";

/// Keys that start so hold what only the page needs (base64); the twin leaves them out.
inline constexpr const char* k_payload_prefix = "payload_";
/// Keys that hold what only the twin needs: the numbers that a figure shows as curves. The page leaves them out.
inline constexpr const char* k_data_key = "data";

/// The value without payloads, at every depth.
[[nodiscard]] nlohmann::json without_payloads(const nlohmann::json& value);
/// The twin of a page's facts as text: one member a line, lists of numbers on one line each.
[[nodiscard]] std::string twin_text(const nlohmann::json& facts);
/// What a twin says of itself: its members, lists and objects among them empty. Null for any other file. Throws
/// FileError where it cannot be read.
[[nodiscard]] nlohmann::json head_of_twin(const std::filesystem::path& file);

}  // namespace grouser
