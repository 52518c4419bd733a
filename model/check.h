#pragma once
#include <filesystem>
#include <string>

namespace grouser {

/// Reads any input file, its kind taken from `format` (a scenario with the vehicle and bushing it names, a rig with its
/// CSV files). Returns "ok" and what was read; throws InputError with every finding, FileError when it cannot be read.
[[nodiscard]] std::string check_file(const std::filesystem::path& file);

}  // namespace grouser
