#include <algorithm>
#include <mutex>
#include <numeric>
#include <optional>
#include <stdexcept>

#include "model/hdf5_survey.h"
#include "model/run_file.h"
#include "model/worker.h"

namespace grouser {

std::size_t Channel::size() const {
  return std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
}

std::size_t ChannelTable::row_size() const {
  return std::accumulate(channels.begin(), channels.end(), std::size_t{0},
                         [](std::size_t sum, const Channel& channel) { return sum + channel.size(); });
}

std::size_t ChannelTable::rows_per_chunk() const {
  constexpr std::size_t k_most_values = 1 << 20, k_most_rows = 1024;
  const std::size_t fitting =
      std::clamp<std::size_t>(k_most_values / std::max<std::size_t>(row_size(), 1), 1, k_most_rows);
  if (rate <= 0.0) return fitting;
  return std::clamp<std::size_t>(static_cast<std::size_t>(rate * k_chunk_time), 1, fitting);
}

/// Rows gather here and go to the disk on a thread of its own, which alone uses the file.
struct RunWriter::Impl {
  struct Table {
    std::size_t row_size = 0, chunk_rows = 0;
    std::size_t rows = 0;                    ///< appended
    std::vector<double> chunk;               ///< those of a chunk that is not full yet
    std::vector<std::vector<double>> spare;  ///< empty chunks; under `mutex`
  };

  Impl(const std::filesystem::path& path, const std::vector<ChannelTable>& channel_tables,
       const std::map<std::string, std::vector<std::string>>& names);
  /// A job that calls HDF5.
  void post(std::function<void()> job);
  void append(std::size_t table, std::span<const double> row);
  void write_chunk(std::size_t table);
  void write_begun_chunks();
  void copy_rows(const ChannelTable& table, std::size_t table_i, const RunReader& from, std::size_t count);

  RunFile file;
  std::vector<Table> tables;
  std::mutex mutex;
  bool published = false, closed = false;
  /// Jobs: a chunk of samples comes with three others, so the writer may be a chunk behind.
  static constexpr std::size_t k_most_waiting = 4;
  Worker worker{k_most_waiting};
};

RunWriter::Impl::Impl(const std::filesystem::path& path, const std::vector<ChannelTable>& channel_tables,
                      const std::map<std::string, std::vector<std::string>>& names)
    : file(path, channel_tables, names) {
  for (const ChannelTable& table : channel_tables) {
    Table& made = tables.emplace_back();
    made.row_size = table.row_size();
    made.chunk_rows = table.rows_per_chunk();
    // One to fill, one that is being written, the others waiting.
    made.spare.resize(k_most_waiting + 1);
    for (std::vector<double>& chunk : made.spare) chunk.reserve(made.row_size * made.chunk_rows);
    made.chunk.reserve(made.row_size * made.chunk_rows);
  }
  post([] { silence_hdf5(); });  // a setting of each thread
}

void RunWriter::Impl::post(std::function<void()> job) {
  worker.post([job = std::move(job)] {
    const std::lock_guard lock(hdf5_fork_mutex());
    job();
  });
}

void RunWriter::Impl::append(std::size_t table_i, std::span<const double> row) {
  Table& table = tables[table_i];
  if (row.size() != table.row_size) throw std::invalid_argument("row size of table " + std::to_string(table_i));
  table.chunk.insert(table.chunk.end(), row.begin(), row.end());
  ++table.rows;
  if (table.rows % table.chunk_rows == 0) write_chunk(table_i);
}

/// Hands the full chunk over and begins another.
void RunWriter::Impl::write_chunk(std::size_t table_i) {
  Table& table = tables[table_i];
  post([this, table_i, first = table.rows - table.chunk_rows, chunk = std::move(table.chunk)]() mutable {
    file.write(table_i, first, chunk);
    chunk.clear();
    const std::lock_guard lock(mutex);
    tables[table_i].spare.push_back(std::move(chunk));
  });
  const std::lock_guard lock(mutex);
  table.chunk = std::move(table.spare.back());
  table.spare.pop_back();
}

void RunWriter::Impl::write_begun_chunks() {
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const Table& table = tables[i];
    if (table.chunk.empty()) continue;
    const std::size_t first = table.rows - table.rows % table.chunk_rows;
    post([this, i, first, chunk = table.chunk] { file.write(i, first, chunk); });
  }
}

/// The first `count` rows of an earlier file, a chunk at a time. 32-bit values stay what they are.
void RunWriter::Impl::copy_rows(const ChannelTable& table, std::size_t table_i, const RunReader& from,
                                std::size_t count) {
  std::vector<Array> parts(table.channels.size());
  std::vector<double> row;
  const std::size_t chunk_rows = table.rows_per_chunk();
  for (std::size_t first = 0; first < count; first += chunk_rows) {
    const std::size_t rows = std::min(chunk_rows, count - first);
    for (std::size_t i = 0; i < parts.size(); ++i) parts[i] = from.read_rows(table.channels[i].path, first, rows);
    for (std::size_t r = 0; r < rows; ++r) {
      row.clear();
      for (const Array& part : parts) row.insert(row.end(), part.row(r).begin(), part.row(r).end());
      append(table_i, row);
    }
  }
}

RunWriter::RunWriter(const std::filesystem::path& file, const std::vector<ChannelTable>& tables,
                     const std::map<std::string, std::vector<std::string>>& names,
                     const std::vector<std::size_t>& kept_rows) {
  // An earlier file is not written over, nor cut to length in place: a kill meanwhile would leave neither the old run
  // nor the new one.
  std::optional<RunReader> earlier;
  if (!kept_rows.empty()) earlier.emplace(file);
  impl_ = std::make_unique<Impl>(file, tables, names);
  for (std::size_t i = 0; i < kept_rows.size(); ++i) impl_->copy_rows(tables.at(i), i, *earlier, kept_rows[i]);
}

RunWriter::~RunWriter() {
  try {
    if (impl_->published) close();
  } catch (...) {  // a destructor has nobody to tell; call close() to learn of a full disk or memory
  }
}

void RunWriter::append(std::size_t table, std::span<const double> row) { impl_->append(table, row); }

std::vector<std::size_t> RunWriter::rows() const {
  std::vector<std::size_t> rows;
  for (const Impl::Table& table : impl_->tables) rows.push_back(table.rows);
  return rows;
}

std::size_t RunWriter::chunks(std::size_t table) const {
  return impl_->tables[table].rows / impl_->tables[table].chunk_rows;
}

void RunWriter::publish() {
  impl_->published = true;
  impl_->write_begun_chunks();
  impl_->post([this] { impl_->file.publish(); });
  impl_->worker.finish();
}

void RunWriter::flush() {
  impl_->post([this] { impl_->file.flush(); });
}

void RunWriter::sync(std::function<void()> then) {
  impl_->write_begun_chunks();
  impl_->post([this] { impl_->file.sync(); });
  impl_->worker.post(std::move(then));
}

void RunWriter::close() {
  if (!impl_ || impl_->closed) return;
  impl_->closed = true;
  if (impl_->published) {
    impl_->write_begun_chunks();
  } else {
    publish();
  }
  impl_->post([this] { impl_->file.close(); });
  impl_->worker.finish();
}

}  // namespace grouser
