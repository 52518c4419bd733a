#include "model/run_file.h"

#include <algorithm>
#include <system_error>

#include "model/hdf5_superblock.h"
#include "model/replace_file.h"

namespace grouser {
namespace {

/// Creation options that leave the clock out of the file: the same run gives the same bytes.
Hdf5Handle without_times(hid_t kind) {
  Hdf5Handle list(H5Pcreate(kind), H5Pclose);
  H5Pset_obj_track_times(list.id(), false);
  return list;
}

/// Creates the groups above `path` that are not there yet.
void create_groups(hid_t file, const std::string& path) {
  const Hdf5Handle creation = without_times(H5P_GROUP_CREATE);
  for (std::size_t end = path.find('/', 1); end != std::string::npos; end = path.find('/', end + 1)) {
    const std::string group = path.substr(0, end);
    if (H5Lexists(file, group.c_str(), H5P_DEFAULT) > 0) continue;
    const Hdf5Handle created(H5Gcreate2(file, group.c_str(), H5P_DEFAULT, creation.id(), H5P_DEFAULT), H5Gclose);
  }
}

Hdf5Handle create_file(const std::filesystem::path& file) {
  const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_libver_bounds(access.id(), H5F_LIBVER_LATEST, H5F_LIBVER_LATEST);  // needed for single writer, many readers
  const Hdf5Handle creation = without_times(H5P_FILE_CREATE);
  return checked({H5Fcreate(file.c_str(), H5F_ACC_TRUNC, creation.id(), access.id()), H5Fclose}, "write", file);
}

void write_unit(hid_t dataset, const std::string& unit) {
  const Hdf5Handle type = text_in_memory(), space(H5Screate(H5S_SCALAR), H5Sclose);
  const Hdf5Handle attribute(H5Acreate2(dataset, "unit", type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  const char* text = unit.c_str();
  H5Awrite(attribute.id(), type.id(), &text);
}

void write_names(hid_t file, const std::string& path, const std::vector<std::string>& names) {
  std::vector<const char*> texts(names.size());
  std::transform(names.begin(), names.end(), texts.begin(), [](const std::string& name) { return name.c_str(); });
  const hsize_t count = names.size();
  const Hdf5Handle type = text_in_memory(), space(H5Screate_simple(1, &count, nullptr), H5Sclose);
  const Hdf5Handle creation = without_times(H5P_DATASET_CREATE);
  create_groups(file, path);
  const Hdf5Handle set(H5Dcreate2(file, path.c_str(), type.id(), space.id(), H5P_DEFAULT, creation.id(), H5P_DEFAULT),
                       H5Dclose);
  if (count > 0) H5Dwrite(set.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, texts.data());
  write_unit(set.id(), "");
}

std::vector<hsize_t> with_rows(std::size_t rows, const Channel& channel) {
  std::vector<hsize_t> shape{rows};
  shape.insert(shape.end(), channel.shape.begin(), channel.shape.end());
  return shape;
}

Hdf5Handle create_dataset(hid_t file, const Channel& channel, std::size_t chunk_rows) {
  const std::vector<hsize_t> none = with_rows(0, channel), chunk = with_rows(chunk_rows, channel);
  std::vector<hsize_t> limit = none;
  limit[0] = H5S_UNLIMITED;
  const int rank = static_cast<int>(none.size());
  const Hdf5Handle space(H5Screate_simple(rank, none.data(), limit.data()), H5Sclose);
  const Hdf5Handle creation = without_times(H5P_DATASET_CREATE);
  H5Pset_chunk(creation.id(), rank, chunk.data());
  if (channel.deflated) {
    H5Pset_shuffle(creation.id());
    H5Pset_deflate(creation.id(), 1);
  }
  const hid_t type = channel.single_precision ? H5T_IEEE_F32LE : H5T_IEEE_F64LE;
  create_groups(file, channel.path);
  Hdf5Handle set(H5Dcreate2(file, channel.path.c_str(), type, space.id(), H5P_DEFAULT, creation.id(), H5P_DEFAULT),
                 H5Dclose);
  if (set) write_unit(set.id(), channel.unit);
  return set;
}

}  // namespace

RunFile::RunFile(const std::filesystem::path& path, std::vector<ChannelTable> tables)
    : final_path_(path), path_(path.string() + ".part"), tables_(std::move(tables)) {
  silence_hdf5();
  require_own_file(path_);
  file_ = create_file(path_);
}

RunFile::RunFile(const std::filesystem::path& path, std::vector<ChannelTable> tables,
                 const std::map<std::string, std::vector<std::string>>& names)
    : RunFile(path, std::move(tables)) {  // from here on an error calls the destructor
  for (const ChannelTable& table : tables_) {
    std::vector<Hdf5Handle>& datasets = datasets_.emplace_back();
    for (const Channel& channel : table.channels) {
      datasets.push_back(
          checked(create_dataset(file_.id(), channel, table.rows_per_chunk()), "create " + channel.path, final_path_));
    }
  }
  for (const auto& [name, texts] : names) write_names(file_.id(), name, texts);
  // From here on HDF5 orders its writes so that the file on the disk is always a valid one.
  if (H5Fstart_swmr_write(file_.id()) < 0) fail_hdf5("start writing", final_path_);
}

void RunFile::write(std::size_t table, std::size_t first, std::span<const double> rows) {
  const ChannelTable& channels = tables_[table];
  const std::size_t row_size = channels.row_size();
  std::size_t column = 0;
  for (std::size_t i = 0; i < channels.channels.size(); ++i) {
    const Channel& channel = channels.channels[i];
    write_channel(table, i, first, rows.size() / row_size,
                  packer_.pack(channel, channels.rows_per_chunk(), rows, row_size, column));
    column += channel.size();
  }
}

void RunFile::write_channel(std::size_t table, std::size_t channel_i, std::size_t first, std::size_t count,
                            std::span<const unsigned char> chunk) {
  const Channel& channel = tables_[table].channels[channel_i];
  const hid_t set = datasets_[table][channel_i].id();
  const std::vector<hsize_t> total = with_rows(first + count, channel);
  if (H5Dset_extent(set, total.data()) < 0) fail_hdf5("extend " + channel.path, final_path_);
  std::vector<hsize_t> start(total.size(), 0);
  start[0] = first;
  constexpr std::uint32_t k_all_filters = 0;  // applied: a bit tells which was left out
  if (H5Dwrite_chunk(set, H5P_DEFAULT, k_all_filters, start.data(), chunk.size(), chunk.data()) < 0)
    fail_hdf5("write " + channel.path, final_path_);
}

void RunFile::flush() {
  if (H5Fflush(file_.id(), H5F_SCOPE_GLOBAL) < 0) fail_hdf5("flush", final_path_);
  make_superblock_readable(path_);
}

void RunFile::sync() {
  flush();
  sync_file(path_);
}

void RunFile::publish() {
  flush();
  replace_file(path_, final_path_);
  path_ = final_path_;
}

void RunFile::close() {
  sync();
  datasets_.clear();
  file_.reset();
}

RunFile::~RunFile() {
  // What is open still was not closed well. HDF5 keeps what it holds back of it until the process ends: closed, it
  // would write lengths of what did not reach the disk, or trip over its own lists where memory was out. What a refused
  // write leaves is what a kill would leave.
  for (std::vector<Hdf5Handle>& table : datasets_)
    for (Hdf5Handle& dataset : table) dataset.release();
  file_.release();
  if (path_ == final_path_) return;
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

}  // namespace grouser
