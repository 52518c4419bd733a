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

}  // namespace

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
  // Where nothing bears the name, or the file system knows no exchange, a plain rename; the latter wants an empty name.
  if (::renameat2(AT_FDCWD, made.c_str(), AT_FDCWD, folder.c_str(), RENAME_EXCHANGE) == 0) {
    sync_folder_of(folder);
    fs::remove_all(made);
    return;
  }
  fs::remove_all(folder);
  if (::rename(made.c_str(), folder.c_str()) != 0) fail_file("write", folder);
  sync_folder_of(folder);
}

}  // namespace grouser
