#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "simulator/track_watch.h"
#include "tests/support/plane_vehicle.h"
#include "tests/support/vehicle_run.h"
#include "tests/validation/chapters.h"

namespace grouser::validation {
namespace {

using namespace grouser::test;

constexpr double k_joint_stiffness = 1e8;  // N/m, of linear_bushing

/// The links of the left track's upper run, from front to rear, as numbers in the link arrays.
std::vector<int> upper_run(const VehicleScene& scene) {
  const CompiledTrack& track = scene.system.tracks[0];
  const RunningGear& gear = scene.system.scenario.vehicle.side(Side::left);
  std::vector<int> links;
  for (int k = 0; k < track.num_links; ++k) {
    const Vector3d p = get_vector(scene.rest.state.position, track.offset + k);
    if (p.z() > gear.sprocket.center.z() + 0.2 && p.x() > gear.sprocket.center.x() &&
        p.x() < gear.idler.wheel.center.x())
      links.push_back(track.offset + k);
  }
  return links;
}

double mean_upper_tension(const VehicleScene& scene, const Stepper& stepper) {
  return upper_run_tension(scene.system, stepper.state(), stepper.work(), Side::left).mean;
}

/// Mean tension of the upper run at 45 rad/s, spun up in 2 s.
double tension_at_speed(const VehicleScene& at_rest, double tensioner_stiffness) {
  VehicleScene scene = at_rest;
  set_tensioner(tensioner_stiffness, scene);
  scene.system.scenario.drive.fill({{0.0, 2.0}, {0.0, 45.0}});
  double sum = 0.0, time = 0.0;
  follow(scene.system, scene.rest.state, scene.rest.knobs, 4.0, [&](const Stepper& stepper) {
    if (stepper.state().time < 3.0) return;
    sum += stepper.last_step() * mean_upper_tension(scene, stepper);
    time += stepper.last_step();
  });
  return sum / time;
}

/// slow_tension: mean of the upper run on the shipped tensioner while links pass slowly [N].
void add_hoop(const VehicleScene& scene, double slow_tension, Chapter& chapter) {
  const RunningGear& gear = scene.system.scenario.vehicle.side(Side::left);
  const double link_rate = 45.0 * gear.sprocket.teeth / (2.0 * k_pi), tensioner = gear.idler.tensioner_stiffness;
  const PlaneVehicle plane(scene.system.scenario.vehicle, k_joint_stiffness, scene.system.scenario.gravity);
  const PlaneVehicle::Rest rest = plane.stand(gear.track.pre_tension, tensioner);
  chapter.section(
      "Tension of a running track",
      "The vehicle on ice, its sprockets at 45 rad/s (50 km/h): the tracks run, the vehicle stays. What of ρ v² shows "
      "in "
      "the tension depends on the tensioner: all of it where its force is constant, less where it holds the length of "
      "the "
      "track's way. The shipped one is compared with itself at 0.5 rad/s, for the way round polygons changes as links "
      "pass.");
  const double spacing = gear.track.pitch + (gear.track.pre_tension + 28e3) / k_joint_stiffness;
  const double hoop = gear.track.link.mass * link_rate * link_rate * spacing;
  const double constant = tension_at_speed(scene, 1e3), stiff = tension_at_speed(scene, tensioner);
  chapter.add({"growth of the upper run's tension, tensioner of constant force", "kN", hoop / 1e3,
               (constant - gear.track.pre_tension) / 1e3,
               fraction(0.05, hoop / 1e3, "the idler swings back, its lever changes"),
               "closed form, ρ v² = m (N ω/2π)² (p + T/K)"});
  const auto add = [&](const char* quantity, double stiffness, double found, double before) {
    const double growth = plane.running_tension(rest, stiffness, link_rate) - gear.track.pre_tension;
    chapter.add({quantity, "kN", growth / 1e3, (found - before) / 1e3,
                 within(1.5, "rigid links in place of a smooth belt"),
                 "independent solution, belt round hull, arms and idler with −½ N m v² in its potential"});
  };
  add("the same, with the swing of the idler", 1e3, constant, gear.track.pre_tension);
  add("growth of the upper run's tension, tensioner as shipped", tensioner, stiff, slow_tension);
}

/// Mean place of the part of a pulse that runs to larger (or smaller) indices, in links from `middle`.
double pulse_place(const State& state, int middle, int direction) {
  double sum = 0.0, moment = 0.0;
  for (int k = 1; k <= 14; ++k) {
    const double v = std::max(0.0, state.velocity[0][middle + direction * k]);
    sum += v * v;
    moment += k * v * v;
  }
  return moment / sum;
}

void add_wave(const VehicleScene& scene, Chapter& chapter) {
  chapter.section(
      "Waves in the upper run",
      "The track at rest. A pulse of 0.05 m/s along the run, some links wide, parts into two; and half-waves "
      "of 10 mm/s across it, opposite in the two spans between support rollers.");
  const CompiledTrack& track = scene.system.tracks[0];
  const std::vector<int> run = upper_run(scene);
  const int middle = run[run.size() / 2];
  State state = scene.rest.state;
  for (int k = -12; k <= 12; ++k) state.velocity[0][middle + k] += 0.05 * std::exp(-0.5 * k * k / 9.0);
  close_chains(scene.system, state);
  const double early = 2.5e-3, late = 5e-3;  // s, when both have parted and before they reach the ends
  const auto distance = [&](double time) {
    const State then = follow(scene.system, state, scene.rest.knobs, time).state;
    return pulse_place(then, middle, 1) + pulse_place(then, middle, -1);
  };
  const double speed = 0.5 * track.pitch * (distance(late) - distance(early)) / (late - early);
  const double expected = track.pitch * std::sqrt(k_joint_stiffness / track.mass);
  chapter.add({"speed of a strain wave", "m/s", expected, speed,
               fraction(0.01, expected, "dispersion of a pulse of 3 links: κ²/24"), "closed form, p √(K/m)"});

  const std::vector<DiscPair>& rollers = scene.system.scenario.vehicle.side(Side::left).support_rollers;
  const double front = rollers[0].center.x(), mid = rollers[1].center.x(), rear = rollers[2].center.x();
  const auto shape = [&](int i) {
    const double x = get_vector(scene.rest.state.position, i).x();
    return x < front && x > rear ? std::sin(k_pi * (x - mid) / (front - mid)) : 0.0;
  };
  state = scene.rest.state;
  for (const int i : run) state.velocity[2][i] += 0.01 * shape(i);
  close_chains(scene.system, state);
  std::vector<double> times, heights;
  const double tension = mean_upper_tension(scene, Stepper(scene.system, scene.rest.state, scene.rest.knobs));
  follow(scene.system, state, scene.rest.knobs, 1.0, [&](const Stepper& stepper) {
    double sum = 0.0;
    for (const int i : run) sum += shape(i) * (stepper.state().position[2][i] - scene.rest.state.position[2][i]);
    times.push_back(stepper.state().time);
    heights.push_back(sum);
  });
  std::vector<double> crossings;
  for (std::size_t i = 1; i < times.size(); ++i) {
    if (heights[i - 1] * heights[i] < 0.0)
      crossings.push_back(times[i - 1] + (times[i] - times[i - 1]) * heights[i - 1] / (heights[i - 1] - heights[i]));
  }
  const double frequency = 0.5 * static_cast<double>(crossings.size() - 1) / (crossings.back() - crossings.front());
  const double string =
      std::sqrt(tension * (track.pitch + tension / k_joint_stiffness) / track.mass) / (2.0 * (front - mid));
  chapter.add({"frequency of the spans between support rollers", "Hz", string, frequency,
               fraction(0.04, string, "links half on the rollers, hinge stiffness"), "closed form, √(T/ρ) / 2L"});
}

/// Means over equal parts of a period.
class PhaseMean {
 public:
  void add(double phase, double value) {
    const auto bin = static_cast<std::size_t>((phase - std::floor(phase)) * k_bins);
    sum_[bin] += value;
    ++count_[bin];
  }
  [[nodiscard]] std::vector<double> means() const {
    std::vector<double> all;
    for (std::size_t i = 0; i < k_bins; ++i) all.push_back(sum_[i] / count_[i]);
    return all;
  }

 private:
  static constexpr std::size_t k_bins = 25;
  std::array<double, k_bins> sum_{}, count_{};
};

/// Velocity of a point of a link seen from the hull, in V.
Vector3d seen_from_hull(const TreeState& chassis, const Vector3d& p_W, const Vector3d& v_W) {
  const Vector3d w = chassis.orientation * chassis.angular_velocity;
  return chassis.orientation.conjugate() * Vector3d(v_W - chassis.velocity - w.cross(p_W - chassis.position));
}

/// Returns the mean tension of the upper run [N].
double add_ripple(VehicleScene scene, Chapter& chapter) {
  constexpr double k_rate = 0.5;  // rad/s
  const CompiledTrack& track = scene.system.tracks[0];
  const RunningGear& gear = scene.system.scenario.vehicle.side(Side::left);
  const double period = 2.0 * k_pi / gear.sprocket.teeth / k_rate;
  scene.system.scenario.drive.fill({{0.0, 1.0}, {0.0, k_rate}});
  chapter.section("Chordal action of the sprocket",
                  "The vehicle on ice, its sprockets at 0.5 rad/s: pins on the sprocket and the upper run next to it, "
                  "seen from the hull, mean over four links by phase.");
  PhaseMean near, pin, tension;
  double next = 1.0 + 0.5 * period;
  follow(scene.system, scene.rest.state, scene.rest.knobs, 1.0 + 4.5 * period, [&](const Stepper& stepper) {
    const State& state = stepper.state();
    if (state.time < next) return;
    next = state.time + 1e-3;
    const double phase = (state.time - 1.0) / period;
    tension.add(phase, mean_upper_tension(scene, stepper));
    for (int i = track.offset; i < track.offset + track.num_links; ++i) {
      const LinkMotion link = get_link(state, i);
      const Matrix3d R_VW = state.chassis.orientation.toRotationMatrix().transpose();
      const Vector3d p_V = R_VW * (link.position - state.chassis.position) + scene.system.chassis_center_V;
      const Vector3d velocity = seen_from_hull(state.chassis, link.position, link.velocity);
      const double behind = p_V.x() - gear.sprocket.center.x();
      if (p_V.z() > gear.sprocket.center.z() + 0.2 && behind > 0.35 && behind < 0.85) near.add(phase, velocity.x());
      const Vector3d arm_W = -(link.orientation * Vector3d(0.5 * track.pitch, 0.0, 0.0));
      const Vector3d pin_V = p_V + R_VW * arm_W - gear.sprocket.center;
      if (pin_V.x() > -0.28 || std::abs(pin_V.z()) > 0.1) continue;
      const Vector3d w = link.orientation * link.angular_velocity;
      pin.add(phase, seen_from_hull(state.chassis, link.position + arm_W, link.velocity + w.cross(arm_W)).norm());
    }
  });
  const std::vector<double> speeds = near.means(), pins = pin.means();
  const auto mean = [](const std::vector<double>& all) {
    double sum = 0.0;
    for (const double v : all) sum += v;
    return sum / static_cast<double>(all.size());
  };
  const double outer = track.sprocket.pitch_radius * k_rate, inner = outer * std::cos(k_pi / gear.sprocket.teeth);
  const double stretched = track.pitch + track.pre_tension / k_joint_stiffness;
  const double passing = gear.sprocket.teeth * stretched * k_rate / (2.0 * k_pi);
  const char* play = "play of the pins in their seats, 3 mm";
  const auto add = [&](const char* quantity, double expected, double found, const char* source) {
    chapter.add({quantity, "mm/s", 1e3 * expected, 1e3 * found, fraction(0.01, 1e3 * expected, play), source});
  };
  add("speed of pins on the sprocket, mean", outer, mean(pins), "closed form, R_p ω, R_p = p / (2 sin(π/10))");
  add("speed of the upper run, mean", passing, mean(speeds), "closed form, N (p + T/K) ω / 2π");
  add("speed of the upper run, largest", outer, *std::max_element(speeds.begin(), speeds.end()), "closed form, R_p ω");
  add("speed of the upper run, least", inner, *std::min_element(speeds.begin(), speeds.end()),
      "closed form, R_p ω cos(π/10)");
  return mean(tension.means());
}

}  // namespace

void add_vehicle_track(Chapter& chapter) {
  const VehicleScene scene = on_ice();
  add_wave(scene, chapter);
  const double slow_tension = add_ripple(scene, chapter);
  add_hoop(scene, slow_tension, chapter);
}

}  // namespace grouser::validation
