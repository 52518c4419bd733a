#pragma once

namespace grouser::cli {

/// From here on SIGINT and SIGTERM set a flag instead of ending the process; one that
/// comes a second or more later ends it at once.
void watch_interrupts();
/// True once a signal came. Progress callbacks turn it into `false`.
[[nodiscard]] bool interrupted();

}  // namespace grouser::cli
