#pragma once

namespace grouser::cli {

/// A closed pipe, or a file beyond its limit, fails the write instead of ending the process. And how a process of ours
/// ended is kept until it is asked for, also where the caller ignored the end of its own.
void let_calls_fail();

/// From here on SIGINT, SIGTERM and SIGHUP set a flag instead of ending the process; a second one ends it at once. Work
/// under nohup outlives its terminal as before.
void watch_interrupts();
/// True once a signal came. Progress callbacks turn it into `false`.
[[nodiscard]] bool interrupted();

}  // namespace grouser::cli
