#include <cfenv>

/// Linked into a program, ends it at its first invalid operation, division by zero or overflow, in every thread
/// (GROUSER_TRAPS).
namespace grouser::test {
namespace {

[[maybe_unused]] const int k_trapped_before = feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);

}  // namespace
}  // namespace grouser::test
