#include "identification/diagnose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "identification/cycle_findings.h"
#include "identification/shown.h"

namespace grouser {
namespace {

constexpr std::size_t k_clipped_run = 4;     // equal samples at the extreme; noise and a sine's crest give 2 or 3
constexpr std::size_t k_long_run = 12;       // long enough to tell a cut crest from a round one in coarse steps
constexpr double k_round = 0.25;             // a round crest dwells 41 % longer in the next step down, a cut one hardly
constexpr double k_rare = 0.02;              // share of samples that a range is told without
constexpr std::size_t k_longest_spike = 3;   // samples
constexpr double k_offset = 0.05;            // of the range
constexpr double k_both = 0.4;               // shares of force and displacement this alike are one preload
constexpr double k_start = 0.02;             // of the range: a ramp that starts at zero
constexpr double k_drift = 0.03;             // of the range, over the used cycles
constexpr double k_no_slope = 0.05;          // correlation of a pure damper; its sign is no evidence
constexpr double k_least_loss = 0.01;        // loss factor below which the loop's sense of turning is no evidence
constexpr double k_tilt = 0.1;               // half difference of the LVDTs over the displacement
constexpr std::size_t k_fewest_samples = 8;  // of a test; fewer are never cut into cycles
constexpr double k_purer = 1.5;              // ratio of two sine residuals that is evidence
constexpr double k_pi = std::numbers::pi;
constexpr int k_least_samples = 50;  // per cycle; 39 lose .6-1 % of the area to the chord (I 4)

struct Plateau {
  std::size_t at = 0, length = 0;
};

// Longest run of equal samples among those that count.
template <typename Counts>
Plateau longest_plateau(const std::vector<double>& signal, const Counts& counts) {
  Plateau best;
  std::size_t run = 0;
  for (std::size_t i = 0; i < signal.size(); ++i) {
    run = counts(signal[i]) ? (run > 0 && signal[i] == signal[i - 1] ? run + 1 : 1) : 0;
    if (run > best.length) best = {i + 1 - run, run};
  }
  return best;
}

// Whether the channel dwells one step below its plateau about as long again: a crest in the steps of a coarse
// converter.
bool is_round(const std::vector<double>& channel, const Plateau& top) {
  const double level = channel[top.at];
  const std::size_t end = top.at + top.length;
  const double step = std::min(top.at > 0 ? std::abs(channel[top.at - 1] - level) : HUGE_VAL,
                               end < channel.size() ? std::abs(channel[end] - level) : HUGE_VAL);
  const auto near = [&](std::size_t i) { return std::abs(channel[i] - level) < 1.5 * step; };
  std::size_t beside = 0;
  for (std::size_t i = top.at; i > 0 && near(i - 1); --i) ++beside;
  for (std::size_t i = end; i < channel.size() && near(i); ++i) ++beside;
  return top.length >= k_long_run && static_cast<double>(beside) > k_round * static_cast<double>(top.length);
}

// A channel that stands still at its extreme while the other one moves has hit its limit.
void find_clipping(const PreparedTest& test, const std::vector<double>& channel, const std::vector<double>& other,
                   const char* name, std::vector<FitWarning>& warnings) {
  const auto [low, high] = std::minmax_element(channel.begin(), channel.end());
  const double moved_enough = 0.002 * central_range(other);
  for (const double level : {*low, *high}) {
    const Plateau top = longest_plateau(channel, [&](double value) { return value == level; });
    const auto [at, length] = top;
    // Coarse steps of a converter stand still everywhere. A sensor may be cut at both ends, but a short run at either
    // is a crest.
    const bool both = length >= k_long_run;
    const std::size_t elsewhere = longest_plateau(channel, [&](double value) {
                                    return both ? value != *low && value != *high : value != level;
                                  }).length;
    if (length < std::max(k_clipped_run, 3 * elsewhere)) continue;
    const auto first = other.begin() + static_cast<std::ptrdiff_t>(at);
    const auto [a, b] = std::minmax_element(first, first + static_cast<std::ptrdiff_t>(length));
    if (*b - *a < moved_enough || is_round(channel, top)) continue;
    warnings.push_back(
        {"clipped_sensor", test.source->name,
         fmt::format("{} stands at {:.6g} for {} samples from sample {} on while the other channel moves", name, level,
                     length, at + 1)});
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
  // Of an open ramp, or of a loop as good as elastic, the sign of the slope is all that can be told.
  const bool no_area = test.cycles.front().open || loss < k_least_loss * static_cast<double>(test.cycles.size());
  const bool rises = sxf >= -k_no_slope * std::sqrt(sxx) * std::sqrt(sff), turns_right = no_area ? rises : energy > 0.0;
  if (turns_right && rises) return;
  const auto cycles = static_cast<double>(test.cycles.size());
  std::string evidence =
      fmt::format("loop area {:.4g} J, slope {}", energy / cycles, Shown(test.source->axis).stiffness(sxf / sxx));
  std::string code = "reversed_polarity", reading = "one channel has its sign reversed", remedy = "reverse_force";
  // A loop that turns the wrong way round its own slope looks the same for three faults; the user knows which.
  const std::string wrong_turn = "force and displacement are swapped, or time runs backwards, or one channel lags";
  if (!turns_right && rises) {
    code = "swapped_columns";
    reading = wrong_turn;
    remedy = "swap_columns if they are swapped";
    evidence += evidence_of_wrong_turn(test, signed_loss / cycles);
  } else if (turns_right) {
    code = "swapped_columns";
    reading += ", and besides " + wrong_turn;
    remedy = "reverse_force, and swap_columns if they are swapped";
  }
  test.unusable = reading;
  warnings.push_back({code, test.source->name,
                      evidence + ": " + reading + "; the test is left out of the fit (ask for " + remedy + ")"});
  for (Cycle& cycle : test.cycles) {
    cycle.used = false;
    cycle.note = reading;
  }
}

struct Channel {
  const std::vector<double>& values;
  const char* name;
  const char* consequence;  // what the fit makes of a drift: only the force's zero is free to move
  bool is_force;

  [[nodiscard]] std::string show(double value, Axis axis) const {
    return is_force ? Shown(axis).force(value) : Shown(axis).displacement(value);
  }
};

// A leap out of the range of all other samples and back within a few is no motion.
void find_spikes(const RigTest& test, const Channel& channel, std::vector<FitWarning>& warnings) {
  if (channel.values.empty()) return;
  std::vector<double> sorted = channel.values;
  std::ranges::sort(sorted);
  const std::size_t n = sorted.size(),
                    rare = std::min(static_cast<std::size_t>(std::ceil(k_rare * static_cast<double>(n))), (n - 1) / 2);
  const double low = sorted[rare], high = sorted[n - 1 - rare], range = high - low;
  std::size_t spikes = 0, first = 0, run = 0;
  for (std::size_t i = 0; i <= channel.values.size(); ++i) {
    if (i < channel.values.size() && (channel.values[i] < low - range || channel.values[i] > high + range)) {
      ++run;
      continue;
    }
    if (run > 0 && run <= k_longest_spike && ++spikes == 1) first = i - run;
    run = 0;
  }
  if (spikes == 0 || range == 0.0) return;
  const Axis axis = test.axis;
  warnings.push_back({"spike", test.name,
                      fmt::format("{} leaps to {} in sample {}{} and back{}, where nearly all of it lies from {} to {}",
                                  channel.name, channel.show(channel.values[first], axis), first + 1,
                                  test.time_measured ? fmt::format(" (at {:.6g} s)", test.time[first]) : "",
                                  spikes > 1 ? fmt::format(", and {} times more", spikes - 1) : "",
                                  channel.show(low, axis), channel.show(high, axis))});
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
    warnings.push_back({"drift", test.source->name,
                        fmt::format("mean {} of a cycle moves by {} ({:.1f} % of its range) over {} cycles; {}",
                                    channel.name, channel.show(change, test.source->axis), 100.0 * change / range,
                                    values.size(), channel.consequence)});
  }
}

// Middle of the largest used loops: the displacement's, and the force there, between the branches; shares of the
// ranges.
struct LoopCentre {
  double displacement = 0.0, force = 0.0;
  double displacement_range = 0.0, force_range = 0.0;
};

LoopCentre centre_of_loops(const PreparedTest& test) {
  const Cycle* largest = nullptr;
  for (const Cycle& cycle : test.cycles) {
    if (cycle.used && (largest == nullptr || cycle.amplitude > largest->amplitude)) largest = &cycle;
  }
  LoopCentre centre;
  double count = 0.0;
  for (const Cycle& cycle : test.cycles) {
    if (largest == nullptr || !cycle.used || cycle.block != largest->block) continue;
    count += 1.0;
    centre.displacement += cycle.centre;
    centre.displacement_range += 2.0 * cycle.amplitude;
    centre.force_range += 2.0 * cycle.amplitude * cycle.measured.effective_stiffness;
    double rising = test.force[cycle.span.begin], falling = rising;  // where a cycle is cut as it rises, none follows
    for (std::size_t i = cycle.span.begin + 1; i <= cycle.span.end; ++i) {
      const double a = test.displacement[i - 1] - cycle.centre, b = test.displacement[i] - cycle.centre;
      if ((a < 0.0) == (b < 0.0)) continue;
      (b > a ? rising : falling) = test.force[i - 1] + (test.force[i] - test.force[i - 1]) * a / (a - b);
    }
    centre.force += 0.5 * (rising + falling);
  }
  for (double* value : {&centre.displacement, &centre.force, &centre.displacement_range, &centre.force_range}) {
    *value /= std::max(count, 1.0);
  }
  return centre;
}

// A loop's own middle tells a false zero: displacement and force off theirs together, to the same side, is a preload;
// one of them alone is a zero that was not set. Loops about a stated preset may count from it or from its zero.
void find_offset(const PreparedTest& test, std::vector<FitWarning>& warnings) {
  if (test.source->kind != TestKind::cyclic || test.cycles_used() == 0) return;
  const LoopCentre centre = centre_of_loops(test);
  const Shown shown(test.source->axis);
  const double x = centre.displacement / centre.displacement_range, f = centre.force / centre.force_range;
  const std::string where = fmt::format("loops run about {} ({:.0f} % of their range) and {} ({:.0f} %)",
                                        shown.displacement(centre.displacement), whole(100.0 * x),
                                        shown.force(centre.force), whole(100.0 * f));
  if (test.source->preset) {
    const double off = std::abs(centre.displacement - *test.source->preset) / centre.displacement_range;
    if (off <= k_offset || std::abs(x) <= k_offset) return;
    warnings.push_back(
        {"offset", test.source->name,
         fmt::format("{}, the rig file states a preset of {}", where, shown.displacement(*test.source->preset))});
    return;
  }
  if (std::max(std::abs(x), std::abs(f)) <= k_offset) return;
  const bool one_side = x * f > 0.0 && std::min(x / f, f / x) > k_both;
  if (one_side) {
    warnings.push_back({"preload", test.source->name, where + ": a preload that no preset states"});
    return;
  }
  const bool by_force = std::abs(f) > std::abs(x);
  warnings.push_back({"offset", test.source->name,
                      where + fmt::format(": the zero of the {} was not set; {}", by_force ? "force" : "displacement",
                                          by_force ? "the fit leaves it out" : "the fit takes it for a stretch")});
}

// A ramp that starts at the displacement's zero must start at the force's.
void find_offset_of_ramp(const PreparedTest& test, std::vector<FitWarning>& warnings) {
  if (test.source->kind != TestKind::static_ramp || test.cycles_used() == 0) return;
  const double force_range = central_range(test.source->force), range = central_range(test.source->displacement);
  const double force = test.source->force.front(), x = test.source->displacement.front();
  if (std::abs(x) > k_start * range || std::abs(force) <= k_offset * force_range) return;
  const Shown shown(test.source->axis);
  warnings.push_back(
      {"offset", test.source->name,
       fmt::format("the ramp starts at {} with {} ({:.0f} % of its range): the zero of the force was not "
                   "set; the fit leaves it out",
                   shown.displacement(x), shown.force(force), 100.0 * std::abs(force) / force_range)});
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

void find_spikes(const RigTest& test, std::vector<FitWarning>& warnings) {
  find_spikes(test, {test.displacement, "displacement", "", false}, warnings);
  find_spikes(test, {test.force, "force", "", true}, warnings);
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
  find_drift(test, {test.force, "force", "taken out of the fit as a straight line", true}, warnings);
  find_drift(
      test,
      {test.displacement, "displacement", "the fit takes it for a motion of the specimen and leaves it in", false},
      warnings);
  // a drifting zero is not where it was set; that is said once
  const auto drifts = [&](const FitWarning& warning) { return warning.code == "drift" && warning.test == name; };
  if (std::none_of(warnings.begin(), warnings.end(), drifts)) find_offset(test, warnings);
  find_offset_of_ramp(test, warnings);
  find_in_cycles(test, rig, warnings);
  find_sparse_sampling(test, warnings);
  find_tilt(test, warnings);
  if (!test.rate_known) {
    warnings.push_back({"rate_unknown", name,
                        "neither time nor frequency is given: fitted as rate-independent (spring and friction stops)"});
  }
}

}  // namespace grouser
