#pragma once
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <utility>

#include "model/errors.h"

namespace grouser {

/// File descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&&) = delete;
  [[nodiscard]] int number() const { return number_; }

 private:
  int number_;
};

/// Says what the system refused, by errno.
[[noreturn]] inline void fail_file(const std::string& action, const std::filesystem::path& file) {
  throw FileError("cannot " + action + " " + file.string() + ": " + std::strerror(errno));
}

}  // namespace grouser
