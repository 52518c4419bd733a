#include "cli/result.h"

#include <fmt/format.h>

#include <iostream>
#include <new>
#include <system_error>

#include "model/errors.h"

namespace grouser::cli {
namespace {

Result failure(Console& console, ExitCode code, const std::string& text) {
  console.error(text);
  Result result;
  result.code = code;
  result.json["errors"] = nlohmann::ordered_json::array({{{"text", text}}});
  return result;
}

Result bad_input(Console& console, const InputError& error) {
  Result result;
  result.code = ExitCode::bad_input;
  for (const InputFinding& finding : error.findings()) {
    console.error(finding.text());
    result.json["errors"].push_back({{"file", finding.file},
                                     {"place", finding.place},
                                     {"expected", finding.expected},
                                     {"found", finding.found},
                                     {"hint", finding.hint},
                                     {"text", finding.text()}});
  }
  return result;
}

}  // namespace

Result guard(Console& console, const std::function<Result()>& work) {
  try {
    return work();
  } catch (const InputError& error) {
    return bad_input(console, error);
  } catch (const Interrupted& stopped) {
    Result result;
    result.code = ExitCode::interrupted;
    result.left = stopped.what();
    return result;
  } catch (const NumericalError& error) {
    return failure(console, ExitCode::numerical_failure, error.what());
  } catch (const FileError& error) {
    return failure(console, ExitCode::file_failure, error.what());
  } catch (const std::system_error& error) {  // of the file system, or no more threads
    return failure(console, ExitCode::file_failure, error.what());
  } catch (const std::bad_alloc&) {
    return failure(console, ExitCode::file_failure, "out of memory: the system gave no more");
  } catch (const std::exception& error) {  // no fault of the user's
    return failure(console, ExitCode::internal_error,
                   fmt::format("internal error: {}; please report it with the command and its files", error.what()));
  }
}

const char* status_text(ExitCode code) {
  switch (code) {
    case ExitCode::done:
      return "done";
    case ExitCode::interrupted:
      return "interrupted";
    default:
      return "error";
  }
}

bool print(const Result& result, const std::string& command, bool as_json) {
  if (as_json) {
    nlohmann::ordered_json object{
        {"command", command}, {"status", status_text(result.code)}, {"exit_code", static_cast<int>(result.code)}};
    object.update(result.json);
    std::cout << object.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
  } else {
    for (const std::string& line : result.lines) std::cout << for_terminal(line) << '\n';
  }
  return static_cast<bool>(std::cout.flush());
}

}  // namespace grouser::cli
