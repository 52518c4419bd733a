#pragma once
#include <algorithm>
#include <ctime>
#include <limits>

namespace grouser::benchmarks {

/// Of the calling thread (CLOCK_THREAD_CPUTIME_ID), of all threads (CLOCK_PROCESS_CPUTIME_ID), on the wall
/// (CLOCK_MONOTONIC) [s].
inline double seconds_by(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Shortest of `rounds` times that a call takes by `clock` [s].
template <typename Work>
double shortest_of(int rounds, clockid_t clock, Work work) {
  double shortest = std::numeric_limits<double>::infinity();
  for (int round = 0; round < rounds; ++round) {
    const double start = seconds_by(clock);
    work();
    shortest = std::min(shortest, seconds_by(clock) - start);
  }
  return shortest;
}

/// Processor time of a short call: the shortest of several batches [s a call].
template <typename Work>
double seconds_per_call(Work work) {
  constexpr double k_batch_time = 2e-3;
  constexpr int k_batches = 40;
  for (long calls = 1;; calls *= 2) {
    const auto batch = [&] {
      for (long i = 0; i < calls; ++i) work();
    };
    if (shortest_of(1, CLOCK_THREAD_CPUTIME_ID, batch) < k_batch_time) continue;
    return shortest_of(k_batches, CLOCK_THREAD_CPUTIME_ID, batch) / static_cast<double>(calls);
  }
}

}  // namespace grouser::benchmarks
