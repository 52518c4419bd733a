#pragma once
#include <string>
#include <vector>

#include "cli/result.h"

namespace grouser::cli {

/// Work for a process of its own. HDF5 and the GL rasteriser are one to a process, so two runs side by side want two.
struct Job {
  double weight = 1.0;  ///< share of the whole that it is, for the common progress
  std::function<ExitCode(const Progress&)> work;
};

/// A job whose error becomes its exit code where it happens: a child cannot throw to its parent.
[[nodiscard]] Job guarded(double weight, Console& console, std::function<ExitCode(const Progress&)> work);

/// Runs all jobs side by side, each in a child of this process; `progress` sees the weighted mean. When it asks to
/// stop, so are the children. Call before this process has threads or a GL context: a child inherits neither in working
/// order. Returns the exit code of the first job that did not end well, or `done`. Throws FileError when no child can
/// be made, or one was killed.
[[nodiscard]] ExitCode run_in_processes(const std::vector<Job>& jobs, const Progress& progress);

}  // namespace grouser::cli
