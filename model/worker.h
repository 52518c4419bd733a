#pragma once
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace grouser {

/// One thread that does jobs in the order in which they are posted. A job that throws ends the work: the jobs behind it
/// are dropped, and every later call here throws what it threw.
class Worker {
 public:
  /// most_waiting: so many jobs may wait before post() does.
  explicit Worker(std::size_t most_waiting);
  /// Does what waits, then ends the thread. Call finish() before to learn of failures.
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  void post(std::function<void()> job);
  /// Returns when every job posted so far is done.
  void finish();

 private:
  void work();
  void throw_failure() const;

  std::size_t most_waiting_;
  std::mutex mutex_;
  std::condition_variable posted_, done_;
  std::deque<std::function<void()>> waiting_;
  bool busy_ = false, ending_ = false;
  std::exception_ptr failure_;
  std::thread thread_;  // last: it uses all the others
};

}  // namespace grouser
