#pragma once
#include <CLI/CLI.hpp>
#include <functional>

#include "cli/result.h"

namespace grouser::cli {

/// One subcommand: its options are registered with the parser, `run` does the work once they are parsed.
struct Command {
  CLI::App* app = nullptr;
  std::function<Result(Console&)> run;
};

[[nodiscard]] Command add_identify(CLI::App& root);
[[nodiscard]] Command add_rig(CLI::App& root);
[[nodiscard]] Command add_simulate(CLI::App& root);
[[nodiscard]] Command add_render(CLI::App& root);
[[nodiscard]] Command add_plot(CLI::App& root);
[[nodiscard]] Command add_report(CLI::App& root);
[[nodiscard]] Command add_export(CLI::App& root);
[[nodiscard]] Command add_check(CLI::App& root);
[[nodiscard]] Command add_demo(CLI::App& root);

}  // namespace grouser::cli
