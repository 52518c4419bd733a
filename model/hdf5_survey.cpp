#include "model/hdf5_survey.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <string>

#include "model/hdf5_fault.h"
#include "model/hdf5_handle.h"

namespace grouser {
namespace {

constexpr rlim_t k_most_memory = rlim_t{1} << 30;
constexpr std::uintmax_t k_least_seconds = 10,
                         k_bytes_a_second = 50u << 20;  // of the processor: packed values are read once

/// Bytes of addresses that this process may come to, with what a survey takes at most; and that limit of the system's.
struct MemoryLimits {
  rlim_t wanted = 0;
  rlimit system{};
};

MemoryLimits memory_limits() {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  MemoryLimits limits{static_cast<rlim_t>(pages) * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + k_most_memory, {}};
  getrlimit(RLIMIT_AS, &limits.system);
  return limits;
}

/// May crash, at no cost to the program.
void prepare_for_the_worst(const std::filesystem::path& file) {
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGALRM, SIGXCPU}) std::signal(signal, SIG_DFL);
  // Ctrl-C and Ctrl-Z reach the whole group of processes: they say nothing of the file, and the parent answers them.
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGTSTP}) std::signal(signal, SIG_IGN);
  const MemoryLimits limits = memory_limits();
  const rlim_t most = std::min(limits.wanted, limits.system.rlim_cur);
  std::error_code unknown;
  const std::uintmax_t size = std::filesystem::file_size(file, unknown);
  const rlim_t seconds = k_least_seconds + (unknown ? 0 : size / k_bytes_a_second);
  const rlimit memory{most, most}, time{seconds, seconds + 1}, none{0, 0};
  setrlimit(RLIMIT_AS, &memory);
  setrlimit(RLIMIT_CPU, &time);
  setrlimit(RLIMIT_CORE, &none);
  constexpr rlim_t k_patience = 10;  // times the processor's time, on a busy machine; for what waits for ever
  alarm(static_cast<unsigned>(k_patience * seconds));
}

[[noreturn]] void survey_as_child(const std::filesystem::path& file, pid_t parent, const std::array<int, 2>& pipe) {
  const auto [of_parent, to_parent] = pipe;
  ::close(of_parent);
  // What outlived its parent would keep the lock of the parent's run folder.
  if (::prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || ::getppid() != parent) _exit(1);
  prepare_for_the_worst(file);
  std::string fault;
  try {
    fault = fault_of_hdf5(file);
  } catch (const std::exception&) {  // std::bad_alloc: a size that the file only claims
    fault = "a size that does not fit into memory";
  }
  fault.resize(std::min<std::size_t>(fault.size(), 4096));
  const ssize_t written = ::write(to_parent, fault.data(), fault.size());
  ::close(to_parent);
  _exit(written == static_cast<ssize_t>(fault.size()) ? 0 : 1);
}

std::string take_all(int from) {
  std::string text;
  std::array<char, 512> part{};
  ssize_t count = 0;
  while ((count = ::read(from, part.data(), part.size())) > 0 || (count < 0 && errno == EINTR)) {
    if (count > 0) text.append(part.data(), static_cast<std::size_t>(count));
  }
  ::close(from);
  return text;
}

/// How the child failed; empty where it came to its end. A wait that fails is no good end.
std::string failure_of(pid_t child) {
  int status = 0, result = 0;
  while ((result = ::waitpid(child, &status, 0)) < 0 && errno == EINTR) {
  }
  if (result < 0) return std::string("the process that looks at it first: ") + std::strerror(errno);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return "";
  const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  if (signal == SIGKILL) return "the process that looks at it first was killed: was memory out?";
  if (signal == SIGALRM || signal == SIGXCPU) return "a damaged HDF5 file, on which the HDF5 library comes to no end";
  return "a damaged HDF5 file, on which the HDF5 library itself fails";
}

pid_t fork_apart_from_hdf5() {
  const std::lock_guard lock(hdf5_fork_mutex());
  return ::fork();
}

std::string refusal_of(const std::filesystem::path& file) { return "cannot read " + printable(file.string()) + ": "; }

void refuse_unopened(const std::filesystem::path& file) {
  if (const std::string why = why_not_opened(file, ""); !why.empty()) throw FileError(refusal_of(file) + why);
}

}  // namespace

std::mutex& hdf5_fork_mutex() {
  static std::mutex mutex;
  return mutex;
}

void survey_hdf5(const std::filesystem::path& file) {
  refuse_unopened(file);
  const std::string refusal = refusal_of(file);
  const MemoryLimits limits = memory_limits();
  const std::string doubt = limits.system.rlim_cur < limits.wanted ? ", or too little memory to read it" : "";
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw FileError(refusal + std::strerror(errno));
  const pid_t parent = ::getpid(), child = fork_apart_from_hdf5();
  if (child == 0) survey_as_child(file, parent, ends);
  ::close(ends[1]);
  const std::string fault = take_all(ends[0]);
  if (child < 0) throw FileError(refusal + std::strerror(errno));
  const std::string failure = failure_of(child);
  if (failure.empty() && fault.empty()) return;
  refuse_unopened(file);  // what was taken away meanwhile is not damaged
  throw FileError(refusal + (failure.empty() ? printable(fault) : failure) + doubt);
}

}  // namespace grouser
