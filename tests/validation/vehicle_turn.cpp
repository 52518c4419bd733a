#include <cmath>

#include "tests/support/vehicle_run.h"
#include "tests/validation/chapters.h"

namespace grouser::validation {
namespace {

using namespace grouser::test;

/// Means over a steady turn, in the hull's heading.
struct Turn {
  double yaw_rate = 0.0;                   // rad/s
  std::array<double, k_num_sides> slip{};  // m/s, velocity of the loaded links over the ground along the heading
  double lateral_moment = 0.0;             // N m, of the ground's lateral forces about the centre of the hull
  double sliding_moment = 0.0;             // N m, what Coulomb's law makes of wheel loads, yaw rate and slip
};

/// A wheel's share of the ground: load and place of what lies nearest to it.
struct Share {
  double load = 0.0, moment = 0.0;
};

class TurnMeans {
 public:
  explicit TurnMeans(const System& system)
      : system_(system), shares_(2 * system.scenario.vehicle.sides[0].stations.size()) {}

  void add(const Stepper& stepper) {
    const State& state = stepper.state();
    const Matrix3d R_WC = state.chassis.orientation.toRotationMatrix();
    const Vector3d ahead = Vector3d(R_WC(0, 0), R_WC(1, 0), 0.0).normalized(), aside(-ahead.y(), ahead.x(), 0.0);
    const Field& ground = stepper.work().contact_force_W[static_cast<std::size_t>(Partner::ground)];
    for (std::size_t s = 0; s < k_num_sides; ++s) {
      const CompiledTrack& track = system_.tracks[s];
      for (int i = track.offset; i < track.offset + track.num_links; ++i) {
        const Vector3d force = get_vector(ground, i), arm = get_vector(state.position, i) - state.chassis.position;
        if (force.z() <= 0.0) continue;
        load_[s] += force.z();
        slip_[s] += force.z() * ahead.dot(get_vector(state.velocity, i));
        lateral_moment_ += ahead.dot(arm) * aside.dot(force);
        Share& share = shares_[nearest(s, ahead.dot(arm))];
        share.load += force.z();
        share.moment += force.z() * ahead.dot(arm);
      }
    }
    yaw_rate_ += state.chassis.angular_velocity.z();
    aside_velocity_ += aside.dot(state.chassis.velocity);
    ++count_;
  }

  [[nodiscard]] Turn means(double friction) const {
    const auto n = static_cast<double>(count_);
    Turn turn{yaw_rate_ / n, {slip_[0] / load_[0], slip_[1] / load_[1]}, lateral_moment_ / n, 0.0};
    for (std::size_t k = 0; k < shares_.size(); ++k) {
      if (shares_[k].load == 0.0) continue;
      const double x = shares_[k].moment / shares_[k].load, across = aside_velocity_ / n + turn.yaw_rate * x;
      const double along = turn.slip[k / (shares_.size() / 2)];
      turn.sliding_moment -= friction * shares_[k].load / n * x * across / std::hypot(across, along);
    }
    return turn;
  }

 private:
  [[nodiscard]] std::size_t nearest(std::size_t side, double x) const {
    const std::vector<Station>& stations = system_.scenario.vehicle.sides[side].stations;
    std::size_t best = 0;
    const auto distance = [&](std::size_t k) {
      return std::abs(stations[k].wheel.center.x() - system_.chassis_center_V.x() - x);
    };
    for (std::size_t k = 1; k < stations.size(); ++k) {
      if (distance(k) < distance(best)) best = k;
    }
    return side * stations.size() + best;
  }

  const System& system_;
  std::vector<Share> shares_;  // left wheels front to rear, then right ones
  std::array<double, k_num_sides> load_{}, slip_{};
  double lateral_moment_ = 0.0, yaw_rate_ = 0.0, aside_velocity_ = 0.0;
  long count_ = 0;
};

void add_turn_on_the_spot(const VehicleScene& scene, Chapter& chapter) {
  TurnMeans sums(scene.system);
  const ShortRun run = follow(scene.system, scene.rest.state, scene.rest.knobs, 6.0, [&](const Stepper& stepper) {
    if (stepper.state().time > 3.5) sums.add(stepper);
  });
  const double friction = scene.system.scenario.terrain.friction;
  const Turn turn = sums.means(friction);
  const double tread = 2.0 * scene.system.scenario.vehicle.side(Side::left).track_center_y;
  const double feed = 9.0 * scene.system.tracks[0].speed_per_sprocket_rate;
  chapter.section(
      "Run B, turn on the spot",
      "Sprockets at ±9 rad/s, means from 3.5 s to 6 s. Slip i of a track: velocity of its loaded links over "
      "the ground against the speed it is fed with.");
  const double outer_slip = -turn.slip[1] / feed, inner_slip = turn.slip[0] / feed;
  const double kinematic = (feed * (1.0 - outer_slip) + feed * (1.0 - inner_slip)) / tread;
  chapter.add({"yaw rate", "rad/s", kinematic, turn.yaw_rate,
               fraction(0.02, kinematic, "the track is stretched: fed by up to 1 % more than N p ω / 2π"),
               "closed form, (v_o (1 - i_o) - v_i (1 - i_i)) / B with the measured slips (Wong 2008, steering)"});
  chapter.add({"moment of turning resistance", "kN m", turn.sliding_moment / 1e3, turn.lateral_moment / 1e3,
               fraction(0.04, turn.sliding_moment / 1e3, "six forces a track in place of its links"),
               "closed form, Σ μ N x v_y / √(v_x² + v_y²) over wheel loads, v_y = ψ̇ x; μ W L / 4 where v_x = 0"});
  chapter.add({"energy residual over ∫|sprocket power|", "", 0.0, run.book.residual_fraction(),
               within(2e-4, "second order in a step of the default tolerance"), "first law"});
}

/// Largest distance of links and hull between two states [m].
double distance(const System& system, const State& a, const State& b) {
  double largest = (a.chassis.position - b.chassis.position).norm();
  for (const CompiledTrack& track : system.tracks) {
    for (int i = track.offset; i < track.offset + track.num_links; ++i)
      largest = std::max(largest, (get_vector(a.position, i) - get_vector(b.position, i)).norm());
  }
  return largest;
}

/// Left and right exchanged.
State mirrored(const System& system, const State& state) {
  State out = state;
  const auto reflect = [](const Vector3d& v) { return Vector3d(v.x(), -v.y(), v.z()); };
  out.chassis.position = reflect(state.chassis.position);
  const int left = system.tracks[0].offset, right = system.tracks[1].offset;
  for (int k = 0; k < system.tracks[0].num_links; ++k) {
    for (const auto& [from, to] : {std::pair(left, right), std::pair(right, left)}) {
      const Vector3d p = reflect(get_vector(state.position, from + k));
      for (int c = 0; c < 3; ++c) out.position[c][to + k] = p[c];
    }
  }
  return out;
}

void add_symmetry(const VehicleScene& scene, Chapter& chapter) {
  chapter.section("What must not matter",
                  "The shipped vehicle turns off, 0.5 s: with left and right exchanged, and in a world turned about z. "
                  "Largest distance of a link or the hull from where it should be.");
  const auto steer = [&](double left, double right, const State& start) {
    System system = scene.system;
    system.scenario.drive = {DriveTable{{0.0, 0.5}, {0.0, left}}, DriveTable{{0.0, 0.5}, {0.0, right}}};
    return follow(system, start, scene.rest.knobs, 0.5).state;
  };
  const State& rest = scene.rest.state;
  const State steered = steer(6.0, 2.0, rest);
  const char* why = "round-off, magnified by contacts";
  chapter.add({"mirrored drive", "mm", 0.0,
               1e3 * distance(scene.system, mirrored(scene.system, steered), steer(2.0, 6.0, rest)), within(1e-3, why),
               "mirror image"});
  for (const double degrees : {90.0, 37.0}) {
    const double angle = degrees * k_pi / 180.0;
    const State aside = steer(6.0, 2.0, turned(rest, angle));
    chapter.add({degrees == 90.0 ? "world turned by 90°" : "world turned by 37°", "mm", 0.0,
                 1e3 * distance(scene.system, turned(steered, angle), aside), within(1e-3, why),
                 "same motion, turned"});
  }
}

}  // namespace

void add_vehicle_turn(Chapter& chapter) {
  const VehicleScene scene = at_rest(shipped_scenario("run_b"));
  add_turn_on_the_spot(scene, chapter);
  add_symmetry(scene, chapter);
}

}  // namespace grouser::validation
