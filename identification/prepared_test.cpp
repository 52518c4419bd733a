#include "identification/prepared_test.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "identification/diagnose.h"

namespace grouser {
namespace {

constexpr double k_transition = 0.05;      // shift of a cycle's middle over its range (I 4: exactly the block changes)
constexpr double k_same_amplitude = 0.05;  // half swings of one block agree within 5 %
constexpr double k_settled = 0.03;         // |dE/E| to the predecessor; rubber never settles to the noise (I 4)
constexpr std::size_t k_most_cycles =
    10;  // of a block in the fit: cycles are not replicates (I 2), more only cost time
constexpr std::size_t k_most_sine_samples = 20000;
constexpr double k_smooth_noise = 0.1;    // of a sample's step: less noise does not disturb the element histories
constexpr double k_smooth_range = 0.003;  // noise over force range that would bias a force range

double median(std::vector<double> values) {
  const auto mid = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), mid, values.end());
  return *mid;
}

// A time column rounded by its file would make a new step length of every sample; equal steps are restored.
std::vector<double> regular_time(const std::vector<double>& time) {
  if (time.size() < 3) return time;
  const double step = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
  std::vector<double> even(time.size());
  for (std::size_t i = 0; i < time.size(); ++i) {
    even[i] = time.front() + step * static_cast<double>(i);
    if (std::abs(even[i] - time[i]) > 0.1 * step) return time;
  }
  return even;
}

int samples_per_cycle(const PreparedTest& test) {
  const auto samples = test.cycles.back().span.end - test.cycles.front().span.begin;
  return static_cast<int>(samples / test.cycles.size());
}

// Largest odd window that spans a tenth of a cycle, at most 15 samples (I 2).
int smoothing_window(int per_cycle) { return std::min(15, per_cycle / 10 / 2 * 2 + 1); }

void measure_cycle(Cycle& cycle, const PreparedTest& test) {
  const auto first = test.displacement.begin() + static_cast<std::ptrdiff_t>(cycle.span.begin);
  const auto last = test.displacement.begin() + static_cast<std::ptrdiff_t>(cycle.span.end) + 1;
  const auto [low, high] = std::minmax_element(first, last);
  cycle.amplitude = 0.5 * (*high - *low);
  cycle.centre = 0.5 * (*high + *low);
  cycle.measured = loop_measures(test.displacement, test.force, test.smooth_force, cycle.span, test.frequency);
  if (cycle.open) cycle.measured = {.effective_stiffness = cycle.measured.effective_stiffness};
  add_dynamic_stiffness(test, cycle, test.force, cycle.measured);
}

// Closed cycles; a static test may also be one ramp out and no way back, as in the paper.
std::vector<Cycle> cut_cycles(const RigTest& source, const std::vector<double>& displacement) {
  std::vector<Cycle> cycles;
  for (const CycleSpan& span : find_cycles(displacement)) {
    Cycle cycle;
    cycle.span = span;
    cycles.push_back(cycle);
  }
  if (cycles.empty() && source.kind == TestKind::static_ramp && displacement.size() > 8) {
    Cycle ramp;
    ramp.open = true;
    ramp.span = {0, displacement.size() - 1};
    cycles.push_back(ramp);
  }
  return cycles;
}

// Times of a record that has none: a ramp moves at its stated rate, a loop turns at its stated frequency, and the
// samples are equally spaced. Without either, the sample's number stands for the time.
void build_time(const RigTest& source, PreparedTest& test) {
  const bool counted = source.time.size() > 1 && source.time.front() == 0.0 &&
                       source.time.back() == static_cast<double>(source.time.size() - 1);
  test.rate_known = source.time_measured || source.rate || source.frequency || !counted;
  test.time = regular_time(source.time);
  if (source.time_measured || test.cycles.empty()) return;
  const CycleSpan all{test.cycles.front().span.begin, test.cycles.back().span.end};
  const auto samples = static_cast<double>(all.end - all.begin);
  double step = 0.0;
  if (source.kind == TestKind::static_ramp && source.rate) {
    double travel = 0.0;
    for (const Cycle& cycle : test.cycles) {
      const auto [low, high] =
          std::minmax_element(source.displacement.begin() + static_cast<std::ptrdiff_t>(cycle.span.begin),
                              source.displacement.begin() + static_cast<std::ptrdiff_t>(cycle.span.end));
      travel += (cycle.open ? 1.0 : 2.0) * (*high - *low);
    }
    step = travel / *source.rate / samples;
  } else if (counted && source.frequency) {
    step = static_cast<double>(test.cycles.size()) / *source.frequency / samples;
  }
  for (std::size_t i = 0; step > 0.0 && i < test.time.size(); ++i) test.time[i] = step * static_cast<double>(i);
}

void find_frequency(PreparedTest& test) {
  if (!test.rate_known || test.cycles.empty()) return;
  const CycleSpan all{test.cycles.front().span.begin, test.cycles.back().span.end};
  const double duration = test.time[all.end] - test.time[all.begin];
  if (test.cycles.front().open) return;
  test.frequency = static_cast<double>(test.cycles.size()) / duration;
  if (test.source->kind != TestKind::cyclic) return;
  std::size_t first = 0;  // the last cycles are enough
  while (first + 1 < test.cycles.size() && all.end - test.cycles[first].span.begin > k_most_sine_samples) ++first;
  const CycleSpan part{test.cycles[first].span.begin, all.end};
  const SineFit displacement = fit_sine(test.time, test.displacement, part, test.frequency);
  test.frequency = displacement.frequency;
  test.sine_residual_displacement = displacement.relative_residual;
  test.sine_residual_force = fit_sine(test.time, test.force, part, test.frequency).relative_residual;
}

void mark_transitions(std::vector<Cycle>& cycles) {
  std::vector<double> centres;
  for (const Cycle& cycle : cycles) centres.push_back(cycle.centre);
  const double usual = median(centres);
  for (Cycle& cycle : cycles) {
    if (std::abs(cycle.centre - usual) > k_transition * 2.0 * cycle.amplitude) cycle.note = "transition";
  }
}

int number_blocks(std::vector<Cycle>& cycles) {
  int block = -1;
  double amplitude = 0.0;
  bool interrupted = true;
  for (Cycle& cycle : cycles) {
    if (cycle.note == "transition") {
      interrupted = true;
    } else if (interrupted || std::abs(cycle.amplitude - amplitude) > k_same_amplitude * amplitude) {
      ++block;
      amplitude = cycle.amplitude;
      interrupted = false;
    }
    cycle.block = std::max(block, 0);
  }
  return block + 1;
}

// Keeps the settled part of a block: from the first cycle whose energy repeats its predecessor's, but at most its later
// half. A cycle alone at its amplitude has no predecessor: it is kept only where the test has nothing else.
void settle_block(PreparedTest& test, const std::vector<Cycle*>& block) {
  std::size_t first = block.size() == 1 && test.cycles.size() > 1 ? 1 : 0;
  for (std::size_t k = 1; k < block.size(); ++k) {
    const double before = block[k - 1]->measured.dissipated_energy, now = block[k]->measured.dissipated_energy;
    const double tolerance = std::max(k_settled * std::abs(before), 2.0 * energy_noise(test, *block[k]));
    first = k;
    if (std::abs(now - before) <= tolerance) break;
  }
  const std::size_t settled = std::max(first, block.size() / 2);
  const std::size_t enough = block.size() - std::min(block.size(), k_most_cycles);
  for (std::size_t k = 0; k < block.size(); ++k) {
    block[k]->used = k >= settled && k >= enough;
    if (!block[k]->used) block[k]->note = k < settled ? "conditioning" : "later cycles are enough";
  }
}

void choose_cycles(PreparedTest& test) {
  if (test.cycles.empty()) return;
  // The first cycle of a ramp creeps from its virgin zero: that is conditioning, no transition.
  if (test.source->kind == TestKind::cyclic) mark_transitions(test.cycles);
  test.blocks = number_blocks(test.cycles);
  if (test.source->discard_cycles) {
    for (std::size_t k = 0; k < test.cycles.size(); ++k) {
      Cycle& cycle = test.cycles[k];
      if (static_cast<int>(k) < *test.source->discard_cycles) cycle.note = "discarded by the rig file";
      cycle.used = cycle.note.empty();
    }
    if (test.cycles_used() == 0) test.unusable = "every cycle is discarded";
    return;
  }
  for (int b = 0; b < test.blocks; ++b) {
    std::vector<Cycle*> block;
    for (Cycle& cycle : test.cycles) {
      if (cycle.block == b && cycle.note.empty()) block.push_back(&cycle);
    }
    settle_block(test, block);
  }
  if (test.cycles_used() > 0) return;
  for (Cycle& cycle : test.cycles) {  // every amplitude has one cycle only: there is nothing better
    if (cycle.note == "conditioning") cycle.note.clear();
    cycle.used = cycle.note.empty();
  }
}

}  // namespace

int PreparedTest::cycles_used() const {
  return static_cast<int>(std::count_if(cycles.begin(), cycles.end(), [](const Cycle& c) { return c.used; }));
}

void add_dynamic_stiffness(const PreparedTest& test, const Cycle& cycle, const std::vector<double>& force,
                           LoopMeasures& measures) {
  if (test.source->kind != TestKind::cyclic || cycle.open) return;
  const double turn = test.time[cycle.span.end] - test.time[cycle.span.begin];
  const std::complex<double> stiffness = dynamic_stiffness(test.time, test.displacement, force, cycle.span,
                                                           test.frequency > 0.0 ? test.frequency : 1.0 / turn);
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
                          std::vector<AppliedCorrection>& /*corrections*/) {
  PreparedTest prepared;
  prepared.source = &test;
  prepared.force = test.force;
  prepared.displacement.resize(test.displacement.size());
  const double compliance = is_rotation(test.axis) ? 0.0 : rig.rig_compliance;
  for (std::size_t i = 0; i < test.displacement.size(); ++i) {
    prepared.displacement[i] = (test.displacement[i] - compliance * test.force[i]) / rig.bushings_in_series;
  }
  prepared.noise_displacement = noise_level(prepared.displacement);
  prepared.noise_force = noise_level(prepared.force);
  prepared.cycles = cut_cycles(test, prepared.displacement);
  prepared.smooth_force = prepared.force;
  if (!prepared.cycles.empty()) {
    const int window = smoothing_window(samples_per_cycle(prepared));
    if (prepared.noise_displacement > k_smooth_noise * median_step(prepared.displacement)) {
      prepared.displacement = smooth(prepared.displacement, window);
    }
    if (prepared.noise_force > k_smooth_range * central_range(prepared.force)) {
      prepared.smooth_force = smooth(prepared.force, window);
    }
  }
  build_time(test, prepared);
  const bool gap = find_time_gap(prepared, warnings);
  if (!gap) find_frequency(prepared);
  for (Cycle& cycle : prepared.cycles) measure_cycle(cycle, prepared);
  if (gap) return prepared;
  choose_cycles(prepared);
  diagnose(prepared, rig, warnings);
  return prepared;
}

}  // namespace grouser
