#include "render/film_store.h"

#include <fmt/format.h>

#include <fstream>
#include <system_error>

#include "model/errors.h"
#include "model/provenance.h"

namespace grouser {

namespace fs = std::filesystem;

FilmStore::FilmStore(fs::path folder, std::string digest) : folder_(std::move(folder)), digest_(std::move(digest)) {
  std::error_code error;
  fs::create_directory(folder_, error);
  if (error) throw FileError("cannot write into " + folder_.string() + ": " + error.message());
  std::ifstream known(mark());
  std::string of;
  int count = 0;
  if (known >> of >> count && of == digest_) done_ = count;
  while (done_ > 0 && !fs::exists(file_of(done_ - 1))) --done_;
}

fs::path FilmStore::file_of(int stretch) const { return folder_ / fmt::format("stretch_{:04}.mp4", stretch); }

void FilmStore::add() {
  ++done_;
  write_whole(mark(), fmt::format("{} {}\n", digest_, done_));
}

std::vector<fs::path> FilmStore::stretches() const {
  std::vector<fs::path> files;
  for (int stretch = 0; stretch < done_; ++stretch) files.push_back(file_of(stretch));
  return files;
}

void FilmStore::remove() {
  std::error_code ignored;
  for (int stretch = 0; stretch <= done_; ++stretch) fs::remove(file_of(stretch), ignored);
  fs::remove(mark(), ignored);
  fs::remove(folder_, ignored);
  done_ = 0;
}

}  // namespace grouser
