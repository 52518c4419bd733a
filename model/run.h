#pragma once
#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "model/provenance.h"
#include "model/scenario.h"

/// A run folder: run.json (summary) and run.h5 (channels). Dataset names, shapes and units: DESIGN 3, docs/files.md.
namespace grouser {

/// One dataset whose first dimension is its table's row.
struct Channel {
  std::string path;                        ///< "/tracks/left/link_position"
  std::string unit;                        ///< "m"
  std::vector<std::size_t> shape;          ///< of one row: {} scalar, {N, 3} ...
  bool single_precision = false;           ///< stored as 32-bit
  bool deflated = false;                   ///< compressed: pays where most values are zero
  [[nodiscard]] std::size_t size() const;  ///< values a row
};

/// Datasets that share rows. A row is the values of all channels one after the other, in this order.
struct ChannelTable {
  std::string name;  ///< "samples", "steps", "probes"
  std::vector<Channel> channels;
  double rate = 0.0;  ///< rows a second [Hz]; 0 where it varies
  [[nodiscard]] std::size_t row_size() const;
  /// Rows that are written at once: those of k_chunk_time, fewer where they are wide.
  [[nodiscard]] std::size_t rows_per_chunk() const;
};
inline constexpr double k_chunk_time =
    0.5;  ///< s simulated; what a killed run loses at most, unless samples are sparse

/// Appends rows to run.h5, full chunks at a time; readable up to the last flush if the process is killed. Conversion,
/// compression and files are the work of a thread of its own, in the order of the calls: a call waits only where that
/// thread is a second of simulated time behind. Any call throws FileError, also for what failed since an earlier one.
class RunWriter {
 public:
  /// names: string datasets written once ("/joints/names" -> ...). kept_rows, by table: so many rows of the file that
  /// stands there already begin the new one.
  RunWriter(const std::filesystem::path& file, const std::vector<ChannelTable>& tables,
            const std::map<std::string, std::vector<std::string>>& names,
            const std::vector<std::size_t>& kept_rows = {});
  /// Closes the file; what was never published goes, and the earlier file stays.
  ~RunWriter();
  RunWriter(const RunWriter&) = delete;
  RunWriter& operator=(const RunWriter&) = delete;
  void append(std::size_t table, std::span<const double> row);
  /// Rows appended so far, by table.
  [[nodiscard]] std::vector<std::size_t> rows() const;
  /// Full chunks of the table so far.
  [[nodiscard]] std::size_t chunks(std::size_t table) const;
  /// Puts the file, with the rows so far, in place of the one that bears its name. Returns once it stands on the disk.
  void publish();
  void flush();
  /// Once all rows so far stand on the disk, calls `then` (on the writer's thread).
  void sync(std::function<void()> then);
  /// Writes the rest, and publishes what was not.
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A dataset in memory, row-major.
struct Array {
  std::vector<std::size_t> shape;
  std::vector<double> values;
  std::string unit;
  [[nodiscard]] std::size_t rows() const { return shape.empty() ? 0 : shape[0]; }
  [[nodiscard]] std::size_t row_size() const { return rows() == 0 ? 0 : values.size() / rows(); }
  [[nodiscard]] std::span<const double> row(std::size_t i) const {
    return {values.data() + i * row_size(), row_size()};
  }
};

/// Reads run.h5, one dataset at a time.
class RunReader {
 public:
  explicit RunReader(const std::filesystem::path& file);
  ~RunReader();
  RunReader(RunReader&&) noexcept;
  [[nodiscard]] bool has(const std::string& path) const;
  [[nodiscard]] std::vector<std::string> datasets() const;
  [[nodiscard]] Array read(const std::string& path) const;
  /// Rows [first, first + count) only.
  [[nodiscard]] Array read_rows(const std::string& path, std::size_t first, std::size_t count) const;
  /// One column of a dataset over all rows: read_column("/tracks/right/bushing_force", {20, 0}).
  [[nodiscard]] std::vector<double> read_column(const std::string& path, const std::vector<std::size_t>& index) const;
  [[nodiscard]] std::vector<std::string> read_names(const std::string& path) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

enum class RunStatus { completed, stopped, failed };

/// One named scalar of run.json's `results`, with what it is held against when it is a check.
struct RunResult {
  std::string name;  ///< "cruise_speed_m_per_s"
  double value = 0.0;
  std::string unit;
  std::string meaning;  ///< one line
};
struct RunCheck {
  std::string name;  ///< "Mean cruise speed"
  double value = 0.0;
  std::string unit;
  std::string limit;  ///< "within 3 % of 13.89 m/s"
  bool pass = false;
};

struct RunSummary {
  std::string name;  ///< scenario name
  std::string vehicle_name, bushing_name;
  RunStatus status = RunStatus::completed;
  std::string message;
  double simulated_time = 0.0;      ///< s
  double wall_time = 0.0;           ///< s, integration and output (assembly apart)
  double assembly_wall_time = 0.0;  ///< s
  struct {
    int bodies = 0, revolute_joints = 0, bushings = 0, degrees_of_freedom = 0, prescribed = 0;
  } counts;
  struct {
    long accepted = 0, rejected = 0, force_evaluations = 0;
    double min = 0.0, mean = 0.0, max = 0.0;
  } steps;
  struct {
    double input = 0.0, dissipated = 0.0, residual = 0.0, residual_fraction = 0.0;
  } energy;
  std::vector<RunResult> results;
  std::vector<RunCheck> checks;
  Provenance provenance;
};

[[nodiscard]] const char* name_of(RunStatus status);
[[nodiscard]] RunSummary read_run_summary(const std::filesystem::path& file);
void write_run_summary(const RunSummary& summary, const std::filesystem::path& file);

/// A run folder opened for pictures and reports: summary, channels, and the vehicle that was driven (a copy kept in the
/// folder).
struct RunFolder {
  std::filesystem::path path;
  RunSummary summary;
  Vehicle vehicle;
  Scenario scenario;
  RunReader channels;
};
/// Throws InputError / FileError. A run folder holds run.json, run.h5 and inputs/ (scenario.json, vehicle.json,
/// bushing.json).
[[nodiscard]] RunFolder open_run(const std::filesystem::path& folder);

}  // namespace grouser
