#include "model/replace_file.h"

#include <fcntl.h>

#include <cstdio>
#include <system_error>

#include "model/descriptor.h"

namespace grouser {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& place, const std::string& why) {
  throw FileError("cannot write " + place.string() + ": " + why);
}

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

void require_own(const fs::path& place) {
  std::error_code unknown;
  const fs::file_status status = fs::symlink_status(place, unknown);
  if (fs::is_symlink(status)) refuse(place, "expected no symbolic link there, for it may lead elsewhere");
  refuse_device(place);
}

void require_own_file(const fs::path& file) {
  require_own(file);
  std::error_code unknown;
  if (fs::is_regular_file(file, unknown) && fs::hard_link_count(file, unknown) > 1)
    refuse(file, "expected no second name of that file (a hard link) elsewhere, for it would be written, too");
}

void refuse_device(const fs::path& file) {
  std::error_code unknown;
  if (fs::is_other(fs::symlink_status(file, unknown)))
    refuse(file, "expected a file there or nothing, found a pipe, a device or a socket");
}

void require_place_of_file(const fs::path& file) {
  refuse_device(file);
  std::error_code unknown;
  if (fs::is_directory(fs::symlink_status(file, unknown)))
    refuse(file, "expected a file there or nothing, found a folder");
}

void require_apart(const std::vector<fs::path>& made, const std::vector<fs::path>& read) {
  std::error_code absent;
  for (const fs::path& output : made)
    for (const fs::path& input : read)
      if (fs::equivalent(output, input, absent))
        refuse(output, "expected a name that no input has, found that of " + input.string());
}

void require_room(const fs::path& folder, std::uintmax_t bytes) {
  const Descriptor nameless(::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600));
  if (nameless.number() < 0) {
    if (errno == EOPNOTSUPP || errno == EISDIR || errno == EINVAL) return;
    fail_file("write in", folder);
  }
  const int refused = ::posix_fallocate(nameless.number(), 0, static_cast<off_t>(bytes));
  if (refused == 0 || refused == EOPNOTSUPP || refused == EINVAL) return;
  errno = refused;
  fail_file("write in", folder);
}

void sync_file(const fs::path& file) {
  const Descriptor opened(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  if (opened.number() < 0 || ::fsync(opened.number()) != 0) fail_file("write", file);
}

void replace_file(const fs::path& made, const fs::path& file) {
  refuse_device(file);
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
