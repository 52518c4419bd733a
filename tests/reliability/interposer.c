// Stands between a program and the C library (LD_PRELOAD) and injects a fault into its N-th call on files below a
// folder.
//   GROUSER_FAULT_UNDER  the folder, absolute
//   GROUSER_FAULT_CALLS  which calls count: w rite, s ync, n ame (rename, remove, make a folder), c reate, o pen what
//                        is there, r ead
//   GROUSER_FAULT_AT     N, from 1; no fault without it
//   GROUSER_FAULT_DO     kill | half (do half of a write, or all of another call, then kill) | stop (SIGSTOP before) |
//                        number of an error, once | the same with + behind it: from there on.
//                        Half of a write into the midst of a file ends where a page does, between which the system
//                        looks for a kill.
//   GROUSER_FAULT_LOG    a line is appended to this file for every call that counts
//   GROUSER_FAULT_CLOCK  the time of day runs backwards, an hour a look
//   GROUSER_FAULT_GL     OSMesa gives no context, which no input of a user brings about
// Processes that are forked count together.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

static const char *under, *calls, *action;
static long at;
static int log_file = -1;
static int clock_runs_back, no_gl;
static atomic_long* count;  // shared with what is forked

__attribute__((constructor)) static void begin(void) {
  under = getenv("GROUSER_FAULT_UNDER");
  calls = getenv("GROUSER_FAULT_CALLS");
  action = getenv("GROUSER_FAULT_DO");
  at = getenv("GROUSER_FAULT_AT") ? atol(getenv("GROUSER_FAULT_AT")) : 0;
  clock_runs_back = getenv("GROUSER_FAULT_CLOCK") != NULL;
  no_gl = getenv("GROUSER_FAULT_GL") != NULL;
  const char* log = getenv("GROUSER_FAULT_LOG");
  if (log) log_file = (int)syscall(SYS_openat, AT_FDCWD, log, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  count = mmap(NULL, sizeof *count, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
}

static int is_under(const char* path) {
  char absolute[PATH_MAX];
  if (path == NULL || under == NULL) return 0;
  if (path[0] != '/') {
    if (getcwd(absolute, sizeof absolute) == NULL) return 0;
    const size_t end = strlen(absolute);
    snprintf(absolute + end, sizeof absolute - end, "/%s", path);
    path = absolute;
  }
  const size_t length = strlen(under);
  return strncmp(path, under, length) == 0 && (path[length] == '/' || path[length] == 0);
}

static void die(void) {
  kill(getpid(), SIGKILL);
  for (;;) pause();
}

enum Verdict { pass, refuse, then_die };

/// Counts a call of a kind on a file; what is to become of it.
static enum Verdict judge(char kind, const char* path) {
  if (calls == NULL || strchr(calls, kind) == NULL || !is_under(path)) return pass;
  const long number = atomic_fetch_add(count, 1) + 1;
  if (log_file >= 0) {
    char line[PATH_MAX + 32];
    const int length = snprintf(line, sizeof line, "%ld %c %s\n", number, kind, path);
    syscall(SYS_write, log_file, line, length);
  }
  if (at == 0 || action == NULL || number < at) return pass;
  if (number == at && strcmp(action, "kill") == 0) die();
  if (number == at && strcmp(action, "half") == 0) return then_die;
  if (number == at && strcmp(action, "stop") == 0) kill(getpid(), SIGSTOP);
  const int error = atoi(action);
  if (error == 0 || (number > at && strchr(action, '+') == NULL)) return pass;
  errno = error;
  return refuse;
}

/// Ditto for a path that may begin in an open folder.
static enum Verdict judge_at(char kind, int folder, const char* path) {
  char link[64], absolute[PATH_MAX];
  if (path == NULL || path[0] == '/' || folder == AT_FDCWD) return judge(kind, path);
  snprintf(link, sizeof link, "/proc/self/fd/%d", folder);
  const ssize_t length = readlink(link, absolute, sizeof absolute - 1);
  if (length < 0 || absolute[0] != '/') return pass;
  snprintf(absolute + length, sizeof absolute - length, "/%s", path);
  return judge(kind, absolute);
}

static enum Verdict judge_open_file(char kind, int descriptor) {
  char link[64], path[PATH_MAX];
  if (calls == NULL || strchr(calls, kind) == NULL) return pass;
  snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const ssize_t length = readlink(link, path, sizeof path - 1);
  if (length < 0 || path[0] != '/') return pass;  // pipes have no path
  path[length] = 0;
  return judge(kind, path);
}

#define REAL(name)               \
  static __typeof__(name)* real; \
  if (real == NULL) real = (__typeof__(name)*)dlsym(RTLD_NEXT, #name)

#define JUDGED(verdict, call, half_call)    \
  const enum Verdict judged = (verdict);    \
  if (judged == refuse) return -1;          \
  if (judged == then_die) {                 \
    const long ignored = (long)(half_call); \
    (void)ignored;                          \
    die();                                  \
  }                                         \
  return call

ssize_t write(int to, const void* bytes, size_t size) {
  REAL(write);
  JUDGED(judge_open_file('w', to), real(to, bytes, size), real(to, bytes, size / 2));
}
static size_t whole_pages_of_half(size_t size, off_t where) {
  const off_t page = 4096, end = (where + (off_t)(size / 2)) / page * page;
  return end > where ? (size_t)(end - where) : 0;
}
ssize_t pwrite(int to, const void* bytes, size_t size, off_t where) {
  REAL(pwrite);
  JUDGED(judge_open_file('w', to), real(to, bytes, size, where),
         real(to, bytes, whole_pages_of_half(size, where), where));
}
ssize_t pwrite64(int to, const void* bytes, size_t size, off64_t where) {
  REAL(pwrite64);
  JUDGED(judge_open_file('w', to), real(to, bytes, size, where),
         real(to, bytes, whole_pages_of_half(size, where), where));
}
ssize_t writev(int to, const struct iovec* parts, int number) {
  REAL(writev);
  JUDGED(judge_open_file('w', to), real(to, parts, number), real(to, parts, number / 2));
}
int ftruncate(int file, off_t size) {
  REAL(ftruncate);
  JUDGED(judge_open_file('w', file), real(file, size), real(file, size));
}
int ftruncate64(int file, off64_t size) {
  REAL(ftruncate64);
  JUDGED(judge_open_file('w', file), real(file, size), real(file, size));
}
int fsync(int file) {
  REAL(fsync);
  JUDGED(judge_open_file('s', file), real(file), real(file));
}
int fdatasync(int file) {
  REAL(fdatasync);
  JUDGED(judge_open_file('s', file), real(file), real(file));
}
int rename(const char* from, const char* to) {
  REAL(rename);
  JUDGED(judge('n', to), real(from, to), real(from, to));
}
int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) {
  REAL(renameat2);
  JUDGED(judge_at('n', to_folder, to), real(from_folder, from, to_folder, to, flags),
         real(from_folder, from, to_folder, to, flags));
}
int renameat(int from_folder, const char* from, int to_folder, const char* to) {
  REAL(renameat);
  JUDGED(judge_at('n', to_folder, to), real(from_folder, from, to_folder, to), real(from_folder, from, to_folder, to));
}
int unlink(const char* path) {
  REAL(unlink);
  JUDGED(judge('n', path), real(path), real(path));
}
int unlinkat(int folder, const char* path, int flags) {
  REAL(unlinkat);
  JUDGED(judge_at('n', folder, path), real(folder, path, flags), real(folder, path, flags));
}
int rmdir(const char* path) {
  REAL(rmdir);
  JUDGED(judge('n', path), real(path), real(path));
}
int remove(const char* path) {
  REAL(remove);
  JUDGED(judge('n', path), real(path), real(path));
}
int mkdir(const char* path, mode_t mode) {
  REAL(mkdir);
  JUDGED(judge('n', path), real(path, mode), real(path, mode));
}
int mkdirat(int folder, const char* path, mode_t mode) {
  REAL(mkdirat);
  JUDGED(judge_at('n', folder, path), real(folder, path, mode), real(folder, path, mode));
}

ssize_t read(int from, void* bytes, size_t size) {
  REAL(read);
  JUDGED(judge_open_file('r', from), real(from, bytes, size), 0);
}
ssize_t pread(int from, void* bytes, size_t size, off_t where) {
  REAL(pread);
  JUDGED(judge_open_file('r', from), real(from, bytes, size, where), 0);
}
ssize_t pread64(int from, void* bytes, size_t size, off64_t where) {
  REAL(pread64);
  JUDGED(judge_open_file('r', from), real(from, bytes, size, where), 0);
}

static char kind_of(int flags) { return flags & O_CREAT ? 'c' : 'o'; }

#define OPENED(name)                                                                       \
  int name(const char* path, int flags, ...) {                                             \
    REAL(name);                                                                            \
    va_list rest;                                                                          \
    va_start(rest, flags);                                                                 \
    const mode_t mode = va_arg(rest, mode_t);                                              \
    va_end(rest);                                                                          \
    JUDGED(judge(kind_of(flags), path), real(path, flags, mode), real(path, flags, mode)); \
  }
OPENED(open)
OPENED(open64)

#define OPENED_AT(name)                                                                                               \
  int name(int folder, const char* path, int flags, ...) {                                                            \
    REAL(name);                                                                                                       \
    va_list rest;                                                                                                     \
    va_start(rest, flags);                                                                                            \
    const mode_t mode = va_arg(rest, mode_t);                                                                         \
    va_end(rest);                                                                                                     \
    JUDGED(judge_at(kind_of(flags), folder, path), real(folder, path, flags, mode), real(folder, path, flags, mode)); \
  }
OPENED_AT(openat)
OPENED_AT(openat64)

#define FILE_OPENED(name)                                                                        \
  FILE* name(const char* path, const char* mode) {                                               \
    REAL(name);                                                                                  \
    const enum Verdict judged = judge(strchr(mode, 'w') || strchr(mode, 'a') ? 'c' : 'o', path); \
    if (judged == refuse) return NULL;                                                           \
    FILE* opened = real(path, mode);                                                             \
    if (judged == then_die) die();                                                               \
    return opened;                                                                               \
  }
FILE_OPENED(fopen)
FILE_OPENED(fopen64)

void* OSMesaCreateContextAttribs(const int* attributes, void* shared) {
  REAL(OSMesaCreateContextAttribs);
  return no_gl ? NULL : real(attributes, shared);
}

static void turn_back(struct timespec* now) {
  static atomic_long looks;
  now->tv_sec -= 3600 * (atomic_fetch_add(&looks, 1) + 1);
}
int clock_gettime(clockid_t clock, struct timespec* now) {
  const int answer = (int)syscall(SYS_clock_gettime, clock, now);
  if (clock_runs_back && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE)) turn_back(now);
  return answer;
}
time_t time(time_t* told) {
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  if (told) *told = now.tv_sec;
  return now.tv_sec;
}
int gettimeofday(struct timeval* told, void* zone) {
  (void)zone;
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  told->tv_sec = now.tv_sec;
  told->tv_usec = now.tv_nsec / 1000;
  return 0;
}
