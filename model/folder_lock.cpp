#include "model/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>

namespace grouser {

FolderLock::FolderLock(const std::filesystem::path& folder, const std::string& what)
    : descriptor_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  // A file system without locks leaves the user to take care.
  if (descriptor_.number() < 0 || ::flock(descriptor_.number(), LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  throw FileError(folder.string() + ": another process is still writing this " + what);
}

}  // namespace grouser
