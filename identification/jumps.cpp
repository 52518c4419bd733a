#include "identification/jumps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identification/corrections.h"
#include "identification/reduce.h"

namespace grouser {
namespace {

constexpr double k_period = 0.04, k_residual = 0.02;  // I 4
constexpr double k_same_amplitude = 0.1;              // of the cycles around a break; else the amplitude is stepped
constexpr std::size_t k_around = 3;                   // cycles on either side that one sine is fitted to
const char* const k_after = "first cycle after a jump";

double turn_of(const PreparedTest& test, const Cycle& cycle) {
  return test.time[cycle.span.end] - test.time[cycle.span.begin];
}

// What one sine leaves of the motion around cycle k; 0 where the amplitude is stepped there.
double residual_around(const PreparedTest& test, std::size_t k) {
  std::size_t first = k, last = k;
  const auto joins = [&](std::size_t a, std::size_t b) { return test.cycles[a].span.end == test.cycles[b].span.begin; };
  while (first > 0 && k - first < k_around && joins(first - 1, first)) --first;
  while (last + 1 < test.cycles.size() && last - k < k_around && joins(last, last + 1)) ++last;
  const double before = test.cycles[first].amplitude, after = test.cycles[last].amplitude;
  if (std::abs(after - before) > k_same_amplitude * std::max(before, after)) return 0.0;
  const CycleSpan span{test.cycles[first].span.begin, test.cycles[last].span.end};
  return fit_sine(test.time, test.displacement, span, test.cycle_rate).relative_residual;
}

struct PhaseBreak {
  std::size_t cycle = 0;
  double deviation = 0.0, residual = 0.0;
};

// The record's first and last cycles are cut by it, whatever their length.
std::vector<PhaseBreak> phase_breaks(const PreparedTest& test) {
  std::vector<PhaseBreak> breaks;
  if (test.source->kind != TestKind::cyclic || !(test.cycle_rate > 0.0)) return breaks;
  for (std::size_t k = 1; k + 1 < test.cycles.size(); ++k) {
    const Cycle& cycle = test.cycles[k];
    // a cycle is cut at samples, half a step wrong at either end
    const double allowed = k_period + 1.0 / static_cast<double>(cycle.span.end - cycle.span.begin);
    const double deviation = turn_of(test, cycle) * test.cycle_rate - 1.0;
    if (std::abs(deviation) <= allowed) continue;
    const double residual = residual_around(test, k);
    if (residual > k_residual) breaks.push_back({k, deviation, residual});
  }
  return breaks;
}

std::string list_of(const std::vector<PhaseBreak>& breaks) {
  std::string text;
  for (const PhaseBreak& one : breaks) text += fmt::format("{}{}", text.empty() ? "" : ", ", one.cycle + 1);
  return text;
}

struct Jumps {
  std::vector<std::size_t> parts;  // of the file's clock
  std::vector<PhaseBreak> breaks;
};

void leave_out(PreparedTest& test, const Jumps& jumps, std::vector<FitWarning>& warnings) {
  const std::string& name = test.source->name;
  const char* remedy = "; the test is left out of the fit (ask for segment_at_jumps to use what lies beside it)";
  if (jumps.parts.size() > 1) {
    const std::vector<double>& time = test.source->time;
    const std::size_t at = jumps.parts[1];
    test.unusable = fmt::format("a time gap of {:.4g} s after sample {} (at {:.6g} s; the usual step is {:.4g} s)",
                                time[at] - time[at - 1], at, time[at - 1], median_step(time));
    if (jumps.parts.size() > 2) test.unusable += fmt::format(", the first of {}", jumps.parts.size() - 1);
    warnings.push_back({"time_gap", name, test.unusable + ": no rate can be told across it" + remedy});
  } else {
    const PhaseBreak& worst = *std::max_element(
        jumps.breaks.begin(), jumps.breaks.end(),
        [](const PhaseBreak& a, const PhaseBreak& b) { return std::abs(a.deviation) < std::abs(b.deviation); });
    test.unusable =
        fmt::format("a phase break in cycle {} ({:+.1f} % of a period; one sine leaves {:.1f} % of the motion)",
                    list_of(jumps.breaks), 100.0 * worst.deviation, 100.0 * worst.residual);
    warnings.push_back({"phase_break", name, test.unusable + ": only its loop areas can be trusted" + remedy});
  }
  for (Cycle& cycle : test.cycles) cycle.note = "jump in the record";
}

}  // namespace

void mark_jumps(PreparedTest& test, std::vector<FitWarning>& warnings, std::vector<AppliedCorrection>& corrections) {
  Jumps jumps{{0}, phase_breaks(test)};
  if (test.source->time_measured) jumps.parts = parts_of(test.source->time);
  if (jumps.parts.size() < 2 && jumps.breaks.empty()) return;
  if (!asks_for(*test.source, CorrectionKind::segment_at_jumps)) return leave_out(test, jumps, warnings);
  int part = 0;
  for (Cycle& cycle : test.cycles) {
    if (cycle.part != part) cycle.note = k_after;
    part = cycle.part;
  }
  for (const PhaseBreak& one : jumps.breaks) {
    test.cycles[one.cycle].note = "phase break";
    if (test.cycles[one.cycle + 1].note.empty()) test.cycles[one.cycle + 1].note = k_after;
  }
  std::string text =
      fmt::format("the record is cut at {} jump{} of its clock and at {} phase break{}", jumps.parts.size() - 1,
                  jumps.parts.size() == 2 ? "" : "s", jumps.breaks.size(), jumps.breaks.size() == 1 ? "" : "s");
  if (!jumps.breaks.empty()) text += fmt::format(" (cycle {})", list_of(jumps.breaks));
  corrections.push_back({name_of(CorrectionKind::segment_at_jumps), test.source->name,
                         text + "; every part has a force zero of its own, and its first cycle is not used"});
}

}  // namespace grouser
