#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace grouser {

/// Encoded stretches of a film in a folder, one after the other, until the film is whole. A file beside them says of
/// which digest they are and how many are whole; with another digest they are begun anew.
class FilmStore {
 public:
  /// Makes the folder, not its parents. Throws FileError.
  FilmStore(std::filesystem::path folder, std::string digest);

  [[nodiscard]] int done() const { return done_; }
  /// Where the next stretch is to be written; add() when it is whole.
  [[nodiscard]] std::filesystem::path next() const { return file_of(done_); }
  void add();
  [[nodiscard]] std::vector<std::filesystem::path> stretches() const;
  /// The stretches and the folder, if nothing else stands in it.
  void remove();

 private:
  [[nodiscard]] std::filesystem::path file_of(int stretch) const;
  [[nodiscard]] std::filesystem::path mark() const { return folder_ / "done"; }

  std::filesystem::path folder_;
  std::string digest_;
  int done_ = 0;
};

}  // namespace grouser
