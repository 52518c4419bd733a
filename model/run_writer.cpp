#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <numeric>

#include "model/hdf5_handle.h"
#include "model/hdf5_superblock.h"
#include "model/run.h"

namespace grouser {
namespace {

/// A chunk holds this many rows: wide rows (all links) few, narrow rows (one accepted step) many.
std::size_t rows_per_chunk(const ChannelTable& table) {
  constexpr std::size_t values_aimed_at = 1 << 17;
  return std::clamp<std::size_t>(values_aimed_at / std::max<std::size_t>(table.row_size(), 1), 16, 1024);
}

Hdf5Handle string_type() {
  Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.id(), H5T_VARIABLE);
  H5Tset_cset(type.id(), H5T_CSET_UTF8);
  return type;
}

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
  const Hdf5Handle type = string_type(), space(H5Screate(H5S_SCALAR), H5Sclose);
  const Hdf5Handle attribute(H5Acreate2(dataset, "unit", type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  const char* text = unit.c_str();
  H5Awrite(attribute.id(), type.id(), &text);
}

void write_names(hid_t file, const std::string& path, const std::vector<std::string>& names) {
  std::vector<const char*> texts(names.size());
  std::transform(names.begin(), names.end(), texts.begin(), [](const std::string& name) { return name.c_str(); });
  const hsize_t count = names.size();
  const Hdf5Handle type = string_type(), space(H5Screate_simple(1, &count, nullptr), H5Sclose);
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
  if (channel.single_precision) {  // contact forces: mostly zeros
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

/// A table with the rows that are not on the disk yet.
struct Pending {
  ChannelTable table;
  std::vector<Hdf5Handle> datasets;
  std::size_t row_size = 0, chunk_rows = 0;
  std::size_t rows_written = 0;
  std::vector<double> rows;
  std::vector<double> channel_rows;

  [[nodiscard]] std::size_t rows_pending() const { return row_size == 0 ? 0 : rows.size() / row_size; }
};

}  // namespace

std::size_t Channel::size() const {
  return std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
}

std::size_t ChannelTable::row_size() const {
  return std::accumulate(channels.begin(), channels.end(), std::size_t{0},
                         [](std::size_t sum, const Channel& channel) { return sum + channel.size(); });
}

struct RunWriter::Impl {
  std::filesystem::path path;
  Hdf5Handle file;
  std::vector<Pending> tables;

  void open(std::vector<ChannelTable> channel_tables, const std::map<std::string, std::vector<std::string>>& names);
  void write_channel(Pending& table, std::size_t channel_i, std::size_t offset);
  void write_pending(Pending& table);
  void copy_rows(Pending& table, const RunReader& from, std::size_t count);
  void append(Pending& table, std::span<const double> row);
  void flush();
};

void RunWriter::Impl::write_channel(Pending& table, std::size_t channel_i, std::size_t offset) {
  const Channel& channel = table.table.channels[channel_i];
  const std::size_t count = table.rows_pending(), size = channel.size();
  table.channel_rows.resize(count * size);
  for (std::size_t row = 0; row < count; ++row) {
    const auto from = table.rows.begin() + static_cast<std::ptrdiff_t>(row * table.row_size + offset);
    std::copy_n(from, size, table.channel_rows.begin() + static_cast<std::ptrdiff_t>(row * size));
  }
  const hid_t set = table.datasets[channel_i].id();
  const std::vector<hsize_t> total = with_rows(table.rows_written + count, channel), part = with_rows(count, channel);
  std::vector<hsize_t> start(part.size(), 0);
  start[0] = table.rows_written;
  const int rank = static_cast<int>(part.size());
  if (H5Dset_extent(set, total.data()) < 0) fail_hdf5("extend " + channel.path, path);
  const Hdf5Handle memory(H5Screate_simple(rank, part.data(), nullptr), H5Sclose), space(H5Dget_space(set), H5Sclose);
  H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start.data(), nullptr, part.data(), nullptr);
  if (H5Dwrite(set, H5T_NATIVE_DOUBLE, memory.id(), space.id(), H5P_DEFAULT, table.channel_rows.data()) < 0) {
    fail_hdf5("write " + channel.path, path);
  }
}

void RunWriter::Impl::write_pending(Pending& table) {
  const std::size_t count = table.rows_pending();
  if (count == 0) return;
  std::size_t offset = 0;
  for (std::size_t i = 0; i < table.table.channels.size(); ++i) {
    write_channel(table, i, offset);
    offset += table.table.channels[i].size();
  }
  table.rows_written += count;
  table.rows.clear();
}

void RunWriter::Impl::append(Pending& table, std::span<const double> row) {
  if (row.size() != table.row_size) throw std::invalid_argument("row size of table " + table.table.name);
  table.rows.insert(table.rows.end(), row.begin(), row.end());
  if (table.rows_pending() >= table.chunk_rows) write_pending(table);
}

void RunWriter::Impl::flush() {
  for (Pending& table : tables) write_pending(table);
  if (H5Fflush(file.id(), H5F_SCOPE_GLOBAL) < 0) fail_hdf5("flush", path);
  make_superblock_readable(path);
}

void RunWriter::Impl::open(std::vector<ChannelTable> channel_tables,
                           const std::map<std::string, std::vector<std::string>>& names) {
  file = create_file(path);
  for (ChannelTable& table : channel_tables) {
    Pending& pending = tables.emplace_back();
    pending.table = std::move(table);
    pending.row_size = pending.table.row_size();
    pending.chunk_rows = rows_per_chunk(pending.table);
    pending.rows.reserve(pending.row_size * pending.chunk_rows);
    for (const Channel& channel : pending.table.channels) {
      pending.datasets.push_back(
          checked(create_dataset(file.id(), channel, pending.chunk_rows), "create " + channel.path, path));
    }
  }
  for (const auto& [name, texts] : names) write_names(file.id(), name, texts);
  // From here on HDF5 orders its writes so that the file on the disk is always a valid one.
  if (H5Fstart_swmr_write(file.id()) < 0) fail_hdf5("start writing", path);
}

/// The first `count` rows of an earlier file, a chunk at a time. 32-bit values stay what they are.
void RunWriter::Impl::copy_rows(Pending& table, const RunReader& from, std::size_t count) {
  std::vector<Array> parts(table.table.channels.size());
  std::vector<double> row;
  for (std::size_t first = 0; first < count; first += table.chunk_rows) {
    const std::size_t rows = std::min(table.chunk_rows, count - first);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      parts[i] = from.read_rows(table.table.channels[i].path, first, rows);
    }
    for (std::size_t r = 0; r < rows; ++r) {
      row.clear();
      for (const Array& part : parts) row.insert(row.end(), part.row(r).begin(), part.row(r).end());
      append(table, row);
    }
  }
}

RunWriter::RunWriter(const std::filesystem::path& file, std::vector<ChannelTable> tables,
                     const std::map<std::string, std::vector<std::string>>& names,
                     const std::vector<std::size_t>& kept_rows)
    : impl_(std::make_unique<Impl>()) {
  silence_hdf5();
  if (kept_rows.empty()) {
    impl_->path = file;
    impl_->open(std::move(tables), names);
    return;
  }
  // Not cut to length in place: a kill while a file is cut would leave neither the old run nor the new one.
  impl_->path = file.string() + ".part";
  impl_->open(std::move(tables), names);
  const RunReader earlier(file);
  for (std::size_t i = 0; i < kept_rows.size(); ++i) impl_->copy_rows(impl_->tables.at(i), earlier, kept_rows[i]);
  static_cast<void>(sync());
  std::filesystem::rename(impl_->path, file);
  impl_->path = file;
}

RunWriter::~RunWriter() {
  try {
    close();
  } catch (const FileError&) {  // a destructor has nobody to tell; call close() to learn of a full disk
  }
}

void RunWriter::append(std::size_t table, std::span<const double> row) { impl_->append(impl_->tables[table], row); }

void RunWriter::flush() { impl_->flush(); }

std::vector<std::size_t> RunWriter::sync() {
  impl_->flush();
  const int descriptor = ::open(impl_->path.c_str(), O_RDONLY);
  const bool synced = descriptor >= 0 && ::fsync(descriptor) == 0;
  if (descriptor >= 0) ::close(descriptor);
  if (!synced) fail_hdf5("sync", impl_->path);
  std::vector<std::size_t> rows;
  for (const Pending& table : impl_->tables) rows.push_back(table.rows_written);
  return rows;
}

void RunWriter::close() {
  if (!impl_ || !impl_->file) return;
  flush();
  impl_->tables.clear();
  impl_->file.reset();
}

}  // namespace grouser
