#include "model/replace_file.h"

#include <fcntl.h>

#include <cstdio>
#include <system_error>

#include "model/descriptor.h"

namespace grouser {
namespace {

namespace fs = std::filesystem;

/// A rename lasts once the folder is on the disk.
void sync_folder_of(const fs::path& file) {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  const Descriptor directory(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (directory.number() >= 0) ::fsync(directory.number());
}

/// Where no exchange can be had: a kill in between leaves the old folder beside, whole, and any error puts it back.
void replace_in_steps(const fs::path& made, const fs::path& folder) {
  const fs::path old = made.string() + ".old";
  const bool replaces = fs::exists(folder);
  if (replaces) fs::remove_all(old);  // what a killed process left
  if (replaces && ::rename(folder.c_str(), old.c_str()) != 0) fail_file("write", folder);
  if (::rename(made.c_str(), folder.c_str()) != 0) {
    const int why = errno;
    if (replaces) ::rename(old.c_str(), folder.c_str());
    errno = why;
    fail_file("write", folder);
  }
  sync_folder_of(folder);
  fs::remove_all(old);
}

}  // namespace

void refuse_link(const fs::path& place) {
  std::error_code unknown;
  if (!fs::is_symlink(fs::symlink_status(place, unknown))) return;
  throw FileError("cannot write " + place.string() + ": expected no symbolic link there, for it may lead elsewhere");
}

void sync_file(const fs::path& file) {
  const Descriptor opened(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  if (opened.number() < 0 || ::fsync(opened.number()) != 0) fail_file("write", file);
}

void replace_file(const fs::path& made, const fs::path& file) {
  sync_file(made);
  if (::rename(made.c_str(), file.c_str()) != 0) fail_file("write", file);
  sync_folder_of(file);
}

void replace_folder(const fs::path& made, const fs::path& folder) {
  if (::renameat2(AT_FDCWD, made.c_str(), AT_FDCWD, folder.c_str(), RENAME_EXCHANGE) == 0) {
    sync_folder_of(folder);
    fs::remove_all(made);
    return;
  }
  // Nothing bears the name, or the file system or the kernel knows no exchange; any other refusal is an error.
  if (errno != ENOENT && errno != EINVAL && errno != ENOSYS) fail_file("write", folder);
  replace_in_steps(made, folder);
}

}  // namespace grouser
