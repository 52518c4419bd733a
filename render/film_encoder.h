#pragma once
#include <filesystem>
#include <memory>
#include <vector>

#include "render/image.h"

namespace grouser {

/// One stretch of an H.264 film (avc1 in MP4, ITU-R BT.709), encoded by x264 in one thread: the same frames give the
/// same bytes. Every stretch begins with a key frame and refers to nothing outside of itself, so that stretches can be
/// joined without encoding anything again.
class FilmEncoder {
 public:
  /// Width and height even. Throws FileError.
  FilmEncoder(const std::filesystem::path& file, int width, int height, double fps);
  ~FilmEncoder();
  FilmEncoder(const FilmEncoder&) = delete;
  FilmEncoder& operator=(const FilmEncoder&) = delete;

  void add(const Image& frame);
  /// Writes what is left; the file is whole after it.
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Puts stretches of one size and rate one after the other; `comment` stands as text in the file. Throws DamagedFilm
/// where a stretch cannot be read, another FileError where the file cannot be written.
void join_films(const std::vector<std::filesystem::path>& stretches, const std::filesystem::path& file,
                const std::string& comment);

}  // namespace grouser
