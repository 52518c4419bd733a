#pragma once

/// Counts what the program takes from the heap, by operator new or by Eigen's own way.
namespace grouser::test {

/// False where a sanitizer owns the heap: then nothing is counted.
[[nodiscard]] bool allocations_are_counted();
[[nodiscard]] long allocation_count();
/// Taken and not given back yet.
[[nodiscard]] long heap_bytes();

}  // namespace grouser::test
