#include "test_data/generator/campaign.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace grouser {
namespace {

constexpr double k_pi = std::numbers::pi;
constexpr double k_degree = k_pi / 180.0;
constexpr double k_ten_tons = 10.0e3 * 9.80665;  // N
constexpr int k_substeps = 8;                    // of a sample, for the rubber

std::uint64_t seed_of(std::uint64_t seed, const std::string& name) {
  std::uint64_t hash = 1469598103934665603ULL ^ seed;  // FNV-1a
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  return hash;
}

double rounded(double value, double quantum) { return quantum > 0.0 ? std::round(value / quantum) * quantum : value; }

// Displacement of a symmetric ramp after a time: 0 -> +a -> -a -> 0.
double triangle(double phase, double amplitude) {
  const double p = phase - std::floor(phase);
  return amplitude * (p < 0.25 ? 4.0 * p : (p < 0.75 ? 2.0 - 4.0 * p : 4.0 * p - 4.0));
}

struct History {
  std::vector<double> time, displacement, force;
};

// Virgin rubber is stiffer and settles over its first cycles (Mullins).
double virgin_stiffening(const RigErrors& errors, double cycles_done) {
  return 1.0 + errors.conditioning * std::exp(-cycles_done / errors.conditioning_cycles);
}

// Samples of a path that is known in advance (sine about a preset, symmetric triangle).
History run_known_path(const TrueRubber& rubber, const PlannedTest& plan, const RigErrors& errors) {
  const bool ramp = plan.kind == TestKind::static_ramp;
  const double period = ramp ? 4.0 * plan.amplitude / plan.rate : 1.0 / plan.frequency;
  const double step = period / plan.samples_per_cycle;
  RubberState state(rubber);
  if (plan.preset != 0.0) {  // the specimen is turned to its preset in 10 s and rests a minute before the record starts
    for (int i = 1; i <= 1000; ++i) state.advance(plan.preset * i / 1000.0, 0.01);
    for (int i = 0; i < 600; ++i) state.advance(plan.preset, 0.1);
  }
  History history;
  for (int i = 0; i <= plan.cycles * plan.samples_per_cycle; ++i) {
    double force = 0.0, x = plan.preset;
    for (int s = i == 0 ? k_substeps : 1; s <= k_substeps; ++s) {
      const double phase = (i - 1 + static_cast<double>(s) / k_substeps) / plan.samples_per_cycle;
      x = plan.preset + (ramp ? triangle(phase, plan.amplitude) : plan.amplitude * std::sin(2.0 * k_pi * phase));
      force = state.advance(x, step / k_substeps);
    }
    history.time.push_back(i * step);
    history.displacement.push_back(x);
    history.force.push_back(virgin_stiffening(errors, static_cast<double>(i) / plan.samples_per_cycle) * force);
  }
  return history;
}

// Tension only: out at constant rate until the peak force, back until the force is gone.
History run_to_force(const TrueRubber& rubber, const PlannedTest& plan, const RigErrors& errors) {
  const double step = 4.0 * plan.amplitude / plan.rate / plan.samples_per_cycle;
  RubberState state(rubber);
  History history{{0.0}, {0.0}, {0.0}};
  double direction = 1.0, travelled = 0.0;
  for (int turns = 0; turns < 2 * plan.cycles;) {
    double x = history.displacement.back(), force = 0.0;
    for (int s = 0; s < k_substeps; ++s) {
      x += direction * plan.rate * step / k_substeps;
      force = state.advance(x, step / k_substeps);
    }
    travelled += plan.rate * step;
    force *= virgin_stiffening(errors, travelled / (4.0 * plan.amplitude));
    history.time.push_back(history.time.back() + step);
    history.displacement.push_back(x);
    history.force.push_back(force);
    if (direction > 0.0 ? force >= plan.peak_force : force <= 0.0) direction = -direction, ++turns;
  }
  return history;
}

History run_rubber(const TrueRubber& rubber, const PlannedTest& plan, const RigErrors& errors) {
  return plan.peak_force > 0.0 ? run_to_force(rubber, plan, errors) : run_known_path(rubber, plan, errors);
}

std::size_t start_of_last_cycle(const History& history, const PlannedTest& plan) {
  if (plan.peak_force <= 0.0) return history.time.size() - 1 - static_cast<std::size_t>(plan.samples_per_cycle);
  std::size_t i = history.displacement.size() - 1;
  while (history.displacement[i - 1] >= history.displacement[i]) --i;  // up the last unloading
  while (history.displacement[i - 1] <= history.displacement[i]) --i;  // down the last loading
  return i;
}

// Fundamental of the force over that of the displacement, in phase.
double storage_stiffness(const std::vector<double>& x, const std::vector<double>& f) {
  double mean_x = 0.0, mean_f = 0.0, sxx = 0.0, sxf = 0.0;
  const std::size_t n = x.size() - 1;
  for (std::size_t i = 0; i < n; ++i) mean_x += x[i] / static_cast<double>(n), mean_f += f[i] / static_cast<double>(n);
  for (std::size_t i = 0; i < n; ++i)
    sxx += (x[i] - mean_x) * (x[i] - mean_x), sxf += (x[i] - mean_x) * (f[i] - mean_f);
  return sxf / sxx;
}

LoopMeasures true_measures(const std::vector<double>& x, const std::vector<double>& f, double frequency) {
  LoopMeasures measures;
  const auto [x_low, x_high] = std::minmax_element(x.begin(), x.end());
  const auto [f_low, f_high] = std::minmax_element(f.begin(), f.end());
  const double amplitude = 0.5 * (*x_high - *x_low);
  measures.effective_stiffness = (*f_high - *f_low) / (2.0 * amplitude);
  double area = 0.5 * (f.front() + f.back()) * (x.front() - x.back());
  for (std::size_t i = 1; i < x.size(); ++i) area += 0.5 * (f[i] + f[i - 1]) * (x[i] - x[i - 1]);
  measures.dissipated_energy = area;
  measures.loss_factor = area / (k_pi * measures.effective_stiffness * amplitude * amplitude);
  measures.equivalent_damping = area / (2.0 * k_pi * frequency * k_pi * amplitude * amplitude);
  return measures;
}

void add_errors(const RigErrors& errors, PortableRandom& random, GeneratedTest& test) {
  const double offset = errors.force_offset * random.normal(), drift = errors.force_drift * random.normal();
  const double gain = 1.0 + errors.remounting_gain * random.normal();
  const double zero = errors.displacement_zero * random.normal();
  const double duration = test.time.back();
  for (std::size_t i = 0; i < test.time.size(); ++i) {
    const double done = test.time[i] / duration;
    const double force = gain * test.force[i];
    const double displacement = test.displacement[i] + errors.compliance * force + zero;
    test.displacement[i] =
        rounded(displacement + errors.displacement_noise * random.normal(), errors.displacement_quantum);
    test.force[i] = rounded(force + offset + drift * done + errors.force_noise * random.normal(), errors.force_quantum);
  }
}

std::string number(double value) { return fmt::format("{:g}", value); }

// Loops of one axis; `unit` is what amplitudes are counted in (mm or degree) and `unit_name` how the test is called.
void add_loops(AxisCampaign& axis, const std::vector<double>& amplitudes, const std::vector<double>& frequencies,
               double unit, const char* unit_name, double preset = 0.0) {
  for (const double amplitude : amplitudes) {
    for (const double frequency : frequencies) {
      PlannedTest test;
      test.name = fmt::format("{}_loop_{}{}_{}hz", name_of(axis.axis), number(amplitude), unit_name, number(frequency));
      test.axis = axis.axis;
      test.amplitude = amplitude * unit;
      test.frequency = frequency;
      test.preset = preset;
      test.cycles = 9;
      test.samples_per_cycle = 150;
      axis.tests.push_back(test);
    }
  }
}

void add_ramp(AxisCampaign& axis, double amplitude, double rate, double peak_force = 0.0) {
  PlannedTest test;
  test.name = fmt::format("{}_static", name_of(axis.axis));
  test.axis = axis.axis;
  test.kind = TestKind::static_ramp;
  test.amplitude = amplitude;
  test.rate = rate;
  test.peak_force = peak_force;
  test.cycles = 6;
  test.samples_per_cycle = 240;
  axis.tests.push_back(test);
}

// Errors of a rig whose load cell has `full_scale` (N or N m) and whose transducer resolves `fine` (m or rad).
RigErrors rig_errors(double full_scale, double fine) {
  RigErrors errors;
  errors.displacement_noise = fine;
  errors.displacement_quantum = 0.0;  // the converter's steps are added where volts are written
  errors.force_noise = 1e-3 * full_scale;
  errors.force_offset = 3e-3 * full_scale;
  errors.force_drift = 2e-3 * full_scale;
  errors.displacement_zero = 4.0 * fine;
  errors.remounting_gain = 3e-3;
  errors.conditioning = 0.12;
  errors.conditioning_cycles = 1.1;
  return errors;
}

AxisCampaign make_axis(Axis axis, double stiffness, double stroke, double full_scale, double fine, std::uint64_t seed) {
  AxisCampaign campaign;
  campaign.axis = axis;
  campaign.rubber = make_rubber(stiffness, stroke, seed_of(seed, name_of(axis)));
  campaign.errors = rig_errors(full_scale, fine);
  return campaign;
}

}  // namespace

std::vector<AxisCampaign> reference_campaign(std::uint64_t seed) {
  constexpr double mm = 1e-3, per_minute = 1.0 / 60.0;
  std::vector<AxisCampaign> all;
  AxisCampaign x = make_axis(Axis::x, 0.95e8, 1.0 * mm, 100e3, 0.5e-6, seed);
  add_ramp(x, 0.5 * mm, 2.0 * mm * per_minute, k_ten_tons);
  add_loops(x, {0.05, 0.1, 0.2, 0.5}, {0.1, 1.0, 5.0, 20.0, 70.0}, mm, "mm");
  AxisCampaign y = make_axis(Axis::y, 2.0e7, 2.0 * mm, 40e3, 0.5e-6, seed);
  add_ramp(y, 1.5 * mm, 4.0 * mm * per_minute);
  add_loops(y, {0.1, 0.3, 1.0}, {0.1, 2.0, 30.0}, mm, "mm");
  AxisCampaign z = make_axis(Axis::z, 0.85e8, 1.0 * mm, 100e3, 0.5e-6, seed);
  add_ramp(z, 0.8 * mm, 2.0 * mm * per_minute);
  add_loops(z, {0.05, 0.15, 0.5}, {0.1, 2.0, 30.0}, mm, "mm");
  for (AxisCampaign* axis : {&x, &y, &z}) axis->errors.compliance = 4e-10;

  AxisCampaign rx = make_axis(Axis::rx, 4.0e6, 0.4 * k_degree, 25e3, 2e-4 * k_degree, seed);
  AxisCampaign rz = make_axis(Axis::rz, 4.2e6, 0.4 * k_degree, 25e3, 2e-4 * k_degree, seed);
  for (AxisCampaign* axis : {&rx, &rz}) {
    add_ramp(*axis, 0.25 * k_degree, 1.0 * k_degree * per_minute);
    add_loops(*axis, {0.05, 0.15}, {0.1, 2.0, 30.0}, k_degree, "deg");
  }
  AxisCampaign ry = make_axis(Axis::ry, 1600.0, 45.0 * k_degree, 1.2e3, 0.01 * k_degree, seed);
  add_ramp(ry, 36.0 * k_degree, 120.0 * k_degree * per_minute);
  add_loops(ry, {5.0, 10.0, 20.0}, {0.1, 1.0, 5.0, 10.0}, k_degree, "deg", 14.0 * k_degree);
  for (AxisCampaign* axis : {&x, &y, &z, &rx, &ry, &rz}) all.push_back(std::move(*axis));
  return all;
}

AxisCampaign large_torsion_campaign(bool with_stop, std::uint64_t seed) {
  AxisCampaign ry = make_axis(Axis::ry, 1600.0, 45.0 * k_degree, 1.2e3, 0.01 * k_degree, seed);
  if (with_stop) {
    ry.rubber.hard_stop = 52.0 * k_degree;
    ry.rubber.hard_stop_width = 1.5 * k_degree;
    ry.rubber.hard_stop_stiffness = 9.0 * 1600.0;
  }
  add_ramp(ry, 60.0 * k_degree, 2.0 * k_degree);
  add_loops(ry, {5.0, 20.0, 46.0}, {0.1, 1.0, 5.0}, k_degree, "deg", 14.0 * k_degree);
  return ry;
}

GeneratedTest run_test(const AxisCampaign& campaign, const PlannedTest& plan, std::uint64_t seed) {
  GeneratedTest test;
  test.plan = plan;
  const History settled = run_rubber(campaign.rubber, plan, RigErrors{});
  const auto first = static_cast<std::ptrdiff_t>(start_of_last_cycle(settled, plan));
  test.true_displacement.assign(settled.displacement.begin() + first, settled.displacement.end());
  test.true_force.assign(settled.force.begin() + first, settled.force.end());
  const double period = settled.time.back() - settled.time[static_cast<std::size_t>(first)];
  test.truth = true_measures(test.true_displacement, test.true_force, 1.0 / period);
  test.storage_stiffness = storage_stiffness(test.true_displacement, test.true_force);

  History measured = run_rubber(campaign.rubber, plan, campaign.errors);
  test.time = std::move(measured.time);
  test.displacement = std::move(measured.displacement);
  test.force = std::move(measured.force);
  PortableRandom random(seed_of(seed, plan.name));
  test.tilt_per_force = 2e-10 * random.normal();
  add_errors(campaign.errors, random, test);
  return test;
}

Backbone true_backbone(const TrueRubber& rubber, double low, double high, double period) {
  constexpr int stations = 40, steps = 25, ramp = stations * steps;
  RubberState state(rubber);
  std::vector<double> up(stations + 1), down(stations + 1);
  for (int leg = 0; leg < 4; ++leg) {  // the first two settle it
    for (int i = 0; i <= ramp; ++i) {
      const double fraction = static_cast<double>(leg % 2 == 0 ? i : ramp - i) / ramp;
      const double force = state.advance(low + (high - low) * fraction, 0.5 * period / ramp);
      if (i % steps != 0) continue;
      if (leg % 2 == 0)
        up[static_cast<std::size_t>(i / steps)] = force;
      else
        down[static_cast<std::size_t>(stations - i / steps)] = force;
    }
  }
  Backbone backbone;
  for (int i = 0; i <= stations; ++i) {
    const auto at = static_cast<std::size_t>(i);
    backbone.displacement.push_back(low + (high - low) * i / stations);
    backbone.force.push_back(0.5 * (up[at] + down[at]));
  }
  return backbone;
}

Backbone true_backbone(const AxisCampaign& campaign) {
  const auto ramp = std::find_if(campaign.tests.begin(), campaign.tests.end(),
                                 [](const PlannedTest& t) { return t.kind == TestKind::static_ramp; });
  const History history = run_rubber(campaign.rubber, *ramp, RigErrors{});
  const std::size_t first = start_of_last_cycle(history, *ramp);
  const auto [low, high] = std::minmax_element(history.displacement.begin() + static_cast<std::ptrdiff_t>(first),
                                               history.displacement.end());
  return true_backbone(campaign.rubber, *low, *high, history.time.back() - history.time[first]);
}

}  // namespace grouser
