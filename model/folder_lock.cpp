#include "model/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>

#include "model/replace_file.h"

namespace grouser {

namespace {

Descriptor made_file(const std::filesystem::path& file) {
  require_own(file);
  constexpr mode_t k_for_all = 0666;  // less what the user's mask takes
  Descriptor descriptor(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, k_for_all));
  if (descriptor.number() < 0) fail_file("write", file);
  return descriptor;
}

}  // namespace

FolderLock::FolderLock(const std::filesystem::path& folder, const std::string& what)
    : FolderLock(Descriptor(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)), folder, what) {}

FolderLock::FolderLock(const std::filesystem::path& folder, const std::string& what, const std::string& name)
    : FolderLock(made_file(folder / name), folder, what) {}

FolderLock::FolderLock(Descriptor descriptor, const std::filesystem::path& folder, const std::string& what)
    : descriptor_(std::move(descriptor)) {
  // A file system without locks leaves the user to take care.
  if (descriptor_.number() < 0 || ::flock(descriptor_.number(), LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  throw FileError(folder.string() + ": another process is still writing this " + what);
}

}  // namespace grouser
