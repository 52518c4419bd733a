#include "render/part_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <system_error>

#include "model/errors.h"
#include "model/provenance.h"
#include "model/replace_file.h"

namespace grouser {

namespace fs = std::filesystem;

namespace {

fs::path made_folder(fs::path folder) {
  std::error_code error;
  fs::create_directory(folder, error);
  if (error) throw FileError("cannot write into " + folder.string() + ": " + error.message());
  return folder;
}

/// Not the folder's own lock: frames may stand in that of a run which is still being written.
std::string lock_name(const PartNames& names) { return std::string(names.mark) + ".lock"; }

/// A part in its place; not a link or a pipe that somebody put there.
bool is_whole(const fs::path& part) {
  std::error_code unknown;
  return fs::is_regular_file(fs::symlink_status(part, unknown));
}

}  // namespace

PartStore::PartStore(fs::path folder, PartNames names, std::string digest, int count)
    : folder_(made_folder(std::move(folder))),
      names_(names),
      lock_(folder_, names.whole, lock_name(names)),
      digest_(std::move(digest)),
      count_(count) {
  require_own(folder_ / names_.mark);
  std::ifstream known(folder_ / names_.mark);
  std::string of;
  int marked = 0;
  const bool ours = known >> of >> marked && of == digest_;
  while (ours && done_ < std::min(marked, count_) && is_whole(file_of(done_))) ++done_;
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

/// Of the folder, one by one: parts that were taken away before may have left a hole.
std::vector<fs::path> PartStore::parts_from(int first, std::error_code& error) const {
  std::vector<fs::path> parts;
  for (fs::directory_iterator entry(folder_, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string(), stem = names_.stem;
    if (!name.starts_with(stem)) continue;
    int part = 0;
    const bool numbered = std::from_chars(name.data() + stem.size(), name.data() + name.size(), part).ec == std::errc();
    if (numbered && part >= first && file_of(part).filename() == name) parts.push_back(entry->path());
  }
  return parts;
}

void PartStore::cut() const {
  std::error_code error;
  const std::vector<fs::path> parts = parts_from(count_, error);
  if (error) throw FileError("cannot read " + folder_.string() + ": " + error.message());
  for (const fs::path& part : parts) {
    fs::remove(part, error);
    if (error) throw FileError("cannot remove " + part.string() + ": " + error.message());
  }
}

void PartStore::remove() {
  std::error_code ignored;
  for (int part = 0; part < count_; ++part) fs::remove(file_of(part), ignored);  // also when the folder cannot be read
  for (const fs::path& part : parts_from(count_, ignored)) fs::remove(part, ignored);
  fs::remove(folder_ / names_.mark, ignored);
  fs::remove(folder_ / lock_name(names_), ignored);
  fs::remove(folder_, ignored);
  done_ = 0;
}

}  // namespace grouser
