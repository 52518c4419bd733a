#pragma once
#include <array>
#include <filesystem>
#include <vector>

/// Run A as a user runs it, in processes of its own.
namespace grouser::benchmarks {

/// From the first step to the closed file: what comes before (reading, assembly) is apart.
struct WholeRun {
  double duration = 0.0;                   ///< s, simulated
  long accepted = 0, rejected = 0;         ///< steps
  double processor_time = 0.0;             ///< s, of both threads
  double writer_time = 0.0;                ///< s, of the one that writes
  double wall_time = 0.0;                  ///< s
  double steps_alone = 0.0;                ///< s of processor time, the same steps without output and watching
  std::array<double, 3> resident_bytes{};  ///< after a quarter, a half and all of it
};

/// The processors that this process may use.
[[nodiscard]] std::vector<int> processors();

/// Run A with full output, in a process kept to one processor; writes into `folder`.
[[nodiscard]] WholeRun run_a_on(int processor, const std::filesystem::path& folder);

/// Wall time of as many such processes at once as there are processors given, from start to the end of the last,
/// assembly included [s].
[[nodiscard]] double wall_time_of_runs_on(const std::vector<int>& processors, const std::filesystem::path& folder);

/// `grouser simulate` on run A as a process: largest resident set [bytes]; 0 where the command was not built.
[[nodiscard]] double resident_bytes_of_command(const std::filesystem::path& folder);

}  // namespace grouser::benchmarks
