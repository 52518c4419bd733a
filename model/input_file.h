#pragma once
#include <filesystem>
#include <fstream>

namespace grouser {

/// Throws FileError for a folder and for what is no file that ends: a pipe would wait for its writer, a device may
/// never stop. What is not there is left to the call that opens it, which knows the reason.
void require_plain_file(const std::filesystem::path& file);

/// Opens a plain file for reading; throws FileError with the reason.
[[nodiscard]] std::ifstream open_input(const std::filesystem::path& file);

/// Throws FileError when a read failed: what came before it is no whole file, and nothing may be said of its content.
void require_sound(const std::ifstream& stream, const std::filesystem::path& file);

}  // namespace grouser
