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

 private:
  Descriptor descriptor_;
};

}  // namespace grouser
