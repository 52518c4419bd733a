#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "reports/report.h"
#include "reports/run_channels.h"

/// Channels that were measured on a vehicle, against those of a run.
namespace grouser {

/// A column of the file with the channel that it measures.
struct MeasuredChannel {
  std::string column;     ///< as the file calls it, in UTF-8
  RunChannel channel;     ///< of the run
  bool reversed = false;  ///< the sensor counts the other way
  TimeSeries series;      ///< in SI, with the sign of the run, over the run's clock
};

struct Measurement {
  std::filesystem::path file;
  std::string sha256;
  std::vector<MeasuredChannel> channels;
  std::vector<std::string> left_out;  ///< columns that are no channel of the run
};

/// Reads the columns of a CSV file (docs/files.md: names with units, as of every table) that are called like a channel,
/// or all of `options.channels` and no others. Throws InputError with every finding: a name that nearly is a channel,
/// one that several may be, a unit of another dimension, no time or one that does not rise, nothing to compare; and
/// FileError.
[[nodiscard]] Measurement read_measurement(const std::filesystem::path& file, const std::vector<RunChannel>& channels,
                                           const ReportOptions& options);

}  // namespace grouser
