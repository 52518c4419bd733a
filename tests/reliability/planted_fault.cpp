#include <limits>
#include <string>
#include <thread>
#include <vector>

namespace {

char* volatile kept = nullptr;

}  // namespace

/// planted_fault KIND: goes wrong in one way, and ends with 0 unless something notices.
int main(int count, char** arguments) {
  const std::string kind = count > 1 ? arguments[1] : "";
  volatile int one = 1, sum = std::numeric_limits<int>::max();
  volatile double zero = 0.0, quotient = 1e300;
  if (kind == "overflow") sum = sum + one;
  if (kind == "cast") sum = static_cast<int>(quotient);
  if (kind == "heap") sum = std::vector<int>(3).data()[3 * one];
  if (kind == "leak") {
    for (int i = 0; i < 8; ++i) kept = new char[100];
    kept = nullptr;
  }
  if (kind == "invalid") quotient = zero / zero;
  if (kind == "race") {
    int shared = 0;
    std::thread other([&shared] { ++shared; });
    ++shared;
    other.join();
    sum = shared;
  }
  return 0;
}
