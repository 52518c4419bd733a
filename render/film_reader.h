#pragma once
#include <filesystem>
#include <memory>

#include "model/errors.h"
#include "render/image.h"

namespace grouser {

/// A file that holds no film, or less than it should.
class DamagedFilm : public FileError {
 public:
  using FileError::FileError;
};

/// The frames of a film that FilmEncoder wrote, one after the other.
class FilmReader {
 public:
  /// Throws DamagedFilm where the file holds no film in H.264.
  explicit FilmReader(const std::filesystem::path& file);
  ~FilmReader();
  FilmReader(const FilmReader&) = delete;
  FilmReader& operator=(const FilmReader&) = delete;

  /// Goes on to the next frame; false after the last. Throws DamagedFilm where one cannot be read.
  bool next();
  /// s, of all frames.
  [[nodiscard]] double duration() const;
  /// The frame that next() went to.
  [[nodiscard]] Image frame() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace grouser
