#pragma once
#include <chrono>

namespace grouser {

/// Wall time [s], that of the run's earlier parts included.
class Stopwatch {
 public:
  explicit Stopwatch(double earlier = 0.0) : earlier_(earlier) {}
  [[nodiscard]] double seconds() const {
    return earlier_ + std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  double earlier_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace grouser
