#include "identification/cycle_findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "identification/corrections.h"
#include "identification/shown.h"

namespace grouser {
namespace {

constexpr double k_frequency_error = 0.01;  // stated against measured (I 4)
constexpr double k_amplitude_error = 0.05;  // stated against measured
constexpr double k_settling = 0.015;        // energy change of the last used cycle
constexpr double k_conditioned = 0.05;      // energy of the first cycle above the used ones'
constexpr double k_softening = 0.03;        // of the force range, over the settled cycles
constexpr double k_steady = 0.6;            // a steady fall loses as much in its later half; Mullins softening dies out
constexpr double k_warm = 1.0;              // K
constexpr double k_together = -0.9;         // correlation of force range and temperature that is evidence
constexpr std::size_t k_least_cycles = 8;   // that show a trend
constexpr std::size_t k_one_by_one = 3;     // tests with the same finding that are named each

// A cycle at its block's amplitude, used or not.
bool belongs(const Cycle& cycle) {
  return cycle.used || cycle.note == "conditioning" || cycle.note == "later cycles are enough";
}

void find_wrong_frequency(const PreparedTest& test, std::vector<FitWarning>& warnings) {
  const auto& stated = test.source->frequency;
  if (!stated || !test.source->time_measured) return;
  const double error = test.frequency / *stated - 1.0;
  if (std::abs(error) <= k_frequency_error) return;
  warnings.push_back({"wrong_frequency", test.source->name,
                      fmt::format("stated {:.4g} Hz, measured {:.4g} Hz ({:+.1f} %); the measured value is used",
                                  *stated, test.frequency, 100.0 * error)});
}

// The laboratory may state the specimen's amplitude or that of the whole column (frame and bushings in series): a
// warning only where neither fits. A stepped record is held against its largest amplitude.
void find_wrong_amplitude(const PreparedTest& test, const RigRecord& rig, std::vector<FitWarning>& warnings) {
  const auto& stated = test.source->amplitude;
  if (!stated || test.source->kind != TestKind::cyclic) return;
  const Cycle* largest = nullptr;
  for (const Cycle& cycle : test.cycles) {
    if (cycle.used && (largest == nullptr || cycle.amplitude > largest->amplitude)) largest = &cycle;
  }
  if (largest == nullptr) return;
  const bool turns = is_rotation(test.source->axis);
  const double compliance = turns ? rig.rig_angular_compliance : rig.rig_compliance;
  const double measured = largest->amplitude;
  const double column = measured * (rig.bushings_in_series + compliance * largest->measured.effective_stiffness);
  const auto wrong = [&](double value) { return std::abs(value / *stated - 1.0) > k_amplitude_error; };
  if (!wrong(measured) || !wrong(column)) return;
  const Shown shown(test.source->axis);
  warnings.push_back(
      {"wrong_amplitude", test.source->name,
       fmt::format("stated {}, measured {} (half the range, {:+.1f} %); the measured value is used",
                   shown.displacement(*stated), shown.displacement(measured), 100.0 * (measured / *stated - 1.0))});
}

void find_unsettled(const PreparedTest& test, std::vector<FitWarning>& warnings) {
  for (int block = 0; block < test.blocks; ++block) {
    std::vector<double> energies;
    double noise = 0.0;
    for (const Cycle& cycle : test.cycles) {
      if (cycle.block != block || !belongs(cycle)) continue;
      energies.push_back(cycle.measured.dissipated_energy);
      noise = energy_noise(test, cycle);
    }
    if (energies.size() < 3) continue;
    // The same sign twice over tells settling from noise. Against their mean, because one of three may be near 0 in
    // noise.
    const auto end = energies.end();
    const double usual = std::abs(end[-1] + end[-2] + end[-3]) / 3.0;
    const double last = (end[-1] - end[-2]) / usual, before = (end[-2] - end[-3]) / usual;
    const double limit = std::max(k_settling, 3.0 * noise / usual);
    if (last * before <= 0.0 || 0.5 * std::abs(last + before) <= limit) continue;
    warnings.push_back({"unsettled_cycles", test.source->name,
                        fmt::format("loop area still changes by {:.1f} % a cycle in the last cycles of block {}",
                                    50.0 * (last + before), block + 1)});
  }
}

// Names of the cycles with a note, and how many.
std::pair<std::string, int> cycles_noted(const PreparedTest& test, const char* note) {
  std::string list;
  int count = 0;
  for (std::size_t k = 0; k < test.cycles.size(); ++k) {
    if (test.cycles[k].note != note) continue;
    list += fmt::format("{}{}", list.empty() ? "" : ", ", k + 1);
    ++count;
  }
  return {list, count};
}

void find_transitions(const PreparedTest& test, std::vector<FitWarning>& warnings) {
  const auto [list, count] = cycles_noted(test, "transition");
  if (count == 0) return;
  warnings.push_back(
      {"transition_cycles", test.source->name,
       fmt::format("{} between two amplitudes and {} not fitted",
                   count > 1 ? "cycles " + list + " lie" : "cycle " + list + " lies", count > 1 ? "are" : "is")});
}

void find_trailing(const PreparedTest& test, std::vector<FitWarning>& warnings) {
  const auto [list, count] = cycles_noted(test, "trailing");
  if (count == 0) return;
  double used = 0.0;
  for (const Cycle& cycle : test.cycles) used = cycle.used ? cycle.amplitude : used;
  const Cycle& last = test.cycles.back();
  const Shown shown(test.source->axis);
  warnings.push_back({"trailing_cycles", test.source->name,
                      fmt::format("cycle{} {} at the end run at {} instead of {}: not used", count > 1 ? "s" : "", list,
                                  shown.displacement(last.amplitude), shown.displacement(used))});
}

// Mullins softening: the first cycle of a block takes more than the settled ones.
void find_conditioning(const PreparedTest& test, std::vector<FitWarning>& warnings) {
  double worst = k_conditioned, worst_range = 0.0;
  int dropped = 0;
  for (int block = 0; block < test.blocks; ++block) {
    const Cycle* first = nullptr;
    double used = 0.0, energy = 0.0, stiffness = 0.0;
    for (const Cycle& cycle : test.cycles) {
      if (cycle.block != block || cycle.open || !belongs(cycle)) continue;
      if (first == nullptr) first = &cycle;
      dropped += cycle.note == "conditioning" ? 1 : 0;
      if (!cycle.used) continue;
      used += 1.0;
      energy += cycle.measured.dissipated_energy;
      stiffness += cycle.measured.effective_stiffness;
    }
    if (used == 0.0 || first->used || !(energy > 0.0)) continue;
    const double excess = first->measured.dissipated_energy * used / energy - 1.0;
    if (excess <= worst || excess * energy / used <= 3.0 * energy_noise(test, *first)) continue;
    worst = excess;
    worst_range = first->measured.effective_stiffness * used / stiffness - 1.0;
  }
  if (worst <= k_conditioned) return;
  warnings.push_back({"conditioning_cycles", test.source->name,
                      fmt::format("loop area of the first cycle {:+.0f} %, stiffness {:+.0f} % against the used ones; "
                                  "{} conditioning cycles are not used",
                                  whole(100.0 * worst), whole(100.0 * worst_range), dropped)});
}

struct Trend {
  std::vector<double> range, temperature;  // of the settled cycles of one block
};

std::vector<Trend> settled_cycles(const PreparedTest& test) {
  std::vector<Trend> trends(static_cast<std::size_t>(test.blocks));
  for (const Cycle& cycle : test.cycles) {
    if (cycle.open || !(cycle.used || cycle.note == "later cycles are enough")) continue;
    Trend& trend = trends[static_cast<std::size_t>(cycle.block)];
    trend.range.push_back(2.0 * cycle.amplitude * cycle.measured.effective_stiffness);
    if (test.temperature.empty()) continue;
    double sum = 0.0;
    for (std::size_t i = cycle.span.begin; i < cycle.span.end; ++i) sum += test.temperature[i];
    trend.temperature.push_back(sum / static_cast<double>(cycle.span.end - cycle.span.begin));
  }
  return trends;
}

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value / static_cast<double>(values.size());
  return sum;
}

// Slope of log(range) over temperature, where the two go together.
std::optional<double> softening_a_kelvin(const Trend& trend) {
  if (trend.temperature.size() < 4) return std::nullopt;
  const double mean_range = mean(trend.range), mean_temperature = mean(trend.temperature);
  double rr = 0.0, rt = 0.0, tt = 0.0;
  for (std::size_t k = 0; k < trend.range.size(); ++k) {
    const double r = trend.range[k] / mean_range - 1.0, t = trend.temperature[k] - mean_temperature;
    rr += r * r, rt += r * t, tt += t * t;
  }
  const auto [low, high] = std::minmax_element(trend.temperature.begin(), trend.temperature.end());
  const double slope = rt / tt;
  const bool evident = rt < k_together * std::sqrt(rr * tt) && *high - *low > k_warm;
  return evident && -slope * (*high - *low) > k_softening ? std::optional(slope) : std::nullopt;
}

// Loss of force range over the cycles, where it goes on as fast in their later half.
std::optional<double> steady_fall(const std::vector<double>& range) {
  if (range.size() < k_least_cycles) return std::nullopt;
  const std::size_t third = range.size() / 3;
  const auto mean_of = [&](std::size_t begin) {
    return mean(std::vector<double>(range.begin() + static_cast<std::ptrdiff_t>(begin),
                                    range.begin() + static_cast<std::ptrdiff_t>(begin + third)));
  };
  const double early = mean_of(0), middle = mean_of((range.size() - third) / 2), late = mean_of(range.size() - third);
  const bool steady = middle - late > k_steady * (early - middle);
  const double fall = 1.5 * (early - late) / early;  // the outer thirds' middles lie two thirds of the cycles apart
  return steady && fall > k_softening ? std::optional(fall) : std::nullopt;
}

void find_thermal_softening(const PreparedTest& test, std::vector<FitWarning>& warnings) {
  for (const Trend& trend : settled_cycles(test)) {
    if (const std::optional<double> slope = softening_a_kelvin(trend)) {
      const auto [low, high] = std::minmax_element(trend.temperature.begin(), trend.temperature.end());
      warnings.push_back({"thermal_softening", test.source->name,
                          fmt::format("the force range falls by {:.2g} % a kelvin while the specimen warms by {:.2g} K "
                                      "over {} cycles",
                                      -100.0 * *slope, *high - *low, trend.range.size())});
    } else if (const std::optional<double> fall = steady_fall(trend.range); fall && trend.temperature.empty()) {
      warnings.push_back(
          {"thermal_softening", test.source->name,
           fmt::format("the force range falls by {:.1f} % over {} cycles, steadily: not conditioning, which "
                       "dies out, but as of a specimen that warms; no temperature is recorded",
                       100.0 * *fall, trend.range.size())});
    }
  }
}

void find_backlash(const PreparedTest& test, std::vector<FitWarning>& warnings) {
  const std::optional<Play> play = find_play(test);
  if (!play) return;
  const Shown shown(test.source->axis);
  warnings.push_back(
      {"backlash", test.source->name,
       fmt::format("force stands at {} over {} in both directions ({:.0f} times slacker than beside): play of "
                   "the fixture, or a clearance of the specimen",
                   shown.force(play->force), shown.displacement(play->width), play->slackness)});
}

}  // namespace

void find_in_cycles(const PreparedTest& test, const RigRecord& rig, std::vector<FitWarning>& warnings) {
  find_wrong_frequency(test, warnings);
  find_wrong_amplitude(test, rig, warnings);
  find_conditioning(test, warnings);
  find_unsettled(test, warnings);
  find_transitions(test, warnings);
  find_trailing(test, warnings);
  find_thermal_softening(test, warnings);
  find_backlash(test, warnings);
}

void gather_common_findings(std::vector<FitWarning>& warnings) {
  const auto is_common = [](const FitWarning& warning) { return warning.code == "conditioning_cycles"; };
  const auto count = static_cast<std::size_t>(std::count_if(warnings.begin(), warnings.end(), is_common));
  if (count <= k_one_by_one) return;
  FitWarning all = *std::find_if(warnings.begin(), warnings.end(), is_common);
  all.text = fmt::format("{} tests soften over their first cycles, which are not used; test {}: {}", count, all.test,
                         all.text);
  all.test.clear();
  std::erase_if(warnings, is_common);
  warnings.push_back(std::move(all));
}

}  // namespace grouser
