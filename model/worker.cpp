#include "model/worker.h"

#include <utility>

namespace grouser {

Worker::Worker(std::size_t most_waiting) : most_waiting_(most_waiting), thread_([this] { work(); }) {}

Worker::~Worker() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  posted_.notify_one();
  thread_.join();
}

void Worker::post(std::function<void()> job) {
  {
    std::unique_lock lock(mutex_);
    done_.wait(lock, [this] { return failure_ || waiting_.size() < most_waiting_; });
    throw_failure();
    waiting_.push_back(std::move(job));
  }
  posted_.notify_one();
}

void Worker::finish() {
  std::unique_lock lock(mutex_);
  done_.wait(lock, [this] { return waiting_.empty() && !busy_; });
  throw_failure();
}

void Worker::throw_failure() const {
  if (failure_) std::rethrow_exception(failure_);
}

void Worker::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    posted_.wait(lock, [this] { return ending_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    std::function<void()> job = std::move(waiting_.front());
    waiting_.pop_front();
    busy_ = true;
    done_.notify_all();  // there is room for another
    lock.unlock();
    std::exception_ptr failure;
    try {
      job();
    } catch (...) {
      failure = std::current_exception();
    }
    job = nullptr;
    lock.lock();
    busy_ = false;
    if (failure) {
      failure_ = failure;
      waiting_.clear();
    }
    done_.notify_all();
  }
}

}  // namespace grouser
