#include "model/hdf5_handle.h"

namespace grouser {
namespace {

/// "No space left on device" out of "file write failed: ..., errno = 28, error message = 'No space left on device',
/// ...".
herr_t take_reason(unsigned, const H5E_error2_t* error, void* reason) {
  const std::string text = error->desc != nullptr ? error->desc : "";
  const std::string key = "error message = '";
  const std::size_t found = text.find(key);
  if (found == std::string::npos) return 0;
  const std::size_t from = found + key.size();
  *static_cast<std::string*>(reason) = text.substr(from, text.find('\'', from) - from);
  return 0;
}

}  // namespace

void fail_hdf5(const std::string& action, const std::filesystem::path& file) {
  std::string reason;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take_reason, &reason);
  throw FileError("cannot " + action + " in " + file.string() + (reason.empty() ? "" : ": " + reason));
}

}  // namespace grouser
