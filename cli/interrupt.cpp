#include "cli/interrupt.h"

#include <csignal>
#include <ctime>

namespace grouser::cli {
namespace {

volatile std::sig_atomic_t interrupt_seen = 0;
volatile std::time_t first_seen = 0;  // s of the monotonic clock

std::time_t now() {
  timespec time = {};
  clock_gettime(CLOCK_MONOTONIC, &time);  // safe in a signal handler
  return time.tv_sec;
}

void on_signal(int signal) {
  if (interrupt_seen == 0) {
    first_seen = now();
    interrupt_seen = 1;
  } else if (now() > first_seen + 1) {
    // A user who asks again does not want to wait for the next safe place. Shells and timeout(1) send twice in one go:
    // that is once.
    std::signal(signal, SIG_DFL);
    raise(signal);
  }
}

}  // namespace

void watch_interrupts() {
  struct sigaction action = {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() { return interrupt_seen != 0; }

}  // namespace grouser::cli
