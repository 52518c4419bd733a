/// `grouser`: parse the command line, call one library function, turn its errors into exit codes.
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>

#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/usage.h"
#include "model/provenance.h"

namespace grouser::cli {
namespace {

struct CommonOptions {
  bool quiet = false;
  bool json = false;
};

void add_common(CLI::App& app, CommonOptions& common) {
  app.set_help_flag("-h,--help", "Print this help and exit");
  app.set_version_flag("--version", "grouser " + program_version(), "Print the version and exit");
  app.add_flag("-q,--quiet", common.quiet, "No notes and no progress on stderr; errors stay");
  app.add_flag("--json", common.json, "Print the result on stdout as one JSON object");
}

/// A closed stdin, stdout or stderr would be given to the first file that is opened, and progress be written into it. A
/// closed stdout becomes one that takes nothing, so that a result for it still fails.
void hold_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) >= 0) continue;
    if (open("/dev/null", stream == STDERR_FILENO ? O_WRONLY : O_RDONLY) != stream)
      _exit(static_cast<int>(ExitCode::file_failure));
  }
}

/// The result on stdout; the exit code, which a closed or full stdout changes where all went well.
int finish(const Result& result, const std::string& command, bool as_json, Console& console) {
  if (result.code == ExitCode::interrupted)
    console.error("interrupted" + (result.left.empty() ? "" : " " + result.left));
  if (print(result, command, as_json)) return static_cast<int>(result.code);
  console.error("stdout: expected to write the result, found it closed or full");
  return static_cast<int>(result.code == ExitCode::done ? ExitCode::file_failure : result.code);
}

int refuse(const CLI::App& root, const CLI::ParseError& error, const std::vector<std::string>& arguments) {
  Console console(false);
  const std::string text = explain(root, error, arguments);
  console.error(text);
  const auto chosen = root.get_subcommands();
  const std::string name = chosen.empty() ? "" : chosen.front()->get_name();
  console.hint(fmt::format("Try `grouser {}--help`.", name.empty() ? "" : name + " "));
  // The parser stopped before it had read its flags.
  if (std::find(arguments.begin(), arguments.end(), "--json") != arguments.end()) {
    Result result;
    result.code = ExitCode::usage;
    result.json["errors"] = nlohmann::ordered_json::array({{{"text", text}}});
    return finish(result, name, true, console);
  }
  return static_cast<int>(ExitCode::usage);
}

int main(int argc, char** argv) {
  hold_standard_streams();
  let_calls_fail();
  CLI::App root{"Rubber-bushed track: from test rig to vehicle dynamics.", "grouser"};
  CommonOptions common;
  add_common(root, common);
  const std::vector<Command> commands{add_identify(root), add_rig(root),   add_simulate(root),
                                      add_render(root),   add_plot(root),  add_report(root),
                                      add_export(root),   add_check(root), add_demo(root)};
  for (const Command& command : commands) add_common(*command.app, common);
  root.require_subcommand(1);
  root.footer(
      "Results go to stdout, everything else to stderr.\n"
      "Exit codes: 0 done, 2 usage, 3 bad input, 4 numerical failure, 5 cannot read or write, "
      "70 internal error, 130 interrupted.");

  const std::vector<std::string> arguments(argv + 1, argv + argc);
  try {
    root.parse(argc, argv);
    if (const std::string empty = empty_value(root); !empty.empty())
      throw CLI::ValidationError(empty, CLI::ExitCodes::ValidationError);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) {
      root.exit(error);
      Console console(false);
      return finish({}, "", false, console);
    }
    return refuse(root, error, arguments);
  }
  const auto command =
      std::find_if(commands.begin(), commands.end(), [](const Command& each) { return each.app->parsed(); });
  watch_interrupts();
  Console console(common.quiet);
  const Result result = guard(console, [&] { return command->run(console); });
  return finish(result, command->app->get_name(), common.json, console);
}

}  // namespace
}  // namespace grouser::cli

int main(int argc, char** argv) { return grouser::cli::main(argc, argv); }
