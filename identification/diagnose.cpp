#include "identification/diagnose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace grouser {
namespace {

constexpr std::size_t k_clipped_run = 4;     // equal samples at the extreme; noise and a sine's crest give 2 or 3
constexpr double k_frequency_error = 0.01;   // stated against measured (I 4)
constexpr double k_amplitude_error = 0.05;   // stated against measured
constexpr double k_drift = 0.03;             // of the range, over the used cycles
constexpr double k_settling = 0.015;         // energy change of the last used cycle
constexpr double k_no_slope = 0.05;          // correlation of a pure damper; its sign is no evidence
constexpr double k_least_loss = 0.01;        // loss factor below which the loop's sense of turning is no evidence
constexpr double k_tilt = 0.1;               // half difference of the LVDTs over the displacement
constexpr std::size_t k_fewest_samples = 8;  // of a test; fewer are never cut into cycles
constexpr double k_purer = 1.5;              // ratio of two sine residuals that is evidence
constexpr double k_pi = std::numbers::pi;
constexpr double k_gap = 5.0;        // of the usual time step
constexpr int k_least_samples = 50;  // per cycle; 39 lose .6-1 % of the area to the chord (I 4)

struct Plateau {
  std::size_t at = 0, length = 0;
};

// Longest run of equal samples at the level, or anywhere else.
Plateau longest_plateau(const std::vector<double>& signal, double level, bool at_level) {
  Plateau best;
  std::size_t run = 0;
  for (std::size_t i = 0; i < signal.size(); ++i) {
    const bool counts = (signal[i] == level) == at_level;
    run = counts ? (run > 0 && signal[i] == signal[i - 1] ? run + 1 : 1) : 0;
    if (run > best.length) best = {i + 1 - run, run};
  }
  return best;
}

// A channel that stands still at its extreme while the other one moves has hit its limit.
void find_clipping(const PreparedTest& test, const std::vector<double>& channel, const std::vector<double>& other,
                   const char* name, std::vector<FitWarning>& warnings) {
  const auto [low, high] = std::minmax_element(channel.begin(), channel.end());
  const double moved_enough = 0.002 * central_range(other);
  for (const double level : {*low, *high}) {
    const auto [at, length] = longest_plateau(channel, level, true);
    // coarse steps of a converter stand still everywhere
    if (length < std::max(k_clipped_run, 3 * longest_plateau(channel, level, false).length)) continue;
    const auto first = other.begin() + static_cast<std::ptrdiff_t>(at);
    const auto [a, b] = std::minmax_element(first, first + static_cast<std::ptrdiff_t>(length));
    if (*b - *a < moved_enough) continue;
    warnings.push_back({"clipped_sensor", test.source->name,
                        fmt::format("{} stands at {:.6g} for {} samples from row {} while the other channel moves",
                                    name, level, length, at + 1)});
  }
}

// How far the force comes after the displacement, and which channel looks like the one the actuator was told to move.
std::string evidence_of_wrong_turn(const PreparedTest& test, double loss_factor) {
  const double delay = std::asin(std::clamp(-loss_factor, 0.0, 1.0));
  std::string text = fmt::format(", force {:.3g} degrees behind displacement", delay * 180.0 / k_pi);
  if (test.frequency > 0.0) text += fmt::format(" ({:.3g} ms)", 1e3 * delay / (2.0 * k_pi * test.frequency));
  const double x = test.sine_residual_displacement, f = test.sine_residual_force;
  if (x > k_purer * f) {
    text += fmt::format(", the force column is the purer sine (residual {:.2g} against {:.2g}), as if swapped", f, x);
  } else if (f > k_purer * x) {
    text += fmt::format(
        ", the displacement column is the purer sine (residual {:.2g} against {:.2g}), not as if swapped", x, f);
  }
  return text;
}

// Loop area and regression slope tell the channels apart by two signs (I 4); elastic enough to turn needs a loss
// factor.
void find_mixed_channels(PreparedTest& test, std::vector<FitWarning>& warnings) {
  double energy = 0.0, sxf = 0.0, sxx = 0.0, sff = 0.0, loss = 0.0, signed_loss = 0.0;
  for (const Cycle& cycle : test.cycles) {
    energy += cycle.measured.dissipated_energy;
    loss += std::abs(cycle.measured.loss_factor);
    signed_loss += cycle.measured.loss_factor;
    double mean_f = 0.0;
    const auto n = static_cast<double>(cycle.span.end - cycle.span.begin);
    for (std::size_t i = cycle.span.begin; i < cycle.span.end; ++i) mean_f += test.force[i] / n;
    for (std::size_t i = cycle.span.begin; i < cycle.span.end; ++i) {
      const double dx = test.displacement[i] - cycle.centre;
      sxf += dx * (test.force[i] - mean_f);
      sxx += dx * dx;
      sff += (test.force[i] - mean_f) * (test.force[i] - mean_f);
    }
  }
  const bool open = test.cycles.front().open;  // the sign of its slope is all that it can tell
  if (!open && loss < k_least_loss * static_cast<double>(test.cycles.size())) return;
  const bool turns_right = open ? sxf > 0.0 : energy > 0.0, rises = sxf > -k_no_slope * std::sqrt(sxx * sff);
  if (turns_right && rises) return;
  const auto cycles = static_cast<double>(test.cycles.size());
  std::string evidence = fmt::format("loop area {:.4g} J, slope {:.4g} N/m", energy / cycles, sxf / sxx);
  std::string code = "reversed_polarity", reading = "one channel has its sign reversed";
  // A loop that turns the wrong way round its own slope looks the same for three faults; the user knows which.
  const std::string wrong_turn = "force and displacement are swapped, or time runs backwards, or one channel lags";
  if (!turns_right && rises) {
    code = "swapped_columns";
    reading = wrong_turn;
    evidence += evidence_of_wrong_turn(test, signed_loss / cycles);
  } else if (turns_right) {
    code = "swapped_columns";
    reading += ", and besides " + wrong_turn;
  }
  test.unusable = reading;
  warnings.push_back({code, test.source->name, evidence + ": " + reading + "; the test is left out of the fit"});
  for (Cycle& cycle : test.cycles) {
    cycle.used = false;
    cycle.note = reading;
  }
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

struct Channel {
  const std::vector<double>& values;
  const char *name, *unit;
  const char* consequence;  // what the fit makes of a drift: only the force's zero is free to move
};

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
  const double compliance = turns ? 0.0 : rig.rig_compliance;
  const double measured = largest->amplitude;
  const double column = measured * (rig.bushings_in_series + compliance * largest->measured.effective_stiffness);
  const auto wrong = [&](double value) { return std::abs(value / *stated - 1.0) > k_amplitude_error; };
  if (!wrong(measured) || !wrong(column)) return;
  const double shown = turns ? 180.0 / k_pi : 1e3;
  const char* unit = turns ? "deg" : "mm";
  warnings.push_back(
      {"wrong_amplitude", test.source->name,
       fmt::format("stated {:.4g} {}, measured {:.4g} {} (half the range, {:+.1f} %); the measured value is used",
                   shown * *stated, unit, shown * measured, unit, 100.0 * (measured / *stated - 1.0))});
}

// Change of the cycle means over the used cycles of a block, by regression.
void find_drift(const PreparedTest& test, const Channel& channel, std::vector<FitWarning>& warnings) {
  std::map<int, std::vector<double>> means;
  for (const Cycle& cycle : test.cycles) {
    if (!cycle.used) continue;
    double sum = 0.0;
    for (std::size_t i = cycle.span.begin; i < cycle.span.end; ++i) sum += channel.values[i];
    means[cycle.block].push_back(sum / static_cast<double>(cycle.span.end - cycle.span.begin));
  }
  for (const auto& [block, values] : means) {
    const auto n = static_cast<double>(values.size());
    if (n < 3.0) continue;
    double sxy = 0.0, sxx = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k) {
      const double position = static_cast<double>(k) - 0.5 * (n - 1.0);
      sxy += position * values[k];
      sxx += position * position;
    }
    const double change = sxy / sxx * n, range = central_range(channel.values);
    if (std::abs(change) <= k_drift * range) continue;
    warnings.push_back(
        {"drift", test.source->name,
         fmt::format("mean {} of a cycle moves by {:.3g} {} ({:.1f} % of its range) over {} cycles; {}", channel.name,
                     change, channel.unit, 100.0 * change / range, values.size(), channel.consequence)});
  }
}

void find_unsettled(const PreparedTest& test, std::vector<FitWarning>& warnings) {
  for (int block = 0; block < test.blocks; ++block) {
    std::vector<double> energies;
    double noise = 0.0;
    for (const Cycle& cycle : test.cycles) {
      if (cycle.block != block || cycle.note == "transition") continue;
      energies.push_back(cycle.measured.dissipated_energy);
      noise = energy_noise(test, cycle);
    }
    if (energies.size() < 3) continue;
    // The same sign twice over tells settling from noise.
    const double last = energies.back() / energies[energies.size() - 2] - 1.0;
    const double before = energies[energies.size() - 2] / energies[energies.size() - 3] - 1.0;
    const double limit = std::max(k_settling, 3.0 * noise / std::abs(energies.back()));
    if (last * before <= 0.0 || 0.5 * std::abs(last + before) <= limit) continue;
    warnings.push_back({"unsettled_cycles", test.source->name,
                        fmt::format("loop area still changes by {:.1f} % a cycle in the last cycles of block {}",
                                    50.0 * (last + before), block + 1)});
  }
}

void find_transitions(const PreparedTest& test, std::vector<FitWarning>& warnings) {
  std::string list;
  for (std::size_t k = 0; k < test.cycles.size(); ++k) {
    if (test.cycles[k].note == "transition") list += fmt::format("{}{}", list.empty() ? "" : ", ", k + 1);
  }
  if (list.empty()) return;
  warnings.push_back({"transition_cycles", test.source->name,
                      fmt::format("cycles {} lie between two amplitudes and are not fitted", list)});
}

void find_sparse_sampling(const PreparedTest& test, std::vector<FitWarning>& warnings) {
  if (test.cycles.front().open) return;
  const auto samples = static_cast<double>(test.cycles.back().span.end - test.cycles.front().span.begin);
  const double per_cycle = samples / static_cast<double>(test.cycles.size());
  if (per_cycle >= k_least_samples) return;
  warnings.push_back({"few_samples", test.source->name,
                      fmt::format("{:.0f} samples a cycle: loop areas are short by about {:.1f} %", per_cycle,
                                  100.0 * std::pow(2.0 * k_pi / per_cycle, 2) / 6.0)});
}

void find_tilt(const PreparedTest& test, std::vector<FitWarning>& warnings) {
  const std::vector<double>& tilt = test.source->tilt;
  if (tilt.empty()) return;
  const double share = central_range(tilt) / central_range(test.source->displacement);
  if (share <= k_tilt) return;
  warnings.push_back(
      {"tilted_specimen", test.source->name,
       fmt::format("the two LVDTs differ by {:.0f} % of the displacement: the specimen tilts; their mean is used",
                   200.0 * share)});
}

}  // namespace

bool find_time_gap(PreparedTest& test, std::vector<FitWarning>& warnings) {
  if (!test.source->time_measured || test.time.size() < k_fewest_samples) return false;
  std::vector<double> steps;
  for (std::size_t i = 1; i < test.time.size(); ++i) steps.push_back(test.time[i] - test.time[i - 1]);
  std::vector<double> sorted = steps;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const auto is_gap = [limit = k_gap * *middle](double step) { return step > limit; };
  const auto gaps = std::count_if(steps.begin(), steps.end(), is_gap);
  if (gaps == 0) return false;
  const auto at = static_cast<std::size_t>(std::find_if(steps.begin(), steps.end(), is_gap) - steps.begin());
  test.unusable = fmt::format("a time gap of {:.4g} s after sample {} (at {:.6g} s; the usual step is {:.4g} s)",
                              steps[at], at + 1, test.time[at], *middle);
  if (gaps > 1) test.unusable += fmt::format(", the first of {}", gaps);
  warnings.push_back(
      {"time_gap", test.source->name,
       test.unusable + ": no rate can be told across it; the test is left out of the fit, cut the record there"});
  for (Cycle& cycle : test.cycles) cycle.note = "time gap in the record";
  return true;
}

void diagnose(PreparedTest& test, const RigRecord& rig, std::vector<FitWarning>& warnings) {
  const std::string& name = test.source->name;
  if (test.cycles.empty()) test.unusable = "no closed cycle";
  if (!(central_range(test.source->displacement) > 0.0)) test.unusable = "a displacement that stands still";
  if (!(central_range(test.force) > 0.0)) test.unusable = "a force that stands still";
  if (test.force.size() < k_fewest_samples) {
    test.unusable = fmt::format("{} samples, too few for a cycle", test.force.size());
  }
  if (!test.unusable.empty()) {
    warnings.push_back({"unusable_test", name, test.unusable + "; the test is left out of the fit"});
    for (Cycle& cycle : test.cycles) cycle.used = false;
    return;
  }
  if (test.cycles.front().open) {
    warnings.push_back(
        {"open_ramp", name, "one ramp without a way back: it tells the stiffness, friction and damping stay unknown"});
  }
  find_mixed_channels(test, warnings);
  find_clipping(test, test.source->displacement, test.source->force, "displacement", warnings);
  find_clipping(test, test.source->force, test.source->displacement, "force", warnings);
  find_wrong_frequency(test, warnings);
  find_wrong_amplitude(test, rig, warnings);
  const bool turns = is_rotation(test.source->axis);
  find_drift(test, {test.force, "force", turns ? "N m" : "N", "taken out of the fit as a straight line"}, warnings);
  find_drift(test,
             {test.displacement, "displacement", turns ? "rad" : "m",
              "the fit takes it for a motion of the specimen and leaves it in"},
             warnings);
  find_unsettled(test, warnings);
  find_transitions(test, warnings);
  find_sparse_sampling(test, warnings);
  find_tilt(test, warnings);
  if (!test.rate_known) {
    warnings.push_back({"rate_unknown", name,
                        "neither time nor frequency is given: fitted as rate-independent (spring and friction stops)"});
  }
}

}  // namespace grouser
