#pragma once
#include <filesystem>
#include <string>

#include "tests/support/temporary_folder.h"

namespace grouser {

using test::TemporaryFolder;

/// A file of the repository's test_data/.
inline std::filesystem::path test_data(const std::string& name) {
  return std::filesystem::path(GROUSER_SOURCE_DIR) / "test_data" / name;
}

}  // namespace grouser
