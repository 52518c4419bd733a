#pragma once

namespace grouser::cli {

/// A closed pipe, or a file beyond its limit, fails the write instead of ending the process.
void let_writes_fail();

/// From here on SIGINT, SIGTERM and SIGHUP set a flag instead of ending the process; a second one ends it at once. Work
/// under nohup outlives its terminal as before.
void watch_interrupts();
/// True once a signal came. Progress callbacks turn it into `false`.
[[nodiscard]] bool interrupted();

}  // namespace grouser::cli
