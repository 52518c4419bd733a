#pragma once
#include <functional>
#include <stdexcept>
#include <string>

namespace grouser {

/// What long work tells its caller now and then.
struct ProgressReport {
  double fraction = 0.0;  ///< done, 0..1
  std::string what;       ///< "run A, 3.2 of 17 s"
};

/// Returns false to ask the work to stop at the next safe place (interrupted; what was computed is kept).
using Progress = std::function<bool(const ProgressReport&)>;

/// Work that was asked to stop and has nothing to keep.
class Interrupted : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace grouser
