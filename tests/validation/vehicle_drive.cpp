#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "tests/support/vehicle_run.h"
#include "tests/validation/chapters.h"

namespace grouser::validation {
namespace {

using namespace grouser::test;

constexpr double k_cruise_from = 11.0, k_cruise_to = 13.0, k_stop = 17.0;  // s, run A
constexpr double k_coast_from = 3.0, k_coast = 2.0;                        // s

/// The vehicle's momentum along x and the impulse of the ground on it.
struct Impulse {
  double start = 0.0, end = 0.0, impulse = 0.0;  // N s
};

/// What is kept of run A.
struct StraightRun {
  ShortRun run;
  std::vector<double> time, x, y, speed;  // every ms
  std::vector<double> torque;             // N m, left sprocket
  double spacing = 0.0;                   // m, mean distance of neighbouring links between the end wheels, cruise
  double turning_rate = 0.0;              // rad/s, of links, mean weighted by their load, cruise
  Impulse brake;
  double braked_way = 0.0;  // m, what the sprocket lays down and the loaded links slip
  State coast_start;

  [[nodiscard]] double at(const std::vector<double>& series, double when) const {
    const auto i = static_cast<std::size_t>(std::lower_bound(time.begin(), time.end(), when) - time.begin());
    if (i == 0 || i == time.size()) return series[std::min(i, time.size() - 1)];
    return series[i - 1] + (series[i] - series[i - 1]) * (when - time[i - 1]) / (time[i] - time[i - 1]);
  }
};

/// Means over the ground run.
class GroundRun {
 public:
  explicit GroundRun(const System& system) : system_(system) {}
  void add(const Stepper& stepper) {
    const State& state = stepper.state();
    const std::vector<Station>& stations = system_.scenario.vehicle.side(Side::left).stations;
    const double origin = state.chassis.position.x() - system_.chassis_center_V.x();
    const double front = origin + stations.front().wheel.center.x(), rear = origin + stations.back().wheel.center.x();
    const Field& ground = stepper.work().contact_force_W[static_cast<std::size_t>(Partner::ground)];
    for (const CompiledTrack& track : system_.tracks) {
      for (int i = track.offset; i < track.offset + track.num_links; ++i) {
        const LinkMotion link = get_link(state, i);
        load_ += ground[2][i];
        moving_ += ground[2][i] * link.velocity.x();
        turning_ += ground[2][i] * (link.orientation * link.angular_velocity).y();
        const Vector3d next = get_vector(state.position, i + 1);
        const bool inside =
            link.position.x() > rear && next.x() < front && link.position.z() < 2.0 * track.ground_depth;
        if (!inside) continue;
        spacing_ += next.x() - link.position.x();
        ++count_;
      }
    }
  }
  [[nodiscard]] double spacing() const { return spacing_ / static_cast<double>(count_); }
  [[nodiscard]] double turning_rate() const { return turning_ / load_; }
  [[nodiscard]] double velocity() const { return moving_ / load_; }  ///< m/s, over the ground, weighted by load

 private:
  const System& system_;
  double load_ = 0.0, moving_ = 0.0, turning_ = 0.0, spacing_ = 0.0;
  long count_ = 0;
};

double ground_force_x(const Workspace& work) {
  double sum = 0.0;
  const Field& ground = work.contact_force_W[static_cast<std::size_t>(Partner::ground)];
  for (int i = 0; i < ground.length(); ++i) sum += ground[0][i];
  return sum;
}

double momentum_x(const System& system, const Stepper& stepper) {
  const CenterOfMass center = center_of_mass(system, stepper.state(), stepper.work());
  return center.mass * center.velocity.x();
}

StraightRun drive_run_a(const VehicleScene& scene) {
  StraightRun kept;
  GroundRun ground(scene.system);
  double next = 0.0;
  kept.run = follow(scene.system, scene.rest.state, scene.rest.knobs, k_stop, [&](const Stepper& stepper) {
    const State& state = stepper.state();
    if (kept.coast_start.time == 0.0 && state.time >= k_coast_from) kept.coast_start = state;
    if (state.time > k_cruise_to) {
      if (kept.brake.start == 0.0) {
        kept.brake.start = momentum_x(scene.system, stepper);
      } else {
        kept.brake.impulse +=
            0.5 * stepper.last_step() * (ground_force_x(stepper.work()) + ground_force_x(stepper.previous_work()));
      }
      kept.brake.end = momentum_x(scene.system, stepper);
    }
    if (state.time < next) return;
    next = state.time + 1e-3;
    kept.time.push_back(state.time);
    kept.x.push_back(state.chassis.position.x());
    kept.y.push_back(state.chassis.position.y());
    kept.speed.push_back(state.chassis.velocity.x());
    kept.torque.push_back(stepper.work().chassis.joint_torque[scene.system.sprocket_body[0]]);
    if (state.time > k_cruise_from && state.time < k_cruise_to) ground.add(stepper);
    if (state.time > k_cruise_to) {
      GroundRun now(scene.system);
      now.add(stepper);
      const double link_rate =
          state.chassis.rate[scene.system.sprocket_body[0]] * scene.system.tracks[0].sprocket.teeth / (2.0 * k_pi);
      kept.braked_way += (state.time - kept.time[kept.time.size() - 2]) * (link_rate * now.spacing() + now.velocity());
    }
  });
  kept.spacing = ground.spacing();
  kept.turning_rate = ground.turning_rate();
  return kept;
}

/// Frequency of the largest line of the torque while cruising, between 10 and 140 Hz.
double largest_line(const StraightRun& run) {
  std::vector<double> t, value;
  double mean = 0.0;
  for (std::size_t i = 0; i < run.time.size(); ++i) {
    if (run.time[i] < k_cruise_from || run.time[i] > k_cruise_to) continue;
    t.push_back(run.time[i]);
    value.push_back(run.torque[i]);
    mean += run.torque[i];
  }
  mean /= static_cast<double>(t.size());
  double best = 0.0, largest = 0.0;
  for (double f = 10.0; f < 140.0; f += 0.05) {
    std::complex<double> sum = 0.0;
    for (std::size_t i = 0; i < t.size(); ++i) {
      const double hann = 0.5 - 0.5 * std::cos(2.0 * k_pi * (t[i] - t.front()) / (t.back() - t.front()));
      sum += hann * (value[i] - mean) * std::polar(1.0, -2.0 * k_pi * f * t[i]);
    }
    if (std::abs(sum) > largest) largest = std::abs(sum), best = f;
  }
  return best;
}

void add_cruise(const System& system, const StraightRun& run, Chapter& chapter) {
  const CompiledTrack& track = system.tracks[0];
  const double rate = 45.0 * track.sprocket.teeth / (2.0 * k_pi), nominal = rate * track.pitch;
  const double cruise = (run.at(run.x, k_cruise_to) - run.at(run.x, k_cruise_from)) / (k_cruise_to - k_cruise_from);
  chapter.section(
      "Run A at 50 km/h",
      "Both sprockets at 45 rad/s, 11 s to 13 s. The vehicle is faster than N p ω/2π: its track is stretched, and it "
      "bends round every wheel that passes while the pads below hold the ground, h = 55 mm under the pins.");
  chapter.add({"speed", "m/s", nominal, cruise, fraction(0.02, nominal, "stretch, and the bend of loaded links"),
               "closed form, N p ω / 2π"});
  const double bent = rate * run.spacing + track.ground_depth * run.turning_rate;
  chapter.add({"speed, track stretched and bent", "m/s", bent, cruise,
               fraction(2e-3, bent, "pads that slip while their load comes and goes"),
               "closed form, f ℓ + h ω, f = N ω/2π; ℓ: measured distance of links on the ground, ω: their measured "
               "turning rate, weighted by load: no slip of the pads"});
  chapter.add({"frequency of the largest line in the sprocket's torque, 10 Hz to 140 Hz", "Hz", rate, largest_line(run),
               within(0.25, "half of 1 / 2 s"), "closed form, link passing N ω / 2π"});
}

void add_way(const System& system, const StraightRun& run, Chapter& chapter) {
  const double radius = system.tracks[0].speed_per_sprocket_rate, ideal = 45.0 * (5.0 + 3.0 + 2.0) * radius;
  chapter.section("Run A as a whole", "10 s up to 50 km/h, 3 s at that, 4 s down to rest.");
  chapter.add({"distance", "m", ideal, run.x.back() - run.x.front(),
               fraction(0.02, ideal, "overspeed as above, slip of the pads under power and brake"),
               "closed form, N p φ / 2π of the sprockets' turn φ"});
  double drift = 0.0;
  for (const double y : run.y) drift = std::max(drift, std::abs(y));
  chapter.add({"largest lateral drift", "mm", 0.0, 1e3 * drift, within(1.0, "1 mm over 139 m"), "symmetry"});
  const double speed = run.at(run.speed, k_cruise_to), way = run.at(run.x, k_stop) - run.at(run.x, k_cruise_to);
  const double braking = 0.5 * speed * (k_stop - k_cruise_to);
  chapter.add({"braking distance, 13 s to 17 s", "m", braking, way,
               fraction(0.04, braking, "pads slip forward under the brake, most where the hull dives"),
               "closed form, v²/2a, a = v / 4 s"});
  chapter.add({"the same, with the slip of the pads", "m", run.braked_way, way,
               fraction(0.01, run.braked_way, "the hull dives and swings above its tracks"),
               "closed form, ∫ (f ℓ + v) dt, ℓ: measured distance of links on the ground, v: their measured velocity "
               "over it, weighted by load"});
  const double lost = run.brake.end - run.brake.start;
  chapter.add({"impulse of the ground on the vehicle while it brakes", "kN s", lost / 1e3, run.brake.impulse / 1e3,
               fraction(1e-3, lost / 1e3, "sum over accepted steps"),
               "closed form, change of the momentum of all bodies"});
  chapter.add({"energy residual over ∫|sprocket power|", "", 0.0, run.run.book.residual_fraction(),
               within(2e-4, "second order in a step of the default tolerance"), "first law"});
}

void add_coast(const VehicleScene& scene, const State& start, Chapter& chapter) {
  System coasting = scene.system;
  DriveTable none;
  none.kind = DriveKind::torque;
  none.time = {0.0};
  none.torque = {0.0};
  coasting.scenario.drive.fill(none);
  for (const int sprocket : coasting.sprocket_body)
    coasting.tree.bodies[static_cast<std::size_t>(sprocket)].prescribed = false;
  coasting.scenario.integrator.fixed_step = 2e-5;  // the balance errs by 0.036 % at 80 us, by 0.009 % at 40 us
  const ShortRun run = follow(coasting, start, scene.rest.knobs, k_coast_from + k_coast);
  const double lost = run.book.start.stored() - run.book.now.stored();
  chapter.section("Coasting", "Sprockets let go at 3 s of run A, at 4.2 m/s, for 2 s, in steps of 20 µs.");
  chapter.add({"stored energy lost", "kJ", run.book.dissipated() / 1e3, lost / 1e3,
               fraction(1e-4, run.book.dissipated() / 1e3, "second order in the step"),
               "first law: losses of bushings, contacts, friction, ground, dampers"});
}

void add_order(const VehicleScene& scene, Chapter& chapter) {
  const auto residual = [&](double step) {
    System system = scene.system;
    system.scenario.drive.fill({{0.0, 1.0}, {0.0, 9.0}});
    system.scenario.integrator.fixed_step = step;
    return std::abs(follow(system, scene.rest.state, scene.rest.knobs, 0.3).book.residual());
  };
  const double coarse = residual(8e-5), fine = residual(2e-5);
  chapter.section("Energy at fixed steps", "The shipped vehicle sets off, 0.3 s at steps of 80 and 20 µs.");
  chapter.add({"order of the energy residual, 80 µs to 20 µs", "", 2.0, 0.5 * std::log2(coarse / fine),
               within(0.5, "corners of friction stops and of first touch"), "Chung and Lee 1994: second order"});
}

}  // namespace

void add_vehicle_drive(Chapter& chapter) {
  const VehicleScene scene = at_rest(shipped_scenario("run_a"));
  const StraightRun run = drive_run_a(scene);
  add_cruise(scene.system, run, chapter);
  add_way(scene.system, run, chapter);
  add_coast(scene, run.coast_start, chapter);
  add_order(scene, chapter);
}

}  // namespace grouser::validation
