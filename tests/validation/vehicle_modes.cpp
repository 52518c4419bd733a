#include <fmt/format.h>

#include <cmath>

#include "tests/support/plane_vehicle.h"
#include "tests/support/vehicle_run.h"
#include "tests/validation/chapters.h"

namespace grouser::validation {
namespace {

using namespace grouser::test;
using Eigen::VectorXd;

constexpr int k_num_phases = 4;

/// Coordinates of PlaneVehicle: the hull's origin and pitch, the left arms and the left idler arm.
VectorXd plane_coordinates(const System& system, const State& state) {
  const TreeState& chassis = state.chassis;
  const auto num_arms = static_cast<Eigen::Index>(system.scenario.vehicle.side(Side::left).stations.size());
  const Vector3d origin = chassis.position - chassis.orientation * system.chassis_center_V;
  VectorXd y(4 + num_arms);
  y << origin.x(), origin.z(), 2.0 * std::atan2(chassis.orientation.y(), chassis.orientation.w()),
      chassis.angle.head(num_arms), chassis.angle[system.idler_arm_body[0]];
  return y;
}

/// Sets the vehicle moving with `rates` of those coordinates; wheels do not spin, the ground run only slides.
State moving(const System& system, const State& rest, const VectorXd& rates) {
  State state = rest;
  TreeState& chassis = state.chassis;
  const Vector3d w(0.0, rates[2], 0.0), v(rates[0], 0.0, rates[1]);
  const Vector3d origin = chassis.position - chassis.orientation * system.chassis_center_V;
  const auto velocity = [&](const Vector3d& p) { return Vector3d(v + w.cross(p - origin)); };
  chassis.velocity = velocity(chassis.position);
  chassis.angular_velocity = w;
  const Eigen::Index num_arms = rates.size() - 4;
  for (const Side side : {Side::left, Side::right}) {
    const auto s = static_cast<std::size_t>(index_of(side));
    const Eigen::Index first = chassis.rate.size() / 2 * index_of(side);
    chassis.rate.segment(first, num_arms) = rates.segment(3, num_arms);
    chassis.rate.segment(first + num_arms, num_arms) = -rates.segment(3, num_arms).array() - rates[2];
    chassis.rate[system.idler_arm_body[s]] = rates[rates.size() - 1];
    const CompiledTrack& track = system.tracks[s];
    for (int i = track.offset; i < track.offset + track.num_links; ++i) {
      LinkMotion link = get_link(state, i);
      const bool on_ground = link.position.z() < 1.2 * track.ground_depth;
      link.velocity = on_ground ? Vector3d(v.x(), 0.0, 0.0) : velocity(link.position);
      if (!on_ground) link.angular_velocity = w;
      set_link(state, i, link);
    }
  }
  close_chains(system, state);
  return state;
}

/// Natural frequency of a free decay about 0 from its zero crossings and, for the damping, its largest values between
/// them: f = f_d / sqrt(1 - zeta^2).
class Decay {
 public:
  void add(double time, double value) {
    if (count_++ > 0 && value * last_value_ < 0.0) {
      crossings_.push_back(last_time_ + (time - last_time_) * last_value_ / (last_value_ - value));
      peaks_.push_back(peak_);
      peak_ = 0.0;
    }
    peak_ = std::max(peak_, std::abs(value));
    last_time_ = time;
    last_value_ = value;
  }
  [[nodiscard]] double natural_frequency() const {
    const auto halves = static_cast<double>(crossings_.size() - 1);
    const double damped = 0.5 * halves / (crossings_.back() - crossings_.front());
    const double decrement = std::log(peaks_[1] / peaks_.back()) / static_cast<double>(peaks_.size() - 2) / k_pi;
    return damped * std::sqrt(1.0 + decrement * decrement);
  }

 private:
  std::vector<double> crossings_, peaks_;
  double last_time_ = 0.0, last_value_ = 0.0, peak_ = 0.0;
  int count_ = 0;
};

/// Both lowest modes set going at once; each is picked out of the motion by its dual.
struct Frequencies {
  double pitch = 0.0, heave = 0.0;
};
Frequencies measure(const VehicleScene& scene, const State& rest, const std::vector<PlaneVehicle::Mode>& modes) {
  constexpr double k_speed = 0.02, k_duration = 3.5;  // m/s of the hull: some mm
  const VectorXd rates = k_speed * (modes[0].shape / modes[0].shape.head(3).lpNorm<Eigen::Infinity>() +
                                    modes[1].shape / modes[1].shape.head(3).lpNorm<Eigen::Infinity>());
  const VectorXd y0 = plane_coordinates(scene.system, rest);
  Decay pitch, heave;
  follow(scene.system, moving(scene.system, rest, rates), scene.rest.knobs, k_duration, [&](const Stepper& stepper) {
    const VectorXd y = plane_coordinates(scene.system, stepper.state()) - y0;
    pitch.add(stepper.state().time, modes[0].dual.dot(y));
    heave.add(stepper.state().time, modes[1].dual.dot(y));
  });
  return {pitch.natural_frequency(), heave.natural_frequency()};
}

/// Feeds the track on by a part of a pitch and lets the vehicle come to rest again.
State fed_on(const VehicleScene& scene, const State& rest, double pitches) {
  System feeding = scene.system;
  const double teeth = feeding.scenario.vehicle.side(Side::left).sprocket.teeth,
               speed = 2.0 * k_pi / teeth * pitches / 0.6;
  feeding.scenario.drive.fill({{0.0, 0.3, 0.6, 0.9}, {0.0, speed, speed, 0.0}});
  AssemblyKnobs knobs = scene.rest.knobs;
  knobs.mass_damping = 5.0;  // 1/s
  State state = follow(feeding, rest, knobs, 2.4).state;
  state.time = 0.0;
  return state;
}

void add_modes(VehicleScene scene, const std::string& name, double tensioner_stiffness, const PlaneVehicle& plane,
               const PlaneVehicle::Rest& rest, Chapter& chapter) {
  set_tensioner(tensioner_stiffness, scene);
  const std::vector<PlaneVehicle::Mode> modes = plane.modes(rest, tensioner_stiffness);
  Frequencies mean;
  State state = scene.rest.state;
  for (int phase = 0; phase < k_num_phases; ++phase) {
    if (phase > 0) state = fed_on(scene, state, 1.0 / k_num_phases);
    const Frequencies found = measure(scene, state, modes);
    mean.pitch += found.pitch / k_num_phases;
    mean.heave += found.heave / k_num_phases;
  }
  const char* why = "rigid links in place of a smooth belt: the four positions differ by up to 10 %";
  const char* source = "independent solution, eigenvalues of K - (2 π f)² M of hull, arms and a smooth belt";
  chapter.add({"pitch frequency, " + name, "Hz", modes[0].frequency, mean.pitch,
               fraction(0.05, modes[0].frequency, why), source});
  chapter.add({"heave frequency, " + name, "Hz", modes[1].frequency, mean.heave,
               fraction(0.05, modes[1].frequency, why), source});
}

}  // namespace

void add_vehicle_modes(Chapter& chapter) {
  const VehicleScene scene = on_ice();
  const Vehicle& vehicle = scene.system.scenario.vehicle;
  const RunningGear& gear = vehicle.side(Side::left);
  const PlaneVehicle plane(vehicle, 1e8, 9.81);
  const PlaneVehicle::Rest rest = plane.stand(gear.track.pre_tension, gear.idler.tensioner_stiffness);
  chapter.section("Heave and pitch",
                  "Free decay of some millimetres, no friction, a bushing of 1e8 N/m; mean over four positions of the "
                  "track, a quarter of a pitch apart. A heaving hull lengthens the track's way round the wheels: with "
                  "the shipped tensioner the track is a spring beside the suspension, with a tensioner of constant "
                  "force it is not.");
  add_modes(scene, "tensioner of constant force", 1e3, plane, rest, chapter);
  add_modes(scene, "tensioner as shipped", gear.idler.tensioner_stiffness, plane, rest, chapter);
}

}  // namespace grouser::validation
