#include "tests/support/allocation_count.h"

#include <malloc.h>

#include <atomic>
#include <cstddef>

// Eigen allocates by malloc, operator new does too: standing in for malloc itself sees both (glibc).
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)

namespace grouser::test {
bool allocations_are_counted() { return false; }
long allocation_count() { return 0; }
long heap_bytes() { return 0; }
}  // namespace grouser::test

#else

namespace {

std::atomic<long> allocations{0}, bytes{0};

void* counted(void* block) {
  ++allocations;
  bytes += static_cast<long>(malloc_usable_size(block));
  return block;
}
void* forgotten(void* block) {
  bytes -= static_cast<long>(malloc_usable_size(block));
  return block;
}

}  // namespace

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* block);

void* malloc(std::size_t size) { return counted(__libc_malloc(size)); }
void* calloc(std::size_t count, std::size_t size) { return counted(__libc_calloc(count, size)); }
void* realloc(void* old, std::size_t size) { return counted(__libc_realloc(forgotten(old), size)); }
void* memalign(std::size_t alignment, std::size_t size) { return counted(__libc_memalign(alignment, size)); }
void* aligned_alloc(std::size_t alignment, std::size_t size) { return memalign(alignment, size); }
int posix_memalign(void** to, std::size_t alignment, std::size_t size) {
  *to = memalign(alignment, size);
  return *to == nullptr ? 12 : 0;  // ENOMEM
}
void free(void* block) { __libc_free(forgotten(block)); }
}

namespace grouser::test {
bool allocations_are_counted() { return true; }
long allocation_count() { return allocations; }
long heap_bytes() { return bytes; }
}  // namespace grouser::test

#endif
