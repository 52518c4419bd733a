#include "model/input_file.h"

#include <cerrno>
#include <cstring>

#include "model/errors.h"

namespace grouser {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& reason) {
  throw FileError("cannot read " + printable(file.string()) + ": " + reason);
}

}  // namespace

void require_plain_file(const std::filesystem::path& file) {
  std::error_code code;
  const std::filesystem::file_status status = std::filesystem::status(file, code);
  if (!std::filesystem::exists(status) || std::filesystem::is_regular_file(status)) return;
  if (std::filesystem::is_directory(status)) refuse(file, "is a folder");
  refuse(file, std::filesystem::is_fifo(status) ? "is a pipe, not a file" : "is a device, not a file");
}

std::ifstream open_input(const std::filesystem::path& file) {
  require_plain_file(file);
  std::ifstream stream(file, std::ios::binary);
  if (!stream) refuse(file, std::strerror(errno));
  return stream;
}

void require_sound(const std::ifstream& stream, const std::filesystem::path& file) {
  if (stream.bad()) refuse(file, std::strerror(EIO));
}

}  // namespace grouser
