/// Each of the programs fuzz_*: GROUSER_FUZZ_ENTRY names what it feeds.
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/entries.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  grouser::fuzz::GROUSER_FUZZ_ENTRY({reinterpret_cast<const char*>(data), size});
  return 0;
}
