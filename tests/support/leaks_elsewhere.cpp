// Linked into every program that is built with LeakSanitizer: memory that libraries of others keep until the process
// ends. OSMesa's contexts share state that it never frees; LLVM compiles its shaders. Source:
// clang.llvm.org/docs/AddressSanitizer.html#suppressing-memory-leaks, lsan/lsan_common.h.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_options();

extern "C" const char* __lsan_default_suppressions() { return "leak:libOSMesa.so\nleak:libLLVM\n"; }
extern "C" const char* __lsan_default_options() { return "print_suppressions=0"; }
