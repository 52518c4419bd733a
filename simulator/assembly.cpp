#include "simulator/assembly.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/errors.h"
#include "simulator/bushings.h"
#include "simulator/failures.h"
#include "simulator/start_pose.h"
#include "simulator/track_path.h"
#include "simulator/track_watch.h"

namespace grouser {
namespace {

constexpr long k_steps_between_reports = 500;
constexpr double k_slack = 0.02;        // m, pin line shorter than the track at the start
constexpr double k_ramp_time = 0.6;     // s, stiffness from 2 % to 100 %
constexpr double k_free_time = 0.75;    // s, settling without damping at the end; as long for the fading before it
constexpr double k_mass_damping = 5.0;  // 1/s, near critical for heave and pitch of a tracked vehicle (0.6 to 1 Hz)
constexpr double k_tension_gain = 1.5;  // rad/s of tensioner reference a relative tension error
constexpr double k_largest_idler_turn = 0.9;  // rad

/// Idler angle nearest to design at which the pin line has the wanted length; tightens > 0 if a larger angle lengthens
/// the line.
struct IdlerAngle {
  double angle = 0.0;
  double tightens = 1.0;
};

IdlerAngle close_track(const RunningGear& gear, Side side) {
  const double wanted = gear.track.num_links * gear.track.pitch - k_slack;
  const auto excess = [&](double angle) { return path_length(path_wheels(gear, angle)) - wanted; };
  constexpr double k_scan = 0.005;
  for (double reach = 0.0; reach < k_largest_idler_turn; reach += k_scan) {
    for (const double sign : {1.0, -1.0}) {
      double low = sign * reach, high = sign * (reach + k_scan);
      if (!(excess(low) * excess(high) <= 0.0)) continue;
      for (int i = 0; i < 60; ++i) {
        const double mid = 0.5 * (low + high);
        (excess(low) * excess(mid) <= 0.0 ? high : low) = mid;
      }
      return {low, excess(low + 1e-3) > excess(low) ? 1.0 : -1.0};
    }
  }
  throw NumericalError(fmt::format(
      "assembly of the {} track: {} links of {:.4f} m are {:.3f} m long, the way round the running gear is "
      "{:.3f} m at design and "
      "the idler cannot make up the difference within {:.1f} rad; change the number of links, the pitch or the idler",
      name_of(side), gear.track.num_links, gear.track.pitch, gear.track.num_links * gear.track.pitch,
      path_length(path_wheels(gear, 0.0)), k_largest_idler_turn));
}

/// Turns the sprocket (nearest way) so that a gap stands under the pin nearest to its outermost point.
double sprocket_phase(const RunningGear& gear, const std::vector<PathPoint>& pins) {
  const Vector3d& center = gear.sprocket.center;
  const double outward = center.x() < gear.idler.wheel.center.x() ? -1.0 : 1.0;
  double best = 1e9, phase = 0.0;
  const double step = 2.0 * k_pi / gear.sprocket.teeth;
  for (const PathPoint& pin : pins) {
    const double dx = pin.x - center.x(), dz = pin.z - center.z();
    const double off = std::hypot(dx - outward * gear.sprocket.tip_radius, dz);
    if (off < best) {
      best = off;
      phase = -std::remainder(std::atan2(dz, dx), step);
    }
  }
  return phase;
}

void place_links_on_path(const CompiledTrack& track, const RunningGear& gear, const std::vector<PathPoint>& pins,
                         State& state) {
  for (int k = 0; k < track.num_links; ++k) {
    const PathPoint &a = pins[static_cast<std::size_t>(k)],
                    &b = pins[static_cast<std::size_t>((k + 1) % track.num_links)];
    const double pitch_down = -std::atan2(b.z - a.z, b.x - a.x);
    const int i = track.offset + k;
    state.position[0][i] = 0.5 * (a.x + b.x);
    state.position[1][i] = gear.track_center_y;
    state.position[2][i] = 0.5 * (a.z + b.z);
    state.orientation[0][i] = std::cos(0.5 * pitch_down);
    state.orientation[2][i] = std::sin(0.5 * pitch_down);
  }
}

double largest_link_speed(const System& system, const State& state) {
  double largest = 0.0;
  for (const CompiledTrack& track : system.tracks) {
    for (int i = track.offset; i < track.offset + track.num_links; ++i) {
      largest = std::max(largest, std::hypot(state.velocity[0][i], state.velocity[1][i], state.velocity[2][i]));
    }
  }
  return largest;
}

/// The settling itself: turns the knobs over time and steps until time 0.
class Settling {
 public:
  Settling(const System& system, State start, const std::array<IdlerAngle, k_num_sides>& idlers)
      : system_(system), idlers_(idlers), stepper_(system, std::move(start), first_knobs(idlers)) {}

  void run(const Progress& progress) {
    const double total = system_.scenario.assembly.settle_time;
    long steps = 0;
    while (stepper_.state().time < 0.0) {
      const double elapsed = stepper_.state().time + total;
      turn_knobs(elapsed, total);
      if (const StepStatus status = stepper_.step(0.0); status != StepStatus::ok) {
        throw NumericalError(
            fmt::format("assembly, {:.3f} s after its start: {}", elapsed, step_failure(system_, stepper_, status)));
      }
      if (progress && steps++ % k_steps_between_reports == 0 && !progress({elapsed / total, "assembly"}))
        throw Interrupted("in the assembly");
    }
  }
  [[nodiscard]] const Stepper& stepper() const { return stepper_; }

 private:
  static AssemblyKnobs first_knobs(const std::array<IdlerAngle, k_num_sides>& idlers) {
    AssemblyKnobs knobs;
    knobs.stiffness_scale = 0.02;
    knobs.mass_damping = k_mass_damping;
    knobs.rubber_memory = false;
    for (std::size_t s = 0; s < k_num_sides; ++s) knobs.tensioner_reference[s] = idlers[s].angle;
    return knobs;
  }

  void turn_knobs(double elapsed, double total) {
    const double left = total - elapsed;
    AssemblyKnobs& knobs = stepper_.knobs;
    knobs.stiffness_scale = std::min(1.0, 0.02 * std::pow(50.0, elapsed / k_ramp_time));
    knobs.mass_damping = k_mass_damping * std::clamp((left - k_free_time) / k_free_time, 0.0, 1.0);
    knobs.rubber_memory = left < 2.0 * k_free_time;
    if (elapsed < k_ramp_time + 0.1 || left < k_free_time) return;
    for (const Side side : {Side::left, Side::right}) {
      const auto s = static_cast<std::size_t>(index_of(side));
      const double wanted = system_.tracks[s].pre_tension;
      const double tension = upper_run_tension(system_, stepper_.state(), stepper_.work(), side).mean;
      const double rate = std::clamp(k_tension_gain * (wanted - tension) / wanted, -0.3, 0.3);
      knobs.tensioner_reference[s] += idlers_[s].tightens * rate * stepper_.last_step();
    }
  }

  const System& system_;
  std::array<IdlerAngle, k_num_sides> idlers_;
  Stepper stepper_;
};

/// The system with sprockets locked and steps free of the run's own choices.
System settling_system(const System& system) {
  System settling = system;
  DriveTable locked;
  locked.time = locked.speed = {0.0};
  settling.scenario.drive = {locked, locked};
  for (const int sprocket : system.sprocket_body)
    settling.tree.bodies[static_cast<std::size_t>(sprocket)].prescribed = true;
  IntegratorOptions& options = settling.scenario.integrator;
  options = IntegratorOptions{};
  options.velocity_tolerance = 0.05;
  options.displacement_tolerance = 5e-5;
  options.max_step = system.scenario.assembly.step;
  return settling;
}

void check_tension(const System& system, const Assembled& assembled) {
  for (const Side side : {Side::left, Side::right}) {
    const auto s = static_cast<std::size_t>(index_of(side));
    const double wanted = system.tracks[s].pre_tension, reached = assembled.sides[s].tension;
    if (std::abs(reached - wanted) <= 0.05 * wanted) continue;
    throw NumericalError(
        fmt::format("assembly of the {} track: asked for a pre-tension of {:.2f} kN, reached {:.2f} kN with the idler "
                    "arm at {:.3f} rad; "
                    "give assembly more settle_time, or a tensioner that can reach it",
                    name_of(side), wanted / 1e3, reached / 1e3, assembled.sides[s].idler_angle));
  }
}

void check_rest(const Assembled& assembled) {
  constexpr double k_moving = 0.1;  // m/s, ten times what a run's own check lets pass
  if (assembled.largest_link_speed <= k_moving) return;
  throw NumericalError(
      fmt::format("assembly: the vehicle does not come to rest, a link still moves at {:.3f} m/s; give assembly more "
                  "settle_time, or start it on flatter ground or on ground with more friction",
                  assembled.largest_link_speed));
}

}  // namespace

Assembled assemble(const System& system, const Progress& progress) {
  const Vehicle& vehicle = system.scenario.vehicle;
  State start = make_state(system);
  start.time = -system.scenario.assembly.settle_time;
  start.chassis.position = system.chassis_center_V;
  std::array<IdlerAngle, k_num_sides> idlers;
  for (const Side side : {Side::left, Side::right}) {
    const auto s = static_cast<std::size_t>(index_of(side));
    const RunningGear& gear = vehicle.side(side);
    idlers[s] = close_track(gear, side);
    const std::vector<PathPoint> pins = path_pins(path_wheels(gear, idlers[s].angle), gear.track.num_links);
    place_links_on_path(system.tracks[s], gear, pins, start);
    start.chassis.angle[system.idler_arm_body[s]] = idlers[s].angle;
    start.chassis.angle[system.sprocket_body[s]] = sprocket_phase(gear, pins);
  }
  close_chains(system, start);
  const StartPose pose = start_pose(system);
  if (!system.ground.level()) put_down(system, pose, start);
  place_connectors(system, start);

  const System settling_copy = settling_system(system);
  Settling settling(settling_copy, std::move(start), idlers);
  settling.run(progress);

  const Stepper& stepper = settling.stepper();
  Assembled assembled;
  assembled.state = stepper.state();
  assembled.knobs = stepper.knobs;
  assembled.knobs.stiffness_scale = 1.0;
  assembled.knobs.mass_damping = 0.0;
  assembled.knobs.rubber_memory = true;
  for (const Side side : {Side::left, Side::right}) {
    const auto s = static_cast<std::size_t>(index_of(side));
    assembled.sides[s] = {upper_run_tension(system, stepper.state(), stepper.work(), side).mean,
                          stepper.state().chassis.angle[system.idler_arm_body[s]]};
    // A driver takes over at the torque that held the sprocket.
    assembled.state.driver[s] = stepper.work().chassis.joint_torque[system.sprocket_body[s]];
  }
  const Matrix3d R_WV = assembled.state.chassis.orientation.toRotationMatrix();
  const Vector3d origin = assembled.state.chassis.position - R_WV * system.chassis_center_V;
  assembled.ride_height_change = pose.rotation.col(2).dot(origin - pose.plane);
  assembled.pitch = -std::asin(std::clamp(R_WV(2, 0), -1.0, 1.0));
  assembled.largest_link_speed = largest_link_speed(system, assembled.state);
  check_tension(system, assembled);
  check_rest(assembled);
  return assembled;
}

}  // namespace grouser
