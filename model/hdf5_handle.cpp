#include "model/hdf5_handle.h"

#include <fcntl.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "model/descriptor.h"

namespace grouser {
namespace {

using Reason = std::array<char, 256>;

/// "No space left on device" out of "file write failed: ..., errno = 28, error message = 'No space left on device',
/// ...". Nothing is allocated: HDF5 calls it with its lock held, which an exception would leave locked.
herr_t take_reason(unsigned, const H5E_error2_t* error, void* reason) {
  constexpr std::string_view k_key = "error message = '";
  const std::string_view text = error->desc != nullptr ? error->desc : "";
  const std::size_t found = text.find(k_key);
  if (found == std::string_view::npos) return 0;
  std::string_view words = text.substr(found + k_key.size());
  words = words.substr(0, std::min(words.find('\''), Reason().size() - 1));
  *std::copy(words.begin(), words.end(), static_cast<Reason*>(reason)->begin()) = '\0';
  return 0;
}

}  // namespace

std::string why_not_opened(const std::filesystem::path& file, const std::string& otherwise) {
  const Descriptor opened(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  return opened.number() < 0 ? std::strerror(errno) : otherwise;
}

void fail_hdf5(const std::string& action, const std::filesystem::path& file) {
  Reason reason = {};
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take_reason, &reason);
  throw FileError("cannot " + action + " in " + file.string() + (reason[0] == '\0' ? "" : ": ") + reason.data());
}

}  // namespace grouser
