#pragma once
#include <string>
#include <vector>

namespace grouser::test {

struct CommandOutput {
  int exit_code = -1;  ///< 128 + signal when one ended it
  std::string out, err;
};

struct CommandControl {
  /// Sent once stderr holds `signal_after`; 0 = none.
  int signal = 0;
  std::string signal_after;
  std::string stdout_file;  ///< empty = captured
  std::vector<int> closed;  ///< standard streams that it starts without
};

/// Runs the built `grouser` as a user does, stderr not on a terminal. A command that runs longer than eight minutes is
/// killed: a sanitized one on a busy machine takes two.
[[nodiscard]] CommandOutput grouser(const std::vector<std::string>& arguments, const CommandControl& control = {});

}  // namespace grouser::test
