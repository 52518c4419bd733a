#include "tests/support/allocation_count.h"

#include <atomic>
#include <cstddef>

// Eigen allocates by malloc, operator new does too: standing in for malloc itself sees both (glibc).
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)

namespace grouser::test {
bool allocations_are_counted() { return false; }
long allocation_count() { return 0; }
}  // namespace grouser::test

#else

namespace {
std::atomic<long> allocations{0};
}

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  ++allocations;
  return __libc_realloc(old, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** to, std::size_t alignment, std::size_t size) {
  ++allocations;
  *to = __libc_memalign(alignment, size);
  return *to == nullptr ? 12 : 0;  // ENOMEM
}
}

namespace grouser::test {
bool allocations_are_counted() { return true; }
long allocation_count() { return allocations; }
}  // namespace grouser::test

#endif
