#include "tests/validation/convergence_measures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "simulator/energy_book.h"
#include "simulator/results.h"

namespace grouser::validation {
namespace {

constexpr double k_rate = 2000.0;  // Hz, of the series that lines and means are taken from

/// A place on the running gear where the track is read: the plane x = const of the hull, above or below the axles.
struct Spot {
  double x = 0.0;
  bool above = false;
};
struct Spots {
  Spot upper, rear, front;
};

/// Middle of each free span of the left side.
Spots spots_of(const System& system) {
  const RunningGear& gear = system.scenario.vehicle.side(Side::left);
  const auto middle = [](const Vector3d& a, const Vector3d& b) { return 0.5 * (a.x() + b.x()); };
  const Vector3d &idler = gear.idler.wheel.center, &sprocket = gear.sprocket.center;
  return {{middle(gear.support_rollers.at(0).center, gear.support_rollers.at(1).center), true},
          {middle(sprocket, gear.stations.back().wheel.center), false},
          {middle(idler, gear.stations.front().wheel.center), false}};
}

/// Tension of the left track where it crosses the plane of `spot`, between its two nearest joints. In a frame that goes
/// with the hull, link passing is one line; in a link's frame it is split by the laps of the track (P 4).
double tension_at(const System& system, const Stepper& stepper, const Spot& spot) {
  const CompiledTrack& track = system.tracks[0];
  const Workspace& work = stepper.work();
  const Field& centers = stepper.state().position;
  const RunningGear& gear = system.scenario.vehicle.side(Side::left);
  const double axles = 0.5 * (gear.sprocket.center.z() + gear.idler.wheel.center.z());
  const auto pin = [&](int k) {
    const int i = track.offset + k % track.num_links;
    const Vector3d axis(work.rotation[0][i], work.rotation[3][i], work.rotation[6][i]);
    const Vector3d p_W = Vector3d(centers[0][i], centers[1][i], centers[2][i]) + 0.5 * track.pitch * axis;
    return Vector3d(work.chassis.base_rotation.transpose() * (p_W - stepper.state().chassis.position) +
                    system.chassis_center_V);
  };
  const auto tension = [&](int k) { return work.bushing_force[0][track.offset + k % track.num_links]; };
  Vector3d before = pin(0);
  for (int k = 1; k <= track.num_links; ++k) {
    const Vector3d at = pin(k);
    const double from = before.x() - spot.x, to = at.x() - spot.x;
    if (from * to <= 0.0 && from != to && (at.z() > axles) == spot.above && (before.z() > axles) == spot.above)
      return tension(k - 1) + (tension(k) - tension(k - 1)) * from / (from - to);
    before = at;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

double contact_force(const Workspace& work, Partner partner, int i) {
  const Field& f = work.contact_force_W[static_cast<std::size_t>(partner)];
  return std::sqrt(f[0][i] * f[0][i] + f[1][i] * f[1][i] + f[2][i] * f[2][i]);
}

/// Largest value that each link of the left track saw; what is quoted is the mean over the links, which scatters far
/// less than the one largest value of all.
struct LinkPeaks {
  explicit LinkPeaks(int num_links) : largest(static_cast<std::size_t>(num_links), 0.0) {}
  void see(int link, double value) {
    double& kept = largest[static_cast<std::size_t>(link)];
    kept = std::max(kept, value);
  }
  [[nodiscard]] double mean() const {
    double sum = 0.0;
    for (const double value : largest) sum += value;
    return sum / static_cast<double>(largest.size());
  }
  std::vector<double> largest;
};

/// Series at k_rate over the whole run.
struct Series {
  std::vector<double> time;
  std::array<std::vector<double>, 5> value;  // torque, upper, rear, front, probe
};
enum { k_torque, k_upper, k_rear, k_front, k_probe };

struct Moments {
  double mean = 0.0, rms = 0.0;  ///< rms: about the mean
};
Moments moments(const Series& series, int which, double from, double to) {
  double n = 0.0, sum = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < series.time.size(); ++i) {
    if (series.time[i] < from || series.time[i] > to) continue;
    const double v = series.value[static_cast<std::size_t>(which)][i];
    n += 1.0, sum += v, squares += v * v;
  }
  const double mean = sum / n;
  return {mean, std::sqrt(std::max(0.0, squares / n - mean * mean))};
}

class Recorder {
 public:
  Recorder(const System& system, const Phases& phases)
      : system_(system),
        phases_(phases),
        spots_(spots_of(system)),
        tension_(system.tracks[0].num_links),
        braking_(tension_),
        wheel_(tension_),
        sprocket_(tension_),
        ground_(tension_) {}

  void look(const Stepper& stepper) {
    const double t = stepper.state().time, h = stepper.last_step();
    count_step(t, h, stepper.last_limit());
    see_peaks(stepper, t);
    if (static_cast<double>(due_) / k_rate <= t) sample(stepper, t);
  }

  [[nodiscard]] Measures finish(const Stepper& stepper, const EnergyBook& book, double residual_fraction,
                                const State& start) const {
    const double from = phases_.cruise_from + k_settling, to = phases_.cruise_to;
    const CompiledTrack& track = system_.tracks[0];
    const double speed = stepper_rate() * track.speed_per_sprocket_rate;
    const auto line = [&](int which) {
      return spectral_line(series_.time, series_.value[static_cast<std::size_t>(which)], from, to, speed / track.pitch)
          .amplitude;
    };
    const double brake_from = phases_.cruise_to + 0.2, brake_to = phases_.end - 0.2;
    Measures m;
    m.value = {moments(series_, k_upper, from, to).mean,
               moments(series_, k_rear, from, to).mean,
               moments(series_, k_front, from, to).mean,
               moments(series_, k_probe, from, to).mean,
               moments(series_, k_rear, brake_from, brake_to).mean,
               stepper.state().chassis.position.x() - start.chassis.position.x(),
               book.input,
               moments(series_, k_torque, from, to).rms,
               line(k_torque),
               line(k_rear),
               line(k_front),
               moments(series_, k_probe, from, to).rms,
               tension_.mean(),
               braking_.mean(),
               wheel_.mean(),
               sprocket_.mean(),
               ground_.mean()};
    m.residual_fraction = residual_fraction;
    m.mean_step = cruise_time_ / static_cast<double>(cruise_steps_);
    m.error_share = static_cast<double>(by_error_) / static_cast<double>(cruise_steps_);
    m.stability_share = static_cast<double>(by_stability_) / static_cast<double>(cruise_steps_);
    m.accepted = accepted_;
    m.evaluations = stepper.evaluations();
    for (const Tenth& tenth : tenths_) {
      if (tenth.count > 0) m.steps.push_back({tenth.time / tenth.count, tenth.length / tenth.count, tenth.low});
    }
    return m;
  }

 private:
  static constexpr double k_settling = 1.0;  // s after the drive's corner
  struct Tenth {
    double time = 0.0, length = 0.0, low = 1.0;
    int count = 0;
  };

  [[nodiscard]] double stepper_rate() const {
    const DriveTable& table = system_.scenario.drive[0];
    return table_value(table.time, table.speed, phases_.cruise_to);
  }

  void count_step(double t, double h, StepLimit limit) {
    ++accepted_;
    const auto at = static_cast<std::size_t>(10.0 * (t - 0.5 * h));
    tenths_.resize(std::max(tenths_.size(), at + 1));
    Tenth& tenth = tenths_[at];
    tenth.time += t, tenth.length += h, tenth.low = std::min(tenth.low, h), ++tenth.count;
    if (t < phases_.cruise_from + k_settling || t > phases_.cruise_to) return;
    cruise_time_ += h, ++cruise_steps_;
    if (limit == StepLimit::error || limit == StepLimit::growth) ++by_error_;
    if (limit == StepLimit::stability) ++by_stability_;
  }

  void see_peaks(const Stepper& stepper, double t) {
    const bool cruise = t > phases_.cruise_from + k_settling && t<phases_.cruise_to, braking = t> phases_.cruise_to;
    if (!cruise && !braking) return;
    const CompiledTrack& track = system_.tracks[0];
    const Workspace& work = stepper.work();
    for (int k = 0; k < track.num_links; ++k) {
      const int i = track.offset + k;
      (cruise ? tension_ : braking_).see(k, work.bushing_force[0][i]);
      if (braking) continue;
      wheel_.see(k, contact_force(work, Partner::road_wheel, i));
      sprocket_.see(k, contact_force(work, Partner::sprocket, i));
      ground_.see(k, contact_force(work, Partner::ground, i));
    }
  }

  /// Rows due since the last state that was read, on the straight line between the two.
  void sample(const Stepper& stepper, double t) {
    const Workspace& work = stepper.work();
    const std::array<double, 5> now{
        work.chassis.joint_torque[system_.sprocket_body[0]], tension_at(system_, stepper, spots_.upper),
        tension_at(system_, stepper, spots_.rear), tension_at(system_, stepper, spots_.front),
        work.bushing_force[0][system_.tracks[0].offset + k_probe_link]};
    for (; static_cast<double>(due_) / k_rate <= t; ++due_) {
      const double at = static_cast<double>(due_) / k_rate;
      const double u = last_time_ < t && due_ > 0 ? (at - last_time_) / (t - last_time_) : 1.0;
      series_.time.push_back(at);
      for (std::size_t c = 0; c < now.size(); ++c) series_.value[c].push_back(last_[c] + u * (now[c] - last_[c]));
    }
    last_ = now;
    last_time_ = t;
  }
  static constexpr int k_probe_link = 20;

  const System& system_;
  Phases phases_;
  Spots spots_;
  LinkPeaks tension_, braking_, wheel_, sprocket_, ground_;
  Series series_;
  long due_ = 0;
  std::array<double, 5> last_{};
  double last_time_ = 0.0;
  std::vector<Tenth> tenths_;
  double cruise_time_ = 0.0;
  long cruise_steps_ = 0, by_error_ = 0, by_stability_ = 0, accepted_ = 0;
};

}  // namespace

const std::vector<Quantity>& quantities() {
  static const std::vector<Quantity> all{
      {"Tension of the upper run, cruise", "kN", Kind::mean, 1e-3},
      {"Tension of the rear span, cruise", "kN", Kind::mean, 1e-3},
      {"Tension of the front span, cruise", "kN", Kind::mean, 1e-3},
      {"Tension at the probe link, cruise", "kN", Kind::mean, 1e-3},
      {"Tension of the rear span, braking", "kN", Kind::mean, 1e-3},
      {"Distance", "m", Kind::mean, 1.0, 3},
      {"Work of the sprockets", "kJ", Kind::mean, 1e-3, 0},
      {"Sprocket torque, rms about its mean", "kN m", Kind::fluctuation, 1e-3},
      {"Sprocket torque, line at link passing", "kN m", Kind::fluctuation, 1e-3},
      {"Tension of the rear span, line at link passing", "kN", Kind::fluctuation, 1e-3},
      {"Tension of the front span, line at link passing", "kN", Kind::fluctuation, 1e-3},
      {"Tension at the probe link, rms about its mean", "kN", Kind::fluctuation, 1e-3},
      {"Peak tension, cruise", "kN", Kind::peak, 1e-3, 1},
      {"Peak tension, braking", "kN", Kind::peak, 1e-3, 1},
      {"Peak force on road wheels, cruise", "kN", Kind::peak, 1e-3, 1},
      {"Peak force on the sprocket, cruise", "kN", Kind::peak, 1e-3, 1},
      {"Peak force on the ground, cruise", "kN", Kind::peak, 1e-3, 1},
  };
  return all;
}

int index_of_quantity(const std::string& name) {
  for (std::size_t q = 0; q < quantities().size(); ++q) {
    if (quantities()[q].name == name) return static_cast<int>(q);
  }
  throw std::logic_error("no quantity " + name);
}

Measures measure(const System& system, const State& start, const AssemblyKnobs& knobs, const Phases& phases) {
  Stepper stepper(system, start, knobs);
  EnergyBook book = open_book(stepper.work().energy);
  Recorder recorder(system, phases);
  double residual = 0.0, turnover = 0.0;
  const auto go_to = [&](double time, bool counted) {
    const double residual_before = book.residual(), turnover_before = book.absolute_input;
    while (stepper.state().time < time) {
      if (stepper.step(time) != StepStatus::ok) throw std::runtime_error("a run of the ladder failed");
      book_step(book, stepper.work().energy, stepper.last_step());
      recorder.look(stepper);
    }
    if (!counted) return;
    residual += book.residual() - residual_before;
    turnover += book.absolute_input - turnover_before;
  };
  go_to(phases.cruise_from, true);
  go_to(phases.cruise_to - phases.longer, true);
  go_to(phases.cruise_to, false);
  go_to(phases.end, true);
  return recorder.finish(stepper, book, std::abs(residual) / turnover, start);
}

}  // namespace grouser::validation
