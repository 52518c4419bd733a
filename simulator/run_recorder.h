#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "simulator/results.h"
#include "simulator/sampler.h"

namespace grouser {

/// Writes a run's channels to run.h5 and keeps what its results are made of.
class RunRecorder {
 public:
  /// kept_rows: rows of run.h5 to keep, by table; empty for a run from its beginning.
  RunRecorder(const System& system, const std::filesystem::path& file, const std::vector<std::size_t>& kept_rows);

  /// Publishes the file, with the state of time 0.
  void begin(const Snapshot& now);
  /// One accepted step: the samples due in it, its own row, and what the results need of every step.
  void record(const Snapshot& previous, const Snapshot& now, const Stepper& stepper);

  /// The last step filled a chunk of samples: flushed now, none of it is written twice.
  [[nodiscard]] bool chunk_filled() const { return chunk_filled_; }
  void flush() { writer_.flush(); }
  /// Puts the file, with the rows that it keeps, in place of the one that holds them.
  void publish() { writer_.publish(); }
  /// Rows so far, by table.
  [[nodiscard]] std::vector<std::size_t> rows() const { return writer_.rows(); }
  /// Calls `then`, on another thread, once these rows are safe on the disk.
  void sync(std::function<void()> then) { writer_.sync(std::move(then)); }
  void close() { writer_.close(); }

  [[nodiscard]] const RunMeasures& measures() const { return measures_; }

  /// Its memory, for a checkpoint.
  template <typename Archive>
  void archive(Archive& a) {
    a(samples_, probes_, measures_);
  }

 private:
  void sample(const Snapshot& previous, const Snapshot& now);
  void sum_steps(const Stepper& stepper);
  void measure(const Snapshot& now);

  const System& system_;
  ChannelRows rows_;
  RunWriter writer_;
  Sampler samples_, probes_;
  RunMeasures measures_;
  std::optional<Interval> steady_;
  double largest_rate_ = 0.0;  // rad/s, asked of any sprocket
  bool chunk_filled_ = false;
};

}  // namespace grouser
