#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace grouser {

/// How a result came to be. No clock time: the same input gives the same bytes.
struct Provenance {
  struct Input {
    std::string role;    ///< "vehicle", "bushing", "rig data static_x_1.csv"
    std::string path;    ///< as named by the file or user that referred to it (never absolute unless given so)
    std::string sha256;  ///< of its bytes
  };
  std::string program = "grouser";
  std::string version;  ///< of this program
  std::string command;  ///< the command that repeats it, options included
  std::vector<Input> inputs;
  std::map<std::string, std::string> options;  ///< --set and the like
  std::vector<std::string> synthetic;          ///< notes on generated data ("rig data are synthetic, seed 20261122")
};

/// Program version ("0.1.0").
[[nodiscard]] std::string program_version();
/// SHA-256 of a file's bytes, lower-case hex. Throws FileError.
[[nodiscard]] std::string sha256_of_file(const std::filesystem::path& file);
[[nodiscard]] std::string sha256_of(std::string_view bytes);

/// Writes bytes to a temporary file beside `file`, syncs and renames: the old file or the new one, never half of it.
void write_whole(const std::filesystem::path& file, std::string_view bytes);
/// The largest file that is held as a whole; films are the largest.
inline constexpr std::uintmax_t k_most_whole_bytes = 1u << 30;
/// Whole content of a file; throws FileError, also where it is larger than that.
[[nodiscard]] std::string read_whole(const std::filesystem::path& file);

}  // namespace grouser
