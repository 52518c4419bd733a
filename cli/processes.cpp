#include "cli/processes.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "cli/interrupt.h"
#include "model/errors.h"

namespace grouser::cli {
namespace {

/// A running job as its parent sees it. One that nobody waited for, upon an error of the parent, is stopped.
struct Child {
  Child(pid_t of_process, int of_pipe, double of_weight) : process(of_process), pipe(of_pipe), weight(of_weight) {}
  Child(Child&& other) noexcept
      : process(std::exchange(other.process, -1)),
        pipe(std::exchange(other.pipe, -1)),
        pending(std::move(other.pending)),
        weight(other.weight),
        report(std::move(other.report)) {}
  Child& operator=(Child&&) = delete;
  ~Child() {
    if (pipe >= 0) close(pipe);
    if (process < 0) return;
    kill(process, SIGTERM);
    while (waitpid(process, nullptr, 0) < 0 && errno == EINTR) {
    }
  }

  pid_t process;        ///< -1 once it was waited for
  int pipe;             ///< its progress, a line each: "fraction text"; -1 at its end
  std::string pending;  ///< bytes of a line that is not whole yet
  double weight;
  ProgressReport report;
};

/// No exception leaves it: it would pass through what belongs to the parent.
[[noreturn]] void live_as_child(const Job& job, pid_t parent, int pipe) noexcept {
  // Own group: Ctrl-C on the terminal reaches the parent alone, which passes it on once.
  setpgid(0, 0);
  // What outlived its parent would keep the lock of the run folder that the next command wants: it ends as at Ctrl-C.
  if (prctl(PR_SET_PDEATHSIG, SIGTERM) != 0 || getppid() != parent) _exit(static_cast<int>(ExitCode::file_failure));
  const Progress tell = [pipe](const ProgressReport& report) {
    const std::string line = fmt::format("{} {}\n", report.fraction, report.what);
    // A parent that no longer listens has ended: so does this work.
    return write(pipe, line.data(), line.size()) == static_cast<ssize_t>(line.size()) && !interrupted();
  };
  const ExitCode code = job.work(tell);
  std::fflush(nullptr);
  // No destructors: what the parent held before the fork is the parent's to close.
  _exit(static_cast<int>(code));
}

Child start(const Job& job) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw FileError(fmt::format("cannot make a pipe: {}", std::strerror(errno)));
  std::fflush(nullptr);
  const pid_t parent = getpid(), process = fork();
  if (process < 0) {
    const int why = errno;
    close(ends[0]);
    close(ends[1]);
    throw FileError(fmt::format("cannot make a process: {}", std::strerror(why)));
  }
  if (process == 0) {
    close(ends[0]);
    live_as_child(job, parent, ends[1]);
  }
  close(ends[1]);
  return {process, ends[0], job.weight};
}

/// Takes what the child has said; closes the pipe at its end.
void listen(Child& child) {
  char buffer[4096];
  const ssize_t count = read(child.pipe, buffer, sizeof buffer);
  if (count < 0 && errno == EINTR) return;
  if (count <= 0) {
    close(child.pipe);
    child.pipe = -1;
    child.report.fraction = 1.0;
    return;
  }
  child.pending.append(buffer, static_cast<std::size_t>(count));
  const std::size_t end = child.pending.rfind('\n');
  if (end == std::string::npos) return;
  const std::size_t before = end == 0 ? std::string::npos : child.pending.rfind('\n', end - 1);
  const std::string line = child.pending.substr(before == std::string::npos ? 0 : before + 1, end - before - 1);
  child.pending.erase(0, end + 1);
  char* rest = nullptr;
  child.report.fraction = std::strtod(line.c_str(), &rest);
  child.report.what = *rest == ' ' ? rest + 1 : rest;
}

ProgressReport together(const std::vector<Child>& children) {
  ProgressReport all;
  double weights = 0.0;
  for (const Child& child : children) {
    all.fraction += child.weight * child.report.fraction;
    weights += child.weight;
    if (child.pipe < 0 || child.report.what.empty()) continue;
    all.what += (all.what.empty() ? "" : " | ") + child.report.what;
  }
  all.fraction /= weights;
  return all;
}

/// The code a child ended with; one that a user's signal ended counts as interrupted. `killed` is the signal that no
/// user sent: of the system when memory is out, or of a crash.
ExitCode wait_for(Child& child, int& killed) {
  int status = 0, result = 0;
  while ((result = waitpid(child.process, &status, 0)) < 0 && errno == EINTR) {
  }
  child.process = -1;
  if (result < 0) throw FileError(fmt::format("cannot learn how a part of the work ended: {}", std::strerror(errno)));
  if (WIFEXITED(status)) return static_cast<ExitCode>(WEXITSTATUS(status));
  const int signal = WTERMSIG(status);
  if (signal == SIGINT || signal == SIGTERM || signal == SIGHUP) return ExitCode::interrupted;
  killed = signal;
  return ExitCode::file_failure;
}

}  // namespace

Job guarded(double weight, Console& console, std::function<ExitCode(const Progress&)> work) {
  return {weight, [&console, work = std::move(work)](const Progress& progress) {
            return guard(console,
                         [&] {
                           Result result;
                           result.code = work(progress);
                           return result;
                         })
                .code;
          }};
}

ExitCode run_in_processes(const std::vector<Job>& jobs, const Progress& progress) {
  std::vector<Child> children;
  for (const Job& job : jobs) children.push_back(start(job));
  bool stopping = false;
  while (std::any_of(children.begin(), children.end(), [](const Child& child) { return child.pipe >= 0; })) {
    std::vector<pollfd> waiting;
    for (const Child& child : children) waiting.push_back({child.pipe, POLLIN, 0});
    poll(waiting.data(), waiting.size(), 500 /* ms */);  // poll passes over closed ends, which are -1
    for (std::size_t i = 0; i < children.size(); ++i) {
      if ((waiting[i].revents & (POLLIN | POLLHUP)) != 0) listen(children[i]);
    }
    if (!progress(together(children)) && !stopping) {
      stopping = true;
      for (const Child& child : children) kill(child.process, SIGINT);
    }
  }
  ExitCode worst = ExitCode::done;
  int killed = 0;
  for (Child& child : children) {
    if (const ExitCode code = wait_for(child, killed); worst == ExitCode::done) worst = code;
  }
  if (killed != 0) {
    throw FileError(fmt::format("a part of the work, in a process of its own, was ended by signal {} ({}){}", killed,
                                strsignal(killed), killed == SIGKILL ? ": was memory out?" : ""));
  }
  return worst;
}

}  // namespace grouser::cli
