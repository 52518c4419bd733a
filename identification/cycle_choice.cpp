#include "identification/cycle_choice.h"

#include <algorithm>
#include <cmath>

namespace grouser {
namespace {

constexpr double k_transition = 0.05;      // shift of a cycle's middle over its range (I 4: exactly the block changes)
constexpr double k_same_amplitude = 0.05;  // half swings of one block agree within 5 %
constexpr double k_settled = 0.03;         // |dE/E| to the predecessor; rubber never settles to the noise (I 4)
constexpr int k_most_trailing = 2;         // cycles of a last block that merely lets the actuator stop
constexpr std::size_t k_most_cycles =
    10;  // of a block in the fit: cycles are not replicates (I 2), more only cost time

void mark_transitions(std::vector<Cycle>& cycles) {
  std::vector<double> centres;
  for (const Cycle& cycle : cycles) centres.push_back(cycle.centre);
  const auto middle = centres.begin() + static_cast<std::ptrdiff_t>(centres.size() / 2);
  std::nth_element(centres.begin(), middle, centres.end());
  for (Cycle& cycle : cycles) {
    if (cycle.note.empty() && std::abs(cycle.centre - *middle) > k_transition * 2.0 * cycle.amplitude) {
      cycle.note = "transition";
    }
  }
}

int number_blocks(std::vector<Cycle>& cycles) {
  int block = -1, part = 0;
  double amplitude = 0.0;
  bool interrupted = true;
  for (Cycle& cycle : cycles) {
    interrupted = interrupted || cycle.part != part;
    part = cycle.part;
    if (!cycle.note.empty()) {
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

// Blocks of one or two cycles at the record's end, after a real one: the actuator runs out.
void mark_trailing(PreparedTest& test) {
  if (test.blocks == 0) return;
  std::vector<int> sizes(static_cast<std::size_t>(test.blocks), 0);
  for (const Cycle& cycle : test.cycles) sizes[static_cast<std::size_t>(cycle.block)] += cycle.note.empty() ? 1 : 0;
  std::size_t kept = sizes.size();
  while (kept > 0 && sizes[kept - 1] <= k_most_trailing) --kept;
  if (kept == 0) return;
  for (Cycle& cycle : test.cycles) {
    if (cycle.block >= static_cast<int>(kept) && cycle.note.empty()) cycle.note = "trailing";
  }
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

}  // namespace

void sort_into_blocks(PreparedTest& test) {
  // The first cycle of a ramp creeps from its virgin zero: that is conditioning, no transition.
  const bool cyclic = test.source->kind == TestKind::cyclic;
  if (cyclic && !test.cycles.empty()) mark_transitions(test.cycles);
  test.blocks = number_blocks(test.cycles);
  if (cyclic) mark_trailing(test);
}

void choose_cycles(PreparedTest& test) {
  if (test.cycles.empty()) return;
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
  if (test.cycles_used() == 0) test.unusable = "no cycle is left to use";
}

}  // namespace grouser
