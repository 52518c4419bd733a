#include "render/part_store.h"

#include <fmt/format.h>

#include <fstream>
#include <system_error>

#include "model/errors.h"
#include "model/provenance.h"

namespace grouser {

namespace fs = std::filesystem;

PartStore::PartStore(fs::path folder, PartNames names, std::string digest)
    : folder_(std::move(folder)), names_(names), digest_(std::move(digest)) {
  std::error_code error;
  fs::create_directory(folder_, error);
  if (error) throw FileError("cannot write into " + folder_.string() + ": " + error.message());
  std::ifstream known(folder_ / names_.mark);
  std::string of;
  int count = 0;
  const bool ours = known >> of >> count && of == digest_;
  if (ours) done_ = count;
  while (done_ > 0 && !fs::exists(file_of(done_ - 1))) --done_;
  if (!ours) write_mark();  // before the first part takes the place of one of another whole
}

fs::path PartStore::file_of(int part) const {
  return folder_ / fmt::format("{}{:0{}}{}", names_.stem, part, names_.digits, names_.extension);
}

void PartStore::write_mark() const { write_whole(folder_ / names_.mark, fmt::format("{} {}\n", digest_, done_)); }

void PartStore::add() {
  ++done_;
  write_mark();
}

std::vector<fs::path> PartStore::files() const {
  std::vector<fs::path> files;
  for (int part = 0; part < done_; ++part) files.push_back(file_of(part));
  return files;
}

void PartStore::cut(int count) const {
  std::error_code ignored;
  while (fs::remove(file_of(count), ignored)) ++count;
}

void PartStore::remove() {
  cut(0);
  std::error_code ignored;
  fs::remove(folder_ / names_.mark, ignored);
  fs::remove(folder_, ignored);
  done_ = 0;
}

}  // namespace grouser
