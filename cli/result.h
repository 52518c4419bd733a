#pragma once
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/console.h"

namespace grouser::cli {

/// Exit codes of the command (DESIGN 2).
enum class ExitCode {
  done = 0,
  usage = 2,
  bad_input = 3,
  numerical_failure = 4,
  file_failure = 5,
  internal_error = 70,
  interrupted = 130
};

/// What a subcommand hands back: lines for people or, with --json, one object for machines.
struct Result {
  ExitCode code = ExitCode::done;
  std::string left;  ///< of an interrupted command: what stands, and how to go on
  std::vector<std::string> lines;
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
};

/// Runs the work; an error of the libraries becomes its exit code, with every finding on stderr and in the result's
/// `errors`. That it was interrupted is left for main() to say, once for all processes.
[[nodiscard]] Result guard(Console& console, const std::function<Result()>& work);

/// Writes a result to stdout: its lines with what a terminal would obey, or is no UTF-8, as \xNN, for a pipe may end at
/// a terminal. False when stdout takes no more.
[[nodiscard]] bool print(const Result& result, const std::string& command, bool as_json);

/// Of a run or a fit whose progress callback asked for a stop: not an error, yet not done.
[[nodiscard]] const char* status_text(ExitCode code);

}  // namespace grouser::cli
