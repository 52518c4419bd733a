#include "tests/benchmarks/whole_run.h"

#include <sched.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>

#include "simulator/run_loop.h"
#include "tests/benchmarks/timing.h"

namespace grouser::benchmarks {
namespace {

const std::filesystem::path k_scenario = GROUSER_SOURCE_DIR "/test_data/scenarios/run_a.json";

double resident_bytes() {
  long total = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> total >> resident;
  return static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

void keep_to(int processor) {
  cpu_set_t only;
  CPU_ZERO(&only);
  CPU_SET(processor, &only);
  if (sched_setaffinity(0, sizeof only, &only) != 0) throw std::runtime_error("cannot keep to one processor");
}

WholeRun run_a(const std::filesystem::path& folder) {
  const System system = compile(read_scenario(k_scenario));
  const RunStart start{assemble(system), 0.0, 0.0, {}};
  WholeRun run;
  run.duration = system.scenario.duration;
  std::filesystem::create_directories(folder);
  RunSummary summary;
  std::size_t seen = 0;
  const auto watch = [&](const ProgressReport& report) {
    constexpr std::array<double, 2> k_looks{0.25, 0.5};
    if (seen < k_looks.size() && report.fraction >= k_looks[seen]) run.resident_bytes[seen++] = resident_bytes();
    return true;
  };
  const double wall = seconds_by(CLOCK_MONOTONIC), both = seconds_by(CLOCK_PROCESS_CPUTIME_ID),
               stepping = seconds_by(CLOCK_THREAD_CPUTIME_ID);
  RunLoop loop(system, start, folder);
  loop.begin();
  if (loop.go(watch, summary) != RunStatus::completed) throw std::runtime_error(summary.message);
  run.resident_bytes.back() = resident_bytes();
  loop.finish(summary);
  run.wall_time = seconds_by(CLOCK_MONOTONIC) - wall;
  run.processor_time = seconds_by(CLOCK_PROCESS_CPUTIME_ID) - both;
  run.writer_time = run.processor_time - (seconds_by(CLOCK_THREAD_CPUTIME_ID) - stepping);
  run.accepted = summary.steps.accepted;
  run.rejected = summary.steps.rejected;

  run.steps_alone = shortest_of(1, CLOCK_THREAD_CPUTIME_ID, [&] {
    Stepper stepper(system, start.assembled.state, start.assembled.knobs);
    while (stepper.state().time < run.duration) {
      if (stepper.step(run.duration) != StepStatus::ok) throw std::runtime_error("a step failed");
    }
  });
  return run;
}

/// Starts `work` in a process of its own, which must not return.
template <typename Work>
pid_t start_process(Work work) {
  const pid_t process = fork();
  if (process < 0) throw std::runtime_error("cannot start a process");
  if (process > 0) return process;
  try {
    work();
  } catch (const std::exception&) {
  }
  _exit(1);
}

rusage wait_for(pid_t process) {
  int status = 0;
  rusage usage{};
  if (wait4(process, &status, 0, &usage) != process || status != 0) throw std::runtime_error("a run failed");
  return usage;
}

}  // namespace

std::vector<int> processors() {
  cpu_set_t all;
  CPU_ZERO(&all);
  sched_getaffinity(0, sizeof all, &all);
  std::vector<int> found;
  for (int i = 0; i < CPU_SETSIZE; ++i) {
    if (CPU_ISSET(i, &all)) found.push_back(i);
  }
  return found;
}

WholeRun run_a_on(int processor, const std::filesystem::path& folder) {
  int ends[2] = {};
  if (pipe(ends) != 0) throw std::runtime_error("no pipe");
  const pid_t process = start_process([&] {
    keep_to(processor);
    const WholeRun run = run_a(folder);
    _exit(write(ends[1], &run, sizeof run) == sizeof run ? 0 : 1);
  });
  close(ends[1]);
  WholeRun run;
  const bool whole = read(ends[0], &run, sizeof run) == sizeof run;
  close(ends[0]);
  wait_for(process);
  if (!whole) throw std::runtime_error("a run failed");
  return run;
}

double wall_time_of_runs_on(const std::vector<int>& processors, const std::filesystem::path& folder) {
  return shortest_of(1, CLOCK_MONOTONIC, [&] {
    std::vector<pid_t> processes;
    for (const int processor : processors) {
      processes.push_back(start_process([&] {
        keep_to(processor);
        static_cast<void>(run_a(folder / std::to_string(processor)));
        _exit(0);
      }));
    }
    for (const pid_t process : processes) wait_for(process);
  });
}

double resident_bytes_of_command(const std::filesystem::path& folder) {
  const std::filesystem::path command = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "grouser";
  if (!std::filesystem::exists(command)) return 0.0;
  const pid_t process = start_process([&] {
    if (std::freopen("/dev/null", "w", stdout) == nullptr) return;  // its results are not ours
    execl(command.c_str(), "grouser", "simulate", k_scenario.c_str(), "-o", folder.c_str(), "--quiet", nullptr);
  });
  return 1024.0 * static_cast<double>(wait_for(process).ru_maxrss);  // in kB
}

}  // namespace grouser::benchmarks
