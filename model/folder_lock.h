#pragma once
#include <filesystem>

#include "model/descriptor.h"

namespace grouser {

/// Keeps a second process from writing into a folder. The system takes it back when the process ends, however it ends.
/// A folder that is not there is nobody's, and gives no lock.
class FolderLock {
 public:
  /// what: of the folder, "run". Throws FileError when another process holds it.
  FolderLock(const std::filesystem::path& folder, const std::string& what);
  /// Of some files in a folder that others write into, too: by `name`, an empty file among them, made where it is not
  /// there. Throws FileError, also where it cannot be made.
  FolderLock(const std::filesystem::path& folder, const std::string& what, const std::string& name);

 private:
  FolderLock(Descriptor descriptor, const std::filesystem::path& folder, const std::string& what);
  Descriptor descriptor_;
};

}  // namespace grouser
