#pragma once
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "model/chunk_packer.h"
#include "model/hdf5_handle.h"
#include "model/run.h"

namespace grouser {

/// run.h5 while it is written: a dataset for every channel, a chunk of rows at a time. Chunks go straight to the file,
/// past HDF5's own cache and filters. Until it is published it stands beside `path`. Every call throws FileError.
class RunFile {
 public:
  RunFile(const std::filesystem::path& path, std::vector<ChannelTable> tables,
          const std::map<std::string, std::vector<std::string>>& names);
  /// Takes away what was not published.
  ~RunFile();
  RunFile(const RunFile&) = delete;
  RunFile& operator=(const RunFile&) = delete;

  /// The rows of a table from `first` on, which begins a chunk; at most that chunk's.
  void write(std::size_t table, std::size_t first, std::span<const double> rows);
  /// Makes what was written readable for others, and after a kill.
  void flush();
  /// Ditto after a loss of power.
  void sync();
  /// Puts the open file in place of what bears its name.
  void publish();
  void close();

 private:
  /// An empty file.
  RunFile(const std::filesystem::path& path, std::vector<ChannelTable> tables);
  void write_channel(std::size_t table, std::size_t channel, std::size_t first, std::size_t count,
                     std::span<const unsigned char> chunk);

  std::filesystem::path final_path_, path_;
  Hdf5Handle file_;
  std::vector<ChannelTable> tables_;
  std::vector<std::vector<Hdf5Handle>> datasets_;  ///< by table, by channel
  ChunkPacker packer_;
};

}  // namespace grouser
