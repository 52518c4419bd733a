#pragma once

#include <cfenv>

namespace grouser::test {

/// While one lives, its thread goes on behind invalid operations, divisions by zero and overflows, as in a program
/// without traps: for libraries that do such things by design, and for numbers that overflow on purpose.
class WithoutTraps {
 public:
  WithoutTraps() { std::feholdexcept(&before_); }
  ~WithoutTraps() { std::fesetenv(&before_); }
  WithoutTraps(const WithoutTraps&) = delete;
  WithoutTraps& operator=(const WithoutTraps&) = delete;

 private:
  std::fenv_t before_{};
};

}  // namespace grouser::test
