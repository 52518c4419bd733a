#include "cli/console.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <mutex>
#include <utility>

#include "cli/interrupt.h"
#include "model/errors.h"

namespace grouser::cli {
namespace {

constexpr const char* k_clear_line = "\r\033[K";

bool on_terminal() { return isatty(STDERR_FILENO) == 1; }

std::size_t terminal_columns() {
  winsize size = {};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

/// A terminal that is gone, or a full disk behind stderr, is no reason to lose the work.
void write_stderr(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

void write_line(std::string_view label, std::string_view text) {
  write_stderr(fmt::format("{}grouser: {}{}\n", on_terminal() ? k_clear_line : "", label, for_terminal(text)));
}

std::string duration_text(double seconds) {
  const long whole = std::lround(seconds);
  return whole < 60 ? fmt::format("{} s", whole) : fmt::format("{} min {:02} s", whole / 60, whole % 60);
}

class ProgressBar {
 public:
  explicit ProgressBar(std::string title) : title_(std::move(title)), terminal_(on_terminal()) {}
  ~ProgressBar() {
    if (terminal_) write_stderr(k_clear_line);
  }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void show(const ProgressReport& report) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const double fraction = std::clamp(report.fraction, 0.0, 1.0);
    if (begun_ < 0.0) begun_ = fraction;
    if (terminal_) {
      draw_bar(fraction, report.what);
    } else if (const int tenth = static_cast<int>(fraction * 10.0 + 1e-9); tenth > last_tenth_) {
      last_tenth_ = tenth;
      write_line("", title_ + ": " + status(fraction, report.what));
    }
  }

 private:
  using Clock = std::chrono::steady_clock;

  static double seconds_between(Clock::time_point from, Clock::time_point to) {
    return std::chrono::duration<double>(to - from).count();
  }

  [[nodiscard]] std::string status(double fraction, const std::string& what) const {
    std::string text = fmt::format("{:3.0f} %", 100.0 * fraction);
    const double elapsed = seconds_between(start_, Clock::now());
    // Under a second the rate says more about start-up than about the work.
    if (const double done = fraction - begun_; done > 0.0 && fraction < 1.0 && elapsed > 1.0) {
      text += fmt::format("  {:.2g} %/s, {} left", 100.0 * done / elapsed,
                          duration_text(elapsed * (1.0 - fraction) / done));
    }
    if (!what.empty()) text += "  " + what;
    return text;
  }

  void draw_bar(double fraction, const std::string& what) {
    const Clock::time_point now = Clock::now();
    if (fraction < 1.0 && seconds_between(last_draw_, now) < 0.1) return;
    last_draw_ = now;
    constexpr std::size_t k_cells = 24;
    const auto filled = static_cast<std::size_t>(fraction * k_cells);
    std::string line = fmt::format("{} [{}{}] {}", title_, std::string(filled, '#'), std::string(k_cells - filled, '.'),
                                   status(fraction, what));
    line = for_terminal(line);
    line.resize(std::min(line.size(), terminal_columns() - 1));
    write_stderr(k_clear_line + line);
  }

  std::string title_;
  bool terminal_;
  std::mutex mutex_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_draw_ = start_ - std::chrono::hours(1);
  double begun_ = -1.0;  // fraction that was done before, by a process that was stopped; < 0: nothing reported yet
  int last_tenth_ = 0;
};

}  // namespace

std::string for_terminal(std::string_view text) {
  constexpr std::size_t k_piece = 200;  // bytes; `printable` cuts what is longer than one value of a file should be
  std::string shown;
  while (!text.empty()) {
    std::size_t end = std::min(text.size(), k_piece);
    while (end > 1 && end < text.size() && (text[end] & 0xC0) == 0x80) --end;  // not within a character
    shown += printable(text.substr(0, end));
    text.remove_prefix(end);
  }
  return shown;
}

void Console::error(std::string_view text) { write_line("error: ", text); }

void Console::hint(std::string_view text) { write_stderr(for_terminal(text) + "\n"); }

void Console::note(std::string_view text) {
  if (!quiet_) write_line("", text);
}

Progress Console::progress(std::string title) {
  if (quiet_) return [](const ProgressReport&) { return !interrupted(); };
  return [bar = std::make_shared<ProgressBar>(std::move(title))](const ProgressReport& report) {
    if (interrupted()) return false;
    bar->show(report);
    return true;
  };
}

Progress part_of(const Progress& callback, double from, double to) {
  return [callback, from, to](const ProgressReport& report) {
    return callback({from + (to - from) * std::clamp(report.fraction, 0.0, 1.0), report.what});
  };
}

}  // namespace grouser::cli
