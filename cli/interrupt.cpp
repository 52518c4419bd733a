#include "cli/interrupt.h"

#include <csignal>

namespace grouser::cli {
namespace {

volatile std::sig_atomic_t interrupt_seen = 0;

void on_signal(int /*signal*/) { interrupt_seen = 1; }

}  // namespace

void watch_interrupts() {
  struct sigaction action = {};
  action.sa_handler = on_signal;
  // Back to the default after the first: a user who asks twice does not want to wait for the next safe place.
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() { return interrupt_seen != 0; }

}  // namespace grouser::cli
