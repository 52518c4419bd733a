#include "cli/interrupt.h"

#include <atomic>
#include <csignal>
#include <ctime>

namespace grouser::cli {
namespace {

/// timeout(1) and closing terminals send to the process and to its group in one go: that is once.
constexpr long k_one_go = 250;  // ms

/// ms of the monotonic clock, 0 for none. A second signal may come to another thread while the first one is handled.
std::atomic<long> first_seen = 0;
static_assert(std::atomic<long>::is_always_lock_free);  // safe in a signal handler

long now() {
  timespec time = {};
  clock_gettime(CLOCK_MONOTONIC, &time);  // safe in a signal handler
  return 1000 * time.tv_sec + time.tv_nsec / 1000000;
}

void on_signal(int signal) {
  long first = 0;
  const bool is_first = first_seen.compare_exchange_strong(first, now());
  if (!is_first && now() > first + k_one_go) {
    // A user who asks again does not want to wait for the next safe place.
    std::signal(signal, SIG_DFL);
    raise(signal);
  }
}

}  // namespace

void let_calls_fail() {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGCHLD, SIG_DFL);
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

bool interrupted() { return first_seen != 0; }

}  // namespace grouser::cli
