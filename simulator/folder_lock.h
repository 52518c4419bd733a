#pragma once
#include <filesystem>

namespace grouser {

/// Keeps a second process from writing into a run's folder. The system takes it back when the process ends, however it
/// ends. Throws FileError when another process holds it.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_ = -1;
};

}  // namespace grouser
