#include "identification/prepared_test.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "identification/corrections.h"
#include "identification/cycle_choice.h"
#include "identification/diagnose.h"
#include "identification/jumps.h"
#include "identification/reduce.h"

namespace grouser {
namespace {

constexpr std::size_t k_most_sine_samples = 4000;
constexpr double k_same_period = 0.04, k_same_amplitude = 0.05;  // of cycles that one sine is fitted to
constexpr double k_sharp = 0.06;          // sine residual: reversals are corners (a triangle's is 0.12)
constexpr double k_smooth_noise = 0.1;    // of a sample's step: less noise does not disturb the element histories
constexpr double k_smooth_range = 0.003;  // noise over force range that would bias a force range
/// Before the first used cycle. The first swing sets every stop that can slip in this test, branches up to the test's
/// own period forget in one turn (e^-6); what is slower or larger acts as the spring does.
constexpr std::size_t k_history_cycles = 10;

// A time column rounded by its file would make a new step length of every sample; equal steps are restored. Where
// stamps are doubled, their resolution is the error to allow for.
bool restore_even_steps(std::span<double> time) {
  if (time.size() < 3) return true;
  const double step = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
  double finest = std::numeric_limits<double>::max();
  bool doubled = false;
  for (std::size_t i = 1; i < time.size(); ++i) {
    const double one = time[i] - time[i - 1];
    doubled = doubled || one == 0.0;
    if (one > 0.0) finest = std::min(finest, one);
  }
  const double allowed = std::max(0.1 * step, doubled ? finest : 0.0);
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (std::abs(time.front() + step * static_cast<double>(i) - time[i]) > allowed) return false;
  }
  const double start = time.front();
  for (std::size_t i = 0; i < time.size(); ++i) time[i] = start + step * static_cast<double>(i);
  return true;
}

// Doubled stamps of an uneven clock share the step that follows them.
void separate_stamps(std::span<double> time) {
  for (std::size_t i = 0; i < time.size();) {
    std::size_t next = i + 1;
    while (next < time.size() && time[next] <= time[i]) ++next;
    const double step = next < time.size() ? time[next] - time[i] : time[i] - (i > 0 ? time[i - 1] : time[i] - 1.0);
    for (std::size_t k = i + 1; k < next; ++k) {
      time[k] = time[i] + step * static_cast<double>(k - i) / static_cast<double>(next - i);
    }
    i = next;
  }
}

// Evens every part's clock. Between two parts lies at least the former's duration: every branch is at rest again, and
// the stops are set anew by the first swing, so that a part starts as a record does.
void mend_clock(std::vector<double>& time, const std::vector<std::size_t>& parts) {
  const double usual = median_step(time);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const std::size_t begin = parts[p], end = p + 1 < parts.size() ? parts[p + 1] : time.size();
    const std::span<double> part = std::span(time).subspan(begin, end - begin);
    if (p > 0) {
      const double rest = std::max(usual, time[begin - 1] - time[parts[p - 1]]), gap = part.front() - time[begin - 1];
      const double shift = gap < rest ? rest - gap : 0.0;
      for (double& t : part) t += shift;
    }
    if (!restore_even_steps(part)) separate_stamps(part);
  }
}

// Closed cycles; a static test may also be one ramp out and no way back, as in the paper.
void cut_cycles(PreparedTest& test, const std::vector<std::size_t>& parts) {
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const std::size_t begin = parts[p], end = p + 1 < parts.size() ? parts[p + 1] : test.displacement.size();
    for (const CycleSpan& span : find_cycles(std::span(test.displacement).subspan(begin, end - begin))) {
      Cycle& cycle = test.cycles.emplace_back();
      cycle.span = {begin + span.begin, begin + span.end};
      cycle.part = static_cast<int>(p);
    }
  }
  if (test.cycles.empty() && test.source->kind == TestKind::static_ramp && test.displacement.size() > 8) {
    Cycle& ramp = test.cycles.emplace_back();
    ramp.open = true;
    ramp.span = {0, test.displacement.size() - 1};
  }
}

void measure_extent(Cycle& cycle, const std::vector<double>& displacement) {
  const auto first = displacement.begin() + static_cast<std::ptrdiff_t>(cycle.span.begin);
  const auto [low, high] =
      std::minmax_element(first, first + static_cast<std::ptrdiff_t>(cycle.span.end - cycle.span.begin) + 1);
  cycle.amplitude = 0.5 * (*high - *low);
  cycle.centre = 0.5 * (*high + *low);
}

void measure_cycle(Cycle& cycle, const PreparedTest& test) {
  measure_extent(cycle, test.displacement);
  cycle.measured = loop_measures(test.displacement, test.force, test.smooth_force, cycle.span, test.frequency,
                                 test.noise_displacement);
  if (cycle.open) {
    cycle.measured = {.effective_stiffness = cycle.measured.effective_stiffness,
                      .secant_stiffness = cycle.measured.secant_stiffness};
  }
  add_dynamic_stiffness(test, cycle, test.force, cycle.measured);
}

// The clock of a record that has none: a ramp moves at its stated rate, a loop turns at its stated frequency, and the
// samples are equally spaced. Without either, the sample's number stands for the time.
void scale_clock(PreparedTest& test, bool counted) {
  const RigTest& source = *test.source;
  test.rate_known = !counted;
  if (!counted || test.cycles.empty()) return;
  double step = 0.0, samples = 0.0, travel = 0.0;
  for (const Cycle& cycle : test.cycles) {
    samples += test.time[cycle.span.end] - test.time[cycle.span.begin];
    travel += (cycle.open ? 2.0 : 4.0) * cycle.amplitude;
  }
  if (source.kind == TestKind::static_ramp && source.rate) step = travel / *source.rate / samples;
  if (source.kind == TestKind::cyclic && source.frequency) {
    step = static_cast<double>(test.cycles.size()) / *source.frequency / samples;
  }
  if (!(step > 0.0)) return;
  for (double& t : test.time) t *= step;
  test.rate_known = true;
}

// Longest run of cycles that follow each other at one amplitude and one period.
CycleSpan longest_run(const PreparedTest& test, double period) {
  std::size_t first = 0, best_first = 0, best_last = 0;
  bool was_regular = false;  // the cycle with a phase break starts no run
  for (std::size_t k = 0; k < test.cycles.size(); ++k) {
    const Cycle& cycle = test.cycles[k];
    const double turn = test.time[cycle.span.end] - test.time[cycle.span.begin];
    const bool follows = k > 0 && test.cycles[k - 1].span.end == cycle.span.begin;
    const bool alike = std::abs(cycle.amplitude - test.cycles[first].amplitude) <= k_same_amplitude * cycle.amplitude;
    const bool regular = std::abs(turn - period) <= k_same_period * period;
    if (!follows || !alike || !was_regular) first = k;
    was_regular = regular;
    if (regular && k - first > best_last - best_first) best_first = first, best_last = k;
  }
  const std::size_t end = test.cycles[best_last].span.end;
  while (best_first < best_last && end - test.cycles[best_first].span.begin > k_most_sine_samples) ++best_first;
  return {test.cycles[best_first].span.begin, end};
}

void find_frequency(PreparedTest& test) {
  if (test.cycles.empty() || test.cycles.front().open) return;
  std::vector<double> turns;
  for (const Cycle& cycle : test.cycles) turns.push_back(test.time[cycle.span.end] - test.time[cycle.span.begin]);
  test.cycle_rate = static_cast<double>(turns.size()) / std::reduce(turns.begin(), turns.end());
  if (test.source->kind == TestKind::cyclic) {
    const auto middle = turns.begin() + static_cast<std::ptrdiff_t>(turns.size() / 2);
    std::nth_element(turns.begin(), middle, turns.end());
    const CycleSpan run = longest_run(test, *middle);
    const SineFit displacement = fit_sine(test.time, test.displacement, run, 1.0 / *middle);
    test.cycle_rate = displacement.frequency;
    test.sine_residual_displacement = displacement.relative_residual;
    test.sine_residual_force = fit_sine(test.time, test.force, run, test.cycle_rate).relative_residual;
  }
  if (test.rate_known) test.frequency = test.cycle_rate;
}

// Largest odd window that spans a tenth of a cycle, at most 15 samples (I 2).
int smoothing_window(const PreparedTest& test) {
  const std::size_t samples = test.cycles.back().span.end - test.cycles.front().span.begin;
  return std::min(15, static_cast<int>(samples / test.cycles.size()) / 10 / 2 * 2 + 1);
}

void quieten(PreparedTest& test) {
  test.noise_displacement = noise_level(test.displacement);
  test.noise_force = noise_level(test.force);
  test.smooth_force = test.force;
  if (test.cycles.empty()) return;
  const bool sharp = test.source->kind == TestKind::static_ramp || test.sine_residual_displacement > k_sharp;
  const auto corners = sharp ? turning_points(test.displacement) : std::vector<std::size_t>{};
  if (test.noise_displacement > k_smooth_noise * median_step(test.displacement)) {
    test.displacement = smooth(test.displacement, smoothing_window(test), corners);
  }
  if (test.noise_force > k_smooth_range * central_range(test.force)) {
    test.smooth_force = smooth(test.force, smoothing_window(test), corners);
  }
}

// Leaves out what lies long before the first used cycle.
void forget_early_cycles(PreparedTest& test) {
  std::size_t first = 0;
  while (first < test.cycles.size() && !test.cycles[first].used) ++first;
  if (first == test.cycles.size() || first <= k_history_cycles) return;
  const std::size_t kept = first - k_history_cycles, begin = test.cycles[kept].span.begin;
  for (std::vector<double>* channel :
       {&test.time, &test.displacement, &test.force, &test.smooth_force, &test.temperature}) {
    if (!channel->empty()) channel->erase(channel->begin(), channel->begin() + static_cast<std::ptrdiff_t>(begin));
  }
  for (std::size_t k = 0; k < test.cycles.size(); ++k) {
    CycleSpan& span = test.cycles[k].span;
    span = k < kept ? CycleSpan{} : CycleSpan{span.begin - begin, span.end - begin};
  }
}

// Reads, mends and reduces the record; true = its samples are only counted.
bool load(PreparedTest& test, const RigRecord& rig, std::vector<std::size_t>& parts,
          std::vector<AppliedCorrection>& corrections) {
  const RigTest& source = *test.source;
  Signals record{source.time, source.displacement, source.force, source.temperature};
  correct_readings(source, rig, record, corrections);
  parts = source.time_measured ? parts_of(record.time) : std::vector<std::size_t>{0};
  mend_clock(record.time, parts);
  bool counted = false;
  if (!source.time_measured) {
    // A reader without clock counts samples, or adds up a ramp's noisy steps: samples are equally spaced in either
    // case.
    std::vector<double> even = record.time;
    const bool is_count = record.time.size() > 1 && record.time.front() == 0.0 && record.time[1] == 1.0;
    counted = is_count || !restore_even_steps(even);
    if (counted) std::iota(record.time.begin(), record.time.end(), 0.0);
  }
  ReducedRecord reduced = reduce(std::move(record), std::move(parts));
  parts = std::move(reduced.parts);
  test.time = std::move(reduced.signals.time);
  test.displacement = std::move(reduced.signals.displacement);
  test.force = std::move(reduced.signals.force);
  test.temperature = std::move(reduced.signals.temperature);
  return counted;
}

}  // namespace

int PreparedTest::cycles_used() const {
  return static_cast<int>(std::count_if(cycles.begin(), cycles.end(), [](const Cycle& c) { return c.used; }));
}

void add_dynamic_stiffness(const PreparedTest& test, const Cycle& cycle, const std::vector<double>& force,
                           LoopMeasures& measures) {
  if (test.source->kind != TestKind::cyclic || cycle.open) return;
  const std::complex<double> stiffness =
      dynamic_stiffness(test.time, test.displacement, force, cycle.span, test.cycle_rate);
  measures.storage_stiffness = stiffness.real();
  measures.loss_stiffness = stiffness.imag();
}

double energy_noise(const PreparedTest& test, const Cycle& cycle) {
  double sum = 0.0;
  for (std::size_t i = cycle.span.begin + 1; i <= cycle.span.end; ++i) {
    const double dx = test.displacement[i] - test.displacement[i - 1];
    sum += dx * dx;
  }
  return test.noise_force * std::sqrt(sum);
}

PreparedTest prepare_test(const RigTest& test, const RigRecord& rig, std::vector<FitWarning>& warnings,
                          std::vector<AppliedCorrection>& corrections) {
  PreparedTest prepared;
  prepared.source = &test;
  std::vector<std::size_t> parts;
  find_spikes(test, warnings);
  const bool counted = load(prepared, rig, parts, corrections);
  cut_cycles(prepared, parts);
  for (Cycle& cycle : prepared.cycles) measure_extent(cycle, prepared.displacement);
  scale_clock(prepared, counted);
  find_frequency(prepared);
  mark_jumps(prepared, warnings, corrections);
  correct_rig(prepared, rig, corrections);
  quieten(prepared);
  correct_displacement(prepared, corrections);
  for (Cycle& cycle : prepared.cycles) measure_extent(cycle, prepared.displacement);
  const bool whole = prepared.unusable.empty();
  if (whole) sort_into_blocks(prepared);
  if (whole) correct_conditioning(prepared, corrections);
  for (Cycle& cycle : prepared.cycles) measure_cycle(cycle, prepared);
  if (!whole) return prepared;
  choose_cycles(prepared);
  diagnose(prepared, rig, warnings);
  forget_early_cycles(prepared);
  return prepared;
}

}  // namespace grouser
