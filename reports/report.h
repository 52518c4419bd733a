#pragma once
#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "model/fit.h"
#include "model/progress.h"
#include "model/run.h"
#include "render/figure.h"

namespace grouser {

/// Names of the figures that a run folder can show ("step_size", "tension", "contact_forces", ...), with a line on
/// each.
struct FigureEntry {
  std::string name, meaning;
};
[[nodiscard]] std::vector<FigureEntry> run_figures();
/// Throws InputError for an unknown name.
[[nodiscard]] Figure make_run_figure(const RunFolder& run, const std::string& name);

/// How curves are compared.
struct ReportOptions {
  std::filesystem::path against;  ///< CSV file of measured channels; empty: runs are held against the first one
  std::vector<std::pair<std::string, std::string>> channels;  ///< column -> channel, "-" before it turns the sign
  double shift = 0.0;                                         ///< s, added to the measured time
  double from = -std::numeric_limits<double>::infinity(), to = -from;  ///< s of the run's clock
  std::vector<std::string> limits;  ///< "iso=0.6", "lag_ms=20", "correlation=none", in place of those that hold else
  Progress progress;                ///< asked before each folder's part; throws Interrupted when it is to stop
};
/// What is wrong with one of the limits; empty when nothing is.
[[nodiscard]] std::string limit_problem(const std::string& limit);

/// Whether one measured channel of one run meets the limits, in a line.
struct ChannelVerdict {
  std::string run, channel;
  bool pass = false;
  std::string text;
};

/// Throws FileError where what bears the name of the page, or of the numbers beside it, is not to be replaced by them:
/// a folder, a device, or other numbers than those of an earlier report. write_report() asks, too, but a command that
/// works for long before it should not learn it so late.
void require_place_of_report(const std::filesystem::path& html_file);

/// One HTML file (and the same numbers in a .json beside it) over fit, virtual rig and run folders in any mix, or over
/// runs against a measurement, whose verdicts it returns. Uses DIR/film.mp4 of a run folder when it is there. Written
/// whole or not at all. Throws InputError / FileError.
std::vector<ChannelVerdict> write_report(const std::vector<std::filesystem::path>& folders,
                                         const std::filesystem::path& html_file, const ReportOptions& options = {});

/// A channel of a run that a measurement can be held against; of many alike the first and the last name.
struct ChannelEntry {
  std::string name, unit, meaning;
};
[[nodiscard]] std::vector<ChannelEntry> run_channels(const std::filesystem::path& folder);

/// The demo's front page: links the reports of its folders, with headline numbers and pictures.
void write_index(const std::filesystem::path& folder);

}  // namespace grouser
