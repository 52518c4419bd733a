#include "cli/interrupt.h"

#include <csignal>
#include <ctime>

namespace grouser::cli {
namespace {

/// timeout(1) and closing terminals send to the process and to its group in one go: that is once.
constexpr long k_one_go = 250;  // ms

volatile std::sig_atomic_t interrupt_seen = 0;
volatile long first_seen = 0;  // ms of the monotonic clock

long now() {
  timespec time = {};
  clock_gettime(CLOCK_MONOTONIC, &time);  // safe in a signal handler
  return 1000 * time.tv_sec + time.tv_nsec / 1000000;
}

void on_signal(int signal) {
  if (interrupt_seen == 0) {
    first_seen = now();
    interrupt_seen = 1;
  } else if (now() > first_seen + k_one_go) {
    // A user who asks again does not want to wait for the next safe place.
    std::signal(signal, SIG_DFL);
    raise(signal);
  }
}

}  // namespace

void let_writes_fail() {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

void watch_interrupts() {
  struct sigaction action = {}, hangup = {};
  action.sa_handler = on_signal;
  action.sa_flags = SA_RESTART;  // what was begun goes on to its safe place
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGHUP, nullptr, &hangup);
  if (hangup.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);
}

bool interrupted() { return interrupt_seen != 0; }

}  // namespace grouser::cli
