#include "simulator/results.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>

#include "simulator/drive.h"
#include "simulator/track_watch.h"

namespace grouser {
namespace {

constexpr double k_brisk = 5.0;  // m/s; below it link passing neither stands out nor shortens the step

class Sheet {
 public:
  explicit Sheet(RunSummary& summary) : summary_(summary) {}
  void result(const std::string& name, double value, const std::string& unit, const std::string& meaning) {
    summary_.results.push_back({name, value, unit, meaning});
  }
  void results(const std::vector<RunResult>& more) {
    summary_.results.insert(summary_.results.end(), more.begin(), more.end());
  }
  void check(const std::string& name, double value, const std::string& unit, const std::string& limit, bool pass) {
    summary_.checks.push_back({name, value, unit, limit, pass});
  }

 private:
  RunSummary& summary_;
};

void rest_results(const System& system, const Assembled& assembled, const RunMeasures& measures, Sheet& sheet) {
  const double ground = measures.rest_ground_force;
  sheet.result("rest_ground_force_N", ground, "N", "vertical ground force at rest, sum over all links");
  sheet.result("weight_N", system.weight, "N", "weight of the vehicle");
  sheet.check("Ground force at rest over weight", ground / system.weight, "1", "within 0.5 % of 1",
              std::abs(ground / system.weight - 1.0) <= 0.005);
  for (const Side side : {Side::left, Side::right}) {
    const auto s = static_cast<std::size_t>(index_of(side));
    const double asked = system.tracks[s].pre_tension, reached = assembled.sides[s].tension;
    sheet.result(fmt::format("{}_rest_tension_N", name_of(side)), reached, "N", "mean of the upper run at rest");
    sheet.check(fmt::format("Upper-run tension at rest over pre-tension, {}", name_of(side)), reached / asked, "1",
                fmt::format("within 5 % of {:.1f} kN", asked / 1e3), std::abs(reached / asked - 1.0) <= 0.05);
  }
  sheet.result("ride_height_change_m", assembled.ride_height_change, "m", "chassis origin at rest against design");
  sheet.result("rest_pitch_rad", assembled.pitch, "rad", "nose down > 0, at rest");
  sheet.result("rest_largest_link_speed_m_per_s", assembled.largest_link_speed, "m/s",
               "left of the settling at time 0");
  sheet.check("Largest link speed at rest", assembled.largest_link_speed, "m/s", "at most 0.01 m/s",
              assembled.largest_link_speed <= 0.01);
}

/// Speed at which a sprocket is to feed its track [m/s]; not for one that a torque drives.
double feed(const System& system, Side side, double time) {
  const auto s = static_cast<std::size_t>(index_of(side));
  const DriveTable& table = system.scenario.drive[s];
  const double asked = drive_motion(table, time).speed;
  return table.kind == DriveKind::cruise ? asked : asked * system.tracks[s].speed_per_sprocket_rate;
}

bool feeds_alike(const System& system, double time) {
  const double left = feed(system, Side::left, time), right = feed(system, Side::right, time);
  return std::abs(left - right) <= 1e-9 * std::max(std::abs(left), std::abs(right));
}

/// Both tracks are fed alike at every corner of both tables, and so all the time.
bool always_straight(const System& system) {
  for (const DriveTable& table : system.scenario.drive) {
    for (const double time : table.time) {
      if (!feeds_alike(system, time)) return false;
    }
  }
  return true;
}

void straight_results(const System& system, const RunMeasures& measures, const Interval& cruise, Sheet& sheet) {
  const double v = feed(system, Side::left, 0.5 * (cruise.from + cruise.to));
  const double speed = measures.straight_speed.value();
  sheet.result("cruise_speed_m_per_s", speed, "m/s", "mean forward speed while the sprockets hold their speed");
  sheet.check("Mean cruise speed", speed, "m/s", fmt::format("within 3 % of N p omega / 2 pi = {:.3f} m/s", v),
              std::abs(speed / v - 1.0) <= 0.03);
  const double passing = std::abs(v) / system.tracks[0].pitch;
  sheet.result("link_passing_frequency_Hz", passing, "Hz", "teeth times sprocket speed over 2 pi");
  const Interval heard = tone_window(cruise);
  if (heard.to - heard.from >= 1.0 && !measures.tone_time.empty()) {
    const SpectralLine line = spectral_line(measures.tone_time, measures.left_torque, heard.from, heard.to, passing);
    sheet.result("link_passing_torque_N_m", line.amplitude, "N m",
                 "amplitude of the left sprocket's torque at link passing");
    sheet.result("link_passing_torque_background_N_m", line.background, "N m", "median amplitude around it");
    if (std::abs(v) >= k_brisk && system.ground.level()) {  // rough ground drowns the line
      sheet.check("Link-passing line in the sprocket torque over its background", line.amplitude / line.background, "1",
                  "at least 20", line.amplitude >= 20.0 * line.background);
    }
  }
}

/// The left side stands as the mirror image of the right one, to the last bit: every difference in mass, stiffness or
/// geometry would show in where six seconds of settling end. Tracks of different lengths pull a vehicle aside.
bool stands_symmetric(const System& system, const State& rest) {
  const CompiledTrack &left = system.tracks[0], &right = system.tracks[1];
  if (left.num_links != right.num_links) return false;
  const auto same = [&](int component, double sign) {
    const double *a = rest.position[component] + left.offset, *b = rest.position[component] + right.offset;
    return std::equal(a, a + left.num_links, b, [sign](double l, double r) { return l == sign * r; });
  };
  return same(0, 1.0) && same(1, -1.0) && same(2, 1.0);
}

void whole_straight_run(const System& system, const RunMeasures& measures, bool symmetric, Sheet& sheet) {
  const Scenario& scenario = system.scenario;
  const double turned = drive_motion(scenario.drive[0], scenario.duration).angle;
  const double ideal = turned * system.tracks[0].speed_per_sprocket_rate;
  const double distance = measures.last.x - measures.first.x;
  sheet.result("distance_m", distance, "m", "way of the chassis origin along x");
  sheet.check("Distance", distance, "m", fmt::format("within 3 % of {:.1f} m", ideal),
              std::abs(distance - ideal) <= 0.03 * std::abs(ideal));
  const double drift = measures.largest_aside;
  sheet.result("lateral_drift_m", drift, "m", "largest |y| of the chassis origin");
  if (symmetric) sheet.check("Lateral drift", drift, "m", "under 0.02 m", drift < 0.02);
}

bool never_driven(const Scenario& scenario) {
  return std::all_of(scenario.drive.begin(), scenario.drive.end(), [](const DriveTable& table) {
    return table.kind == DriveKind::speed &&
           std::all_of(table.speed.begin(), table.speed.end(), [](double speed) { return speed == 0.0; });
  });
}

/// A vehicle whose sprockets never turn stays where it is.
void parked_results(const RunMeasures& measures, Sheet& sheet) {
  const double drift = measures.largest_way, speed = std::abs(measures.last.speed);
  sheet.result("parked_drift_m", drift, "m", "largest way of the chassis origin from where it stood at time 0");
  sheet.result("parked_speed_m_per_s", speed, "m/s", "forward speed at the end");
  sheet.check("Drift of the parked vehicle", drift, "m", "under 0.001 m", drift < 1e-3);
  sheet.check("Speed of the parked vehicle at the end", speed, "m/s", "under 0.001 m/s", speed < 1e-3);
}

void turn_results(const System& system, const RunMeasures& measures, const Interval& turn, Sheet& sheet) {
  const Vehicle& vehicle = system.scenario.vehicle;
  const double tread = vehicle.side(Side::left).track_center_y - vehicle.side(Side::right).track_center_y;
  const double mid = 0.5 * (turn.from + turn.to);
  const double no_slip = (feed(system, Side::right, mid) - feed(system, Side::left, mid)) / tread;
  const double rate = measures.turn_rate.value();
  sheet.result("yaw_rate_rad_per_s", rate, "rad/s", "mean steady yaw rate, left turn > 0");
  sheet.result("no_slip_yaw_rate_rad_per_s", no_slip, "rad/s", "(v_right - v_left) / tread");
  sheet.check("Yaw rate over the no-slip rate", rate / no_slip, "1", "between 0.5 and 1",
              rate / no_slip > 0.5 && rate / no_slip < 1.0);
  sheet.result("yaw_turned_rad", measures.last.yaw - measures.first.yaw, "rad", "heading change over the run");
  sheet.result("center_drift_m", std::hypot(measures.last.x - measures.first.x, measures.last.y - measures.first.y),
               "m", "way of the chassis origin");
}

/// The paper's Fig. 4 statement, and how far the rubber was driven beyond what was identified.
void step_results(const RunMeasures& measures, double speed, Sheet& sheet) {
  if (measures.rest_steps.count == 0 || measures.steady_steps.count == 0) return;
  sheet.result("rest_mean_step_s", measures.rest_steps.mean(), "s", "mean step while the sprockets are nearly still");
  sheet.result("steady_mean_step_s", measures.steady_steps.mean(), "s",
               "mean step while the sprockets hold their speed");
  const double ratio = measures.steady_steps.mean() / measures.rest_steps.mean();
  // Where stability bounds the steps they follow stiffness and friction, not the speed (P 3).
  if (std::abs(speed) < k_brisk || measures.steady_steps.by_error <= measures.steady_steps.by_stability) return;
  sheet.check("Mean step at speed over mean step at rest", ratio, "1", "under 1 (the paper's observation)",
              ratio < 1.0);
}

void range_results(const System& system, const RunMeasures& measures, Sheet& sheet) {
  for (int a = 0; a < k_num_axes; ++a) {
    const auto& valid = system.scenario.bushing.axes[static_cast<std::size_t>(a)].valid;
    if (!valid || valid->amplitude <= 0.0) continue;
    const double largest = measures.rubber.largest_deflection[static_cast<std::size_t>(a)];
    sheet.result(
        fmt::format("bushing_{}_largest_over_identified", k_axis_names[static_cast<std::size_t>(a)]),
        largest / valid->amplitude, "1",
        "largest deflection of a bushing over the largest one that was measured; above 1 the law is a straight line");
  }
}

void track_results(const RunMeasures& measures, Sheet& sheet) {
  sheet.results(rubber_results(measures.rubber));
  sheet.result("largest_guide_offset_m", measures.largest_guide_offset, "m",
               "of a link from the middle of a wheel it meets");
  double skipped = 0.0;
  for (const double teeth : measures.skipped_teeth) skipped = std::abs(teeth) > std::abs(skipped) ? teeth : skipped;
  skipped = std::round(skipped) + 0.0;  // what is left of a whole tooth is stretch and play; + 0.0: no "-0"
  sheet.result("skipped_teeth", skipped, "1", "links passed at the sprocket less teeth, whole ones, worse side");
  for (const Side side : {Side::left, Side::right}) {
    const SlackSpan& slack = measures.slack[static_cast<std::size_t>(index_of(side))];
    if (slack.time < 0.0) continue;
    sheet.result(fmt::format("{}_first_slack_time_s", name_of(side)), slack.time, "s",
                 "the span between sprocket and next road wheel first carries nothing: pins may climb the teeth");
    sheet.result(fmt::format("{}_first_slack_given_way_m", name_of(side)), slack.given_way, "m",
                 "of track, by which the idler had given way then");
  }
  sheet.check("Skipped teeth", skipped, "1", "none", skipped == 0.0);
  sheet.check("Track stays on: lateral offset in the guide", measures.largest_guide_offset, "m",
              fmt::format("under {} m", k_thrown_offset), measures.largest_guide_offset < k_thrown_offset);
  const auto samples = static_cast<double>(std::max(1L, measures.samples));
  for (std::size_t c = 0; c < k_num_contact_cases; ++c) {
    sheet.result(fmt::format("mean_contacts_{}", k_contact_case_names[c]), measures.case_total[c] / samples, "1",
                 "mean number of contacts of this case");
  }
}

}  // namespace

std::optional<Interval> steady_drive(const Scenario& scenario) {
  std::vector<double> corners{0.0, scenario.duration};
  for (const DriveTable& table : scenario.drive) {
    if (table.kind == DriveKind::torque) return std::nullopt;
    corners.insert(corners.end(), table.time.begin(), table.time.end());
  }
  std::sort(corners.begin(), corners.end());
  std::optional<Interval> best;
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    const double from = std::max(0.0, corners[i]), to = std::min(scenario.duration, corners[i + 1]);
    if (to - from < 0.5) continue;
    const auto wanted = [](const DriveTable& table, double time) {
      return table_value(table.time, table.value(), time);
    };
    const auto changes = [&](const DriveTable& table) { return wanted(table, from) != wanted(table, to); };
    const auto stands = [&](const DriveTable& table) { return wanted(table, from) == 0.0; };
    if (std::any_of(scenario.drive.begin(), scenario.drive.end(), changes)) continue;
    if (std::all_of(scenario.drive.begin(), scenario.drive.end(), stands)) continue;
    if (!best || to - from > best->to - best->from) best = Interval{from, to};
  }
  return best;
}

Interval straight_window(const Interval& steady) {
  return {steady.from + 0.5, steady.to};  // half a second after a corner the vehicle still pitches
}

Interval turn_window(const Interval& steady) {
  return {steady.from + std::min(1.0, 0.5 * (steady.to - steady.from)), steady.to};
}

Interval tone_window(const Interval& steady) {
  constexpr double k_longest = 10.0;  // s; bins of 0.1 Hz. The work grows with the square of it.
  const Interval all = straight_window(steady);
  return {std::max(all.from, all.to - k_longest), all.to};
}

SpectralLine spectral_line(const std::vector<double>& time, const std::vector<double>& value, double from, double to,
                           double frequency) {
  std::vector<double> t, x;
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (time[i] >= from && time[i] <= to) t.push_back(time[i]), x.push_back(value[i]);
  }
  if (t.size() < 16) return {};
  double mean = 0.0;
  for (const double v : x) mean += v;
  mean /= static_cast<double>(x.size());
  const double span = t.back() - t.front();
  const auto amplitude = [&](double f) {
    std::complex<double> sum = 0.0;
    double weight = 0.0;
    for (std::size_t i = 0; i < t.size(); ++i) {
      const double u = (t[i] - t.front()) / span, hann = 0.5 - 0.5 * std::cos(2.0 * k_pi * u);
      sum += hann * (x[i] - mean) * std::polar(1.0, -2.0 * k_pi * f * t[i]);
      weight += hann;
    }
    return 2.0 * std::abs(sum) / weight;
  };
  const double bin = 1.0 / span;
  SpectralLine line;
  std::vector<double> around;
  for (double f = std::max(bin, frequency - 20.0); f <= frequency + 20.0; f += bin) {
    const double a = amplitude(f);
    if (std::abs(f - frequency) <= 0.02 * frequency) {
      line.amplitude = std::max(line.amplitude, a);
    } else {
      around.push_back(a);
    }
  }
  line.amplitude = std::max(line.amplitude, amplitude(frequency));
  std::nth_element(around.begin(), around.begin() + static_cast<std::ptrdiff_t>(around.size() / 2), around.end());
  line.background = around[around.size() / 2];
  return line;
}

void add_results(const System& system, const Assembled& assembled, const RunMeasures& measures, const EnergyBook& book,
                 RunSummary& summary) {
  Sheet sheet(summary);
  rest_results(system, assembled, measures, sheet);
  if (measures.samples >= 2 && summary.status == RunStatus::completed) {
    const Scenario& scenario = system.scenario;
    if (const std::optional<Interval> steady = steady_drive(scenario)) {
      if (always_straight(system)) {
        straight_results(system, measures, *steady, sheet);
        if (system.ground.level() && scenario.drive[0].kind == DriveKind::speed)
          whole_straight_run(system, measures, stands_symmetric(system, assembled.state), sheet);
      } else if (!feeds_alike(system, 0.5 * (steady->from + steady->to))) {
        turn_results(system, measures, *steady, sheet);
      }
    } else if (never_driven(scenario)) {
      parked_results(measures, sheet);
    }
  }
  const std::optional<Interval> steady = steady_drive(system.scenario);
  const double mid = steady ? 0.5 * (steady->from + steady->to) : 0.0;
  step_results(measures, steady ? 0.5 * (feed(system, Side::left, mid) + feed(system, Side::right, mid)) : 0.0, sheet);
  track_results(measures, sheet);
  range_results(system, measures, sheet);
  sheet.check("Energy residual over the integral of |sprocket power|", book.residual_fraction(), "1", "under 1e-3",
              book.residual_fraction() < 1e-3);
  sheet.result("final_speed_m_per_s", measures.last.speed, "m/s", "forward speed at the end");
}

}  // namespace grouser
