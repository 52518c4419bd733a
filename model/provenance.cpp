#include "model/provenance.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "model/descriptor.h"
#include "model/input_file.h"
#include "model/replace_file.h"
#include "model/sha256.h"

namespace grouser {
namespace {

void write_all(int descriptor, std::string_view bytes, const std::filesystem::path& file) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail_file("write", file);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

void require_short(std::uintmax_t bytes, const std::filesystem::path& file) {
  if (bytes > k_most_whole_bytes) throw FileError("cannot read " + file.string() + ": is larger than 1 GB");
}

/// Appends the next bytes; false at the end. By the system's own call: streams pass an error of the disk for the end.
bool read_block(int descriptor, const std::filesystem::path& file, std::string& bytes) {
  constexpr std::size_t k_block = 1 << 18;
  const std::size_t before = bytes.size();
  bytes.resize(before + k_block);
  ssize_t count = 0;
  do {
    count = ::read(descriptor, bytes.data() + before, k_block);
  } while (count < 0 && errno == EINTR);
  if (count < 0) fail_file("read", file);
  bytes.resize(before + static_cast<std::size_t>(count));
  return count > 0;
}

/// The file is still the one that bears the name.
bool bears(int descriptor, const std::filesystem::path& name) {
  struct stat own = {}, named = {};
  return ::fstat(descriptor, &own) == 0 && ::stat(name.c_str(), &named) == 0 && own.st_ino == named.st_ino &&
         own.st_dev == named.st_dev;
}

/// Waits for another process that writes the same, which takes no longer than its disk.
void lock(int descriptor, const std::filesystem::path& file) {
  constexpr std::chrono::milliseconds k_look_again{5}, k_longest{60'000};
  for (std::chrono::milliseconds waited{}; ::flock(descriptor, LOCK_EX | LOCK_NB) != 0; waited += k_look_again) {
    if (errno != EWOULDBLOCK && errno != EINTR) return;  // a file system without locks leaves the user to take care
    if (waited > k_longest) throw FileError("cannot write " + file.string() + ": another process holds it");
    std::this_thread::sleep_for(k_look_again);
  }
}

/// Always the same name, so that what a killed process left is written over. Of two processes one waits for the other,
/// whose rename takes the name away.
Descriptor open_part(const std::filesystem::path& part, const std::filesystem::path& file) {
  while (true) {
    require_own_file(part);
    // A pipe that comes there now is not waited for.
    Descriptor opened(::open(part.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666));
    if (opened.number() < 0) fail_file("write", file);
    lock(opened.number(), file);
    if (!bears(opened.number(), part)) continue;
    if (::ftruncate(opened.number(), 0) != 0) fail_file("write", file);
    return opened;
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
  if (!stream) fail_file("read", file);
  Sha256 digest;
  std::string block(1 << 20, '\0');
  while (stream.read(block.data(), static_cast<std::streamsize>(block.size())) || stream.gcount() > 0) {
    digest.add(std::string_view(block).substr(0, static_cast<std::size_t>(stream.gcount())));
  }
  if (stream.bad()) fail_file("read", file);
  return digest.hex();
}

void write_whole(const std::filesystem::path& file, std::string_view bytes) {
  const std::filesystem::path part = file.string() + ".part";
  const Descriptor out = open_part(part, file);
  try {
    write_all(out.number(), bytes, file);
    replace_file(part, file);
  } catch (...) {
    ::unlink(part.c_str());
    throw;
  }
}

std::string read_whole(const std::filesystem::path& file) {
  require_plain_file(file);
  std::error_code unknown;
  const std::uintmax_t size = std::filesystem::file_size(file, unknown);
  if (!unknown) require_short(size, file);
  const Descriptor in(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  if (in.number() < 0) fail_file("read", file);
  std::string bytes;
  while (read_block(in.number(), file, bytes)) {
    require_short(bytes.size(), file);  // it grew, or is one of the system's, whose size is said to be 0
  }
  return bytes;
}

}  // namespace grouser
