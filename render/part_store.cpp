#include "render/part_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <system_error>

#include "model/errors.h"
#include "model/provenance.h"

namespace grouser {

namespace fs = std::filesystem;

namespace {

fs::path made_folder(fs::path folder) {
  std::error_code error;
  fs::create_directory(folder, error);
  if (error) throw FileError("cannot write into " + folder.string() + ": " + error.message());
  return folder;
}

}  // namespace

PartStore::PartStore(fs::path folder, PartNames names, std::string digest, int count)
    : folder_(made_folder(std::move(folder))),
      names_(names),
      lock_(folder_, names.whole),
      digest_(std::move(digest)),
      count_(count) {
  std::ifstream known(folder_ / names_.mark);
  std::string of;
  int marked = 0;
  const bool ours = known >> of >> marked && of == digest_;
  while (ours && done_ < std::min(marked, count_) && fs::exists(file_of(done_))) ++done_;
  if (!ours || done_ != marked) write_mark();  // before half a part takes the place of one that the mark calls whole
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

void PartStore::remove_from(int part) const {
  std::error_code ignored;
  while (fs::remove(file_of(part), ignored)) ++part;
}

void PartStore::remove() {
  remove_from(0);
  std::error_code ignored;
  fs::remove(folder_ / names_.mark, ignored);
  fs::remove(folder_, ignored);
  done_ = 0;
}

}  // namespace grouser
