#include <hdf5.h>
#include <sys/wait.h>
#include <unistd.h>

#include <vector>

#include "tests/fuzz/entries.h"

namespace grouser::fuzz {
namespace {

/// Called by HDF5 for each property of a list, as model/hdf5_fault.cpp is for each object of a file.
herr_t read_past_the_end(hid_t, const char*, void* input) {
  const std::vector<char>& bytes = *static_cast<const std::vector<char>*>(input);
  const volatile char* const past = bytes.data() + bytes.size();
  return *past == 0 ? 0 : 1;
}

}  // namespace

void planted_overflow_entry(std::string_view input) {
  volatile int number = 0;
  for (const char digit : input) number = number * 1000 + digit;
}

void planted_child_entry(std::string_view input) {
  if (!input.starts_with("G")) return;
  const pid_t child = ::fork();
  if (child == 0) {
    std::vector<char> bytes(input.begin(), input.end());
    H5Piterate(H5P_FILE_ACCESS, nullptr, read_past_the_end, &bytes);
    ::_exit(0);
  }
  ::waitpid(child, nullptr, 0);
}

}  // namespace grouser::fuzz
