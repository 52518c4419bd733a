#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace grouser {

/// What the numbered files of a whole are called: frame_000000.png with the mark .frames.
struct PartNames {
  const char* stem;
  int digits;
  const char* extension;
  const char* mark;
};

/// Numbered files of a folder, made one after the other, that are one whole: pictures of a film, or stretches of it. A
/// file beside them, the mark, says of which digest they are and how many are whole, so that a process that was stopped
/// or killed is gone on with; with another digest they are begun anew.
class PartStore {
 public:
  /// Makes the folder, not its parents. Throws FileError.
  PartStore(std::filesystem::path folder, PartNames names, std::string digest);

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] int done() const { return done_; }
  /// Where the next part is to be written; add() when it is whole and on the disk.
  [[nodiscard]] std::filesystem::path next() const { return file_of(done_); }
  void add();
  [[nodiscard]] std::vector<std::filesystem::path> files() const;
  /// Takes away the parts from number `count` on, which an earlier whole left that was longer.
  void cut(int count) const;
  /// Takes away the parts, the mark, and the folder if nothing else stands in it.
  void remove();

 private:
  [[nodiscard]] std::filesystem::path file_of(int part) const;
  void write_mark() const;

  std::filesystem::path folder_;
  PartNames names_;
  std::string digest_;
  int done_ = 0;
};

}  // namespace grouser
