#include "identification/corrections.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "identification/shown.h"

namespace grouser {
namespace {

constexpr double k_pi = std::numbers::pi;
constexpr double k_zero_celsius = 273.15;  // K
constexpr double k_significant = 5.0;      // of its standard error, for a harmonic to have an acceleration
constexpr double k_noticed = 1e-4;         // of the force range: less inertia is not worth a line
constexpr double k_fraction = 0.618;       // grid of trial constants: each 0.618 of the one before
constexpr int k_trials = 40;
constexpr int k_force_bins = 101;
constexpr double k_standing = 0.003;  // of the force range: half width of the band that stands
constexpr double k_slack = 8.0, k_least_play = 0.03;
constexpr double k_apart = 0.1;  // of the force range, by the fixture's own friction

double compliance_of(const RigRecord& rig, Axis axis) {
  return is_rotation(axis) ? rig.rig_angular_compliance : rig.rig_compliance;
}

double inertia_of(const RigRecord& rig, Axis axis) { return is_rotation(axis) ? rig.moving_inertia : rig.moving_mass; }

double range_of(const std::vector<double>& values, CycleSpan span) {
  const auto first = values.begin() + static_cast<std::ptrdiff_t>(span.begin);
  const auto [low, high] = std::minmax_element(first, first + static_cast<std::ptrdiff_t>(span.end - span.begin) + 1);
  return *high - *low;
}

// x'' by the significant harmonics of one cycle, at its own samples and at those of the record around it that no other
// cycle claims.
void subtract_inertia(const PreparedTest& test, const Cycle& cycle, std::size_t begin, std::size_t end, double inertia,
                      std::vector<double>& force, double& largest) {
  const double omega = 2.0 * k_pi * test.cycle_rate;
  const Harmonics motion = fit_harmonics(test.time, test.displacement, cycle.span, test.cycle_rate);
  const auto samples = static_cast<double>(cycle.span.end - cycle.span.begin);
  const double standard_error = motion.residual * std::sqrt(2.0 / samples);
  for (std::size_t i = begin; i < end; ++i) {
    double acceleration = 0.0;
    for (int k = 1; k <= Harmonics::k_count; ++k) {
      const std::complex<double> a = motion.amplitude[static_cast<std::size_t>(k - 1)];
      if (std::abs(a) < k_significant * standard_error) continue;
      const double turn = k * omega;
      acceleration -= turn * turn * std::real(a * std::polar(1.0, turn * (test.time[i] - test.time[cycle.span.begin])));
    }
    force[i] -= inertia * acceleration;
    largest = std::max(largest, std::abs(inertia * acceleration));
  }
}

void correct_inertia(PreparedTest& test, double inertia, std::vector<AppliedCorrection>& corrections) {
  if (inertia == 0.0 || test.source->kind != TestKind::cyclic || !test.rate_known || test.cycles.empty()) return;
  double largest = 0.0;
  std::vector<double> force = test.force;
  for (std::size_t k = 0; k < test.cycles.size(); ++k) {
    const Cycle& cycle = test.cycles[k];
    const std::size_t begin = k == 0 ? 0 : cycle.span.begin;
    const std::size_t end = k + 1 < test.cycles.size() ? test.cycles[k + 1].span.begin : test.force.size();
    subtract_inertia(test, cycle, begin, end, inertia, force, largest);
  }
  const double share = largest / central_range(test.force);
  test.force = std::move(force);
  if (share < k_noticed) return;
  const Shown shown(test.source->axis);
  corrections.push_back(
      {"moving_mass", test.source->name,
       fmt::format("up to {} of inertia ({:.2g} % of the force range) taken out of the force: {:.4g} {} "
                   "between specimen and cell at {:.4g} Hz",
                   shown.force(largest), 100.0 * share, inertia, is_rotation(test.source->axis) ? "kg m^2" : "kg",
                   test.cycle_rate)});
}

struct Line {
  double offset = 0.0, slope = 0.0, square = 0.0;
};

Line fit_line(const Eigen::ArrayXd& x, const Eigen::ArrayXd& y) {
  const Eigen::ArrayXd dx = x - x.mean(), dy = y - y.mean();
  const double power = dx.square().sum();
  Line line;
  line.slope = power > 0.0 ? (dx * dy).sum() / power : 0.0;
  line.offset = y.mean() - line.slope * x.mean();
  line.square = (dy - line.slope * dx).square().sum();
  return line;
}

void remove_creep(PreparedTest& test, std::vector<AppliedCorrection>& corrections) {
  const std::optional<Creep> creep = fit_creep(test);
  if (!creep) return;
  for (std::size_t i = 0; i < test.displacement.size(); ++i) test.displacement[i] -= creep->at(test.time[i]);
  const Shown shown(test.source->axis);
  corrections.push_back(
      {name_of(CorrectionKind::remove_creep), test.source->name,
       fmt::format("{} x log(1 + t / {:.4g} {}) taken out of the displacement, {} by the record's end; "
                   "the cycles' middles lie within {} of it",
                   shown.displacement(creep->rate), creep->time, test.rate_known ? "s" : "samples",
                   shown.displacement(creep->at(test.time.back())), shown.displacement(creep->residual))});
}

// The gap is crossed only while the force stands: its share of the motion is taken out.
void remove_backlash(PreparedTest& test, std::vector<AppliedCorrection>& corrections) {
  const std::optional<Play> play = find_play(test);
  if (!play) return;
  double crossed = 0.5 * play->width, before = test.displacement.front();
  for (std::size_t i = 0; i < test.displacement.size(); ++i) {
    const double over = test.smooth_force[i] - play->force, dx = test.displacement[i] - before;
    before = test.displacement[i];
    crossed =
        std::abs(over) <= play->band ? std::clamp(crossed + dx, 0.0, play->width) : (over > 0.0 ? play->width : 0.0);
    test.displacement[i] -= crossed - 0.5 * play->width;
  }
  const Shown shown(test.source->axis);
  corrections.push_back({name_of(CorrectionKind::remove_backlash), test.source->name,
                         fmt::format("play of {} at {} taken out of the displacement", shown.displacement(play->width),
                                     shown.force(play->force))});
}

// Path of the displacement in one direction while the force lies in low..high, and its mean force.
struct Path {
  double length = 0.0, force = 0.0;
};
Path path_between(const PreparedTest& test, const std::vector<const Cycle*>& cycles, bool rising, double low,
                  double high) {
  Path path;
  for (const Cycle* cycle : cycles) {
    for (std::size_t i = cycle->span.begin + 1; i <= cycle->span.end; ++i) {
      const double dx = test.displacement[i] - test.displacement[i - 1];
      const auto [from, to] = std::minmax(test.smooth_force[i - 1], test.smooth_force[i]);
      const double bottom = std::max(from, low), top = std::min(to, high);
      if (top < bottom || (dx > 0.0) != rising) continue;
      const double step = std::abs(dx) * (to > from ? (top - bottom) / (to - from) : 1.0);
      path.length += step;
      path.force += step * 0.5 * (bottom + top);
    }
  }
  if (path.length > 0.0) path.force /= path.length;
  return path;
}

// Force, in the central half of low..high, about which a branch spends most of its path.
double standing_force(const PreparedTest& test, const std::vector<const Cycle*>& cycles, bool rising, double low,
                      double high) {
  const double width = (high - low) / k_force_bins;
  Path best;
  for (int b = k_force_bins / 4; b < 3 * k_force_bins / 4; ++b) {
    const Path path = path_between(test, cycles, rising, low + width * b, low + width * (b + 1));
    if (path.length > best.length) best = path;
  }
  // centred on what it holds, so that a bin's border does not cut it
  for (int k = 0; k < 3; ++k) best = path_between(test, cycles, rising, best.force - width, best.force + width);
  return best.force;
}

// One branch's piece of standing force: its length beyond what the stiffness beside it needs, and by how much it is
// slacker. The bands beside are four times as high.
struct Standing {
  double force = 0.0, length = 0.0, slackness = 0.0;
};
Standing find_standing(const PreparedTest& test, const std::vector<const Cycle*>& cycles, bool rising, double low,
                       double high, double band) {
  Standing standing;
  standing.force = standing_force(test, cycles, rising, low, high);
  const auto path = [&](double from, double to) {
    return path_between(test, cycles, rising, standing.force + from * band, standing.force + to * band).length;
  };
  const double inside = path(-1.0, 1.0), stiff = 0.25 * (path(-5.0, -1.0) + path(1.0, 5.0));
  standing.length = (inside - stiff) / static_cast<double>(cycles.size());
  standing.slackness = inside / stiff;
  return standing;
}

}  // namespace

bool asks_for(const RigTest& test, CorrectionKind kind) {
  return std::find(test.corrections.begin(), test.corrections.end(), kind) != test.corrections.end();
}

void correct_readings(const RigTest& test, const RigRecord& rig, Signals& record,
                      std::vector<AppliedCorrection>& corrections) {
  if (asks_for(test, CorrectionKind::swap_columns)) {  // by the reader, before units and calibration
    corrections.push_back({name_of(CorrectionKind::swap_columns), test.name,
                           "the columns of displacement and force have changed places"});
  }
  if (asks_for(test, CorrectionKind::reverse_force)) {
    for (double& force : record.force) force = -force;
    corrections.push_back(
        {name_of(CorrectionKind::reverse_force), test.name, "the sign of every force sample is reversed"});
  }
  if (!rig.thermal || record.temperature.empty()) return;
  const ThermalCorrection& thermal = *rig.thermal;
  for (std::size_t i = 0; i < record.force.size(); ++i) {
    record.force[i] /= 1.0 + thermal.stiffness_change * (record.temperature[i] - thermal.reference_temperature);
  }
  const auto [low, high] = std::minmax_element(record.temperature.begin(), record.temperature.end());
  const auto percent = [&](double temperature) {
    return 100.0 / (1.0 + thermal.stiffness_change * (temperature - thermal.reference_temperature)) - 100.0;
  };
  corrections.push_back(
      {"thermal", test.name,
       fmt::format(
           "force raised by {:.2f} to {:.2f} %: specimen at {:.1f} to {:.1f} degC, reference {:.1f} degC, {:+.3g} "
           "% of stiffness a kelvin",
           percent(*low), percent(*high), *low - k_zero_celsius, *high - k_zero_celsius,
           thermal.reference_temperature - k_zero_celsius, 100.0 * thermal.stiffness_change)});
}

void correct_rig(PreparedTest& test, const RigRecord& rig, std::vector<AppliedCorrection>& corrections) {
  correct_inertia(test, inertia_of(rig, test.source->axis), corrections);
  const double compliance = compliance_of(rig, test.source->axis);
  for (std::size_t i = 0; i < test.displacement.size(); ++i) {
    test.displacement[i] = (test.displacement[i] - compliance * test.force[i]) / rig.bushings_in_series;
  }
}

std::vector<AppliedCorrection> campaign_corrections(const std::vector<PreparedTest>& tests, const RigRecord& rig) {
  std::vector<AppliedCorrection> result;
  for (const bool turns : {false, true}) {
    const double compliance = turns ? rig.rig_angular_compliance : rig.rig_compliance;
    double largest = 0.0;
    const PreparedTest* where = nullptr;
    for (const PreparedTest& test : tests) {
      if (is_rotation(test.source->axis) != turns || compliance == 0.0 || test.force.empty()) continue;
      const double share = compliance * central_range(test.force) / central_range(test.source->displacement);
      if (share > largest) largest = share, where = &test;
    }
    if (where == nullptr) continue;
    result.push_back({"rig_compliance", "",
                      fmt::format("{:.4g} {} x force taken out of every {}, at most {:.2g} % of it (test {})",
                                  compliance, turns ? "rad/(N m)" : "m/N", turns ? "angle" : "displacement",
                                  100.0 * largest, where->source->name)});
  }
  if (rig.bushings_in_series > 1) {
    result.push_back(
        {"bushings_in_series", "",
         fmt::format("every displacement divided by {}: the law is that of one bushing", rig.bushings_in_series)});
  }
  return result;
}

void correct_displacement(PreparedTest& test, std::vector<AppliedCorrection>& corrections) {
  if (asks_for(*test.source, CorrectionKind::remove_creep)) remove_creep(test, corrections);
  if (asks_for(*test.source, CorrectionKind::remove_backlash)) remove_backlash(test, corrections);
}

void correct_conditioning(PreparedTest& test, std::vector<AppliedCorrection>& corrections) {
  if (!asks_for(*test.source, CorrectionKind::remove_conditioning)) return;
  for (int block = 0; block < test.blocks; ++block) {
    std::vector<const Cycle*> cycles;
    std::vector<double> ranges;
    for (const Cycle& cycle : test.cycles) {
      if (cycle.block != block || !cycle.note.empty() || cycle.open) continue;
      cycles.push_back(&cycle);
      ranges.push_back(range_of(test.smooth_force, cycle.span));
    }
    const std::optional<Conditioning> decay = fit_conditioning(ranges);
    if (!decay) continue;
    const double turns = 1.0 / static_cast<double>(cycles.front()->span.end - cycles.front()->span.begin);
    for (std::size_t i = cycles.front()->span.begin; i <= cycles.back()->span.end; ++i) {
      const double k = static_cast<double>(i - cycles.front()->span.begin) * turns;
      const double factor = 1.0 + decay->share * std::exp(-k / decay->cycles);
      test.force[i] /= factor;
      test.smooth_force[i] /= factor;
    }
    corrections.push_back(
        {name_of(CorrectionKind::remove_conditioning), test.source->name,
         fmt::format("force divided by 1 + {:.3g} exp(-cycle / {:.3g}) from cycle {} to {}", decay->share,
                     decay->cycles, cycles.front() - test.cycles.data() + 1, cycles.back() - test.cycles.data() + 1)});
  }
}

double Creep::at(double t) const { return t > start ? rate * std::log1p((t - start) / time) : 0.0; }

std::optional<Creep> fit_creep(const PreparedTest& test) {
  if (test.cycles.size() < 3) return std::nullopt;
  const auto count = static_cast<Eigen::Index>(test.cycles.size());
  Eigen::ArrayXd middles(count), times(count);
  const double start = test.time[test.cycles.front().span.begin];
  for (Eigen::Index k = 0; k < count; ++k) {
    const CycleSpan span = test.cycles[static_cast<std::size_t>(k)].span;
    const auto first = test.displacement.begin() + static_cast<std::ptrdiff_t>(span.begin);
    const auto last = test.displacement.begin() + static_cast<std::ptrdiff_t>(span.end);
    middles(k) = std::reduce(first, last) / static_cast<double>(last - first);
    times(k) = 0.5 * (test.time[span.begin] + test.time[span.end]) - start;
  }
  Creep best;
  double least = std::numeric_limits<double>::max(), trial = times(count - 1);
  for (int k = 0; k < k_trials && trial > 0.01 * times(0); ++k, trial *= k_fraction) {
    const Line line = fit_line((times / trial).log1p(), middles);
    if (line.square >= least) continue;
    least = line.square;
    best = {line.slope, trial, start, std::sqrt(line.square / static_cast<double>(count))};
  }
  return best;
}

std::optional<Play> find_play(const PreparedTest& test) {
  std::vector<const Cycle*> cycles;
  for (std::size_t k = test.cycles.size() / 2; k < test.cycles.size(); ++k) {
    if (!test.cycles[k].open && test.cycles[k].followed()) cycles.push_back(&test.cycles[k]);
  }
  if (cycles.empty()) return std::nullopt;
  double low = std::numeric_limits<double>::max(), high = -low, stroke = 0.0;
  for (const Cycle* cycle : cycles) {
    const auto first = test.smooth_force.begin() + static_cast<std::ptrdiff_t>(cycle->span.begin);
    const auto [least, most] =
        std::minmax_element(first, first + static_cast<std::ptrdiff_t>(cycle->span.end - cycle->span.begin) + 1);
    low = std::min(low, *least);
    high = std::max(high, *most);
    stroke = std::max(stroke, range_of(test.displacement, cycle->span));
  }
  const double band = std::max(k_standing * (high - low), 3.0 * noise_level(test.smooth_force));
  const Standing up = find_standing(test, cycles, true, low, high, band);
  const Standing down = find_standing(test, cycles, false, low, high, band);
  const double apart = std::abs(up.force - down.force);
  const bool slack = std::min(up.slackness, down.slackness) > k_slack && apart < k_apart * (high - low);
  if (!slack || std::min(up.length, down.length) < k_least_play * stroke) return std::nullopt;
  Play play;
  play.width = 0.5 * (up.length + down.length);
  play.force = 0.5 * (up.force + down.force);
  play.band = 0.5 * apart + band;
  play.slackness = std::min(up.slackness, down.slackness);
  return play;
}

std::optional<Conditioning> fit_conditioning(const std::vector<double>& force_ranges) {
  const auto count = static_cast<Eigen::Index>(force_ranges.size());
  if (count < 4) return std::nullopt;
  const Eigen::ArrayXd ranges = Eigen::Map<const Eigen::ArrayXd>(force_ranges.data(), count);
  const Eigen::ArrayXd middles = Eigen::ArrayXd::LinSpaced(count, 0.5, static_cast<double>(count) - 0.5);
  Conditioning best;
  double least = std::numeric_limits<double>::max(), trial = static_cast<double>(count);
  for (int n = 0; n < k_trials && trial > 0.3; ++n, trial *= 0.9) {
    const Line line = fit_line((-middles / trial).exp(), ranges);
    if (line.square >= least || !(line.offset > 0.0)) continue;
    least = line.square;
    best = {line.offset, line.slope / line.offset, trial};
  }
  return best.settled > 0.0 ? std::optional(best) : std::nullopt;
}

}  // namespace grouser
