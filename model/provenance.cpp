#include "model/provenance.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "model/errors.h"
#include "model/input_file.h"
#include "model/sha256.h"

namespace grouser {
namespace {

/// File descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int number() const { return number_; }

 private:
  int number_;
};

[[noreturn]] void fail(const std::string& action, const std::filesystem::path& file) {
  throw FileError("cannot " + action + " " + file.string() + ": " + std::strerror(errno));
}

void write_all(int descriptor, std::string_view bytes, const std::filesystem::path& file) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("write", file);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace

std::string program_version() { return GROUSER_VERSION; }

std::string sha256_of(std::string_view bytes) {
  Sha256 digest;
  digest.add(bytes);
  return digest.hex();
}

std::string sha256_of_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) fail("read", file);
  Sha256 digest;
  std::string block(1 << 20, '\0');
  while (stream.read(block.data(), static_cast<std::streamsize>(block.size())) || stream.gcount() > 0) {
    digest.add(std::string_view(block).substr(0, static_cast<std::size_t>(stream.gcount())));
  }
  if (stream.bad()) fail("read", file);
  return digest.hex();
}

void write_whole(const std::filesystem::path& file, std::string_view bytes) {
  const std::string temporary = file.string() + "." + std::to_string(::getpid()) + ".part";
  const Descriptor out(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666));
  if (out.number() < 0) fail("write", file);
  try {
    write_all(out.number(), bytes, file);
    if (::fsync(out.number()) != 0 || ::rename(temporary.c_str(), file.c_str()) != 0) fail("write", file);
  } catch (...) {
    ::unlink(temporary.c_str());
    throw;
  }
  // The rename itself lasts only once the folder is on the disk.
  const auto folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  const Descriptor directory(::open(folder.c_str(), O_RDONLY | O_DIRECTORY));
  if (directory.number() >= 0) ::fsync(directory.number());
}

constexpr std::uintmax_t k_most_bytes = 1u << 30;  // of a file that is held as a whole; films are the largest

std::string read_whole(const std::filesystem::path& file) {
  std::error_code code;
  require_plain_file(file);
  const std::uintmax_t size = std::filesystem::file_size(file, code);
  if (!code && size > k_most_bytes) throw FileError("cannot read " + file.string() + ": is larger than 1 GB");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) fail("read", file);
  std::ostringstream bytes;
  if (stream.peek() != std::ifstream::traits_type::eof()) bytes << stream.rdbuf();
  if (stream.bad()) fail("read", file);
  return std::move(bytes).str();
}

}  // namespace grouser
