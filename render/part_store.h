#pragma once
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "model/folder_lock.h"

namespace grouser {

/// What the numbered files of a whole are called: frame_000000.png with the mark .frames.
struct PartNames {
  const char* stem;
  int digits;
  const char* extension;
  const char* mark;
  const char* whole;  ///< "film", for messages
};

/// Numbered files of a folder, made one after the other, that are one whole: pictures of a film, or stretches of it. A
/// file beside them, the mark, says of which digest they are and how many are whole, so that a process that was stopped
/// or killed is gone on with; with another digest they are begun anew. Only one process at a time has them.
class PartStore {
 public:
  /// Makes the folder, not its parents. `count`: parts of the whole. Throws FileError, also when another process has
  /// it.
  PartStore(std::filesystem::path folder, PartNames names, std::string digest, int count);

  /// Parts from the first on that are whole.
  [[nodiscard]] int done() const { return done_; }
  /// Where the next part is to be written; add() when it is whole and on the disk.
  [[nodiscard]] std::filesystem::path next() const { return file_of(done_); }
  void add();
  [[nodiscard]] std::vector<std::filesystem::path> files() const;
  /// Takes away the parts behind the last, which an earlier whole left that was longer. Throws FileError.
  void cut() const;
  /// Takes away the parts, the mark, and the folder if nothing else stands in it.
  void remove();

 private:
  [[nodiscard]] std::filesystem::path file_of(int part) const;
  void write_mark() const;
  [[nodiscard]] std::vector<std::filesystem::path> parts_from(int first, std::error_code& error) const;

  std::filesystem::path folder_;
  PartNames names_;
  FolderLock lock_;
  std::string digest_;
  int count_;
  int done_ = 0;
};

}  // namespace grouser
