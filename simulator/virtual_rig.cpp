#include "simulator/virtual_rig.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "model/errors.h"
#include "simulator/bushings.h"

namespace grouser {
namespace {

Bushing with_free_axes(Bushing bushing) {
  for (AxisLaw& law : bushing.axes) {
    if (law.spring.displacement.empty()) law.spring = SpringSpline::linear(0.0, 1.0);
  }
  return bushing;
}

class Rig {
 public:
  Rig(const Bushing& bushing, Axis axis)
      : system_(compile_joint(with_free_axes(bushing))),
        axis_(axis),
        state_(make_state(system_)),
        work_(make_workspace(system_)) {}

  /// The rubber has stood here for ever.
  void relax(double displacement) {
    place(displacement, 0.0);
    AssemblyKnobs relaxed;
    relaxed.rubber_memory = false;
    bushing_forces(system_, relaxed, committed_ = state_.history, 0.0, state_, work_);
    committed_ = state_.history;
  }
  /// One accepted step of length h.
  void step(double displacement, double rate, double h) {
    place(displacement, rate);
    bushing_forces(system_, {}, committed_, h, state_, work_);
    committed_ = state_.history;
  }
  /// What the rubber remembers of the accepted steps.
  [[nodiscard]] const History& memory() const { return committed_; }
  void restore(const History& memory) { committed_ = memory; }
  /// Load on the clamped link.
  [[nodiscard]] double load(int axis) const {
    return axis < 3 ? -work_.joint_force_W[axis][0] : -work_.joint_torque_own_W[axis - 3][0];
  }

 private:
  /// The moving link; the clamped one stays at the origin, its axes those of W.
  void place(double displacement, double rate) {
    constexpr int k_moved = 1;
    const int component = index_of(axis_) % 3;
    if (is_rotation(axis_)) {
      state_.orientation[0][k_moved] = std::cos(0.5 * displacement);
      state_.orientation[1 + component][k_moved] = std::sin(0.5 * displacement);
      state_.angular_velocity[component][k_moved] = rate;
    } else {
      state_.position[component][k_moved] = displacement;
      state_.velocity[component][k_moved] = rate;
    }
    place_links(system_, state_, work_);
  }

  System system_;
  Axis axis_;
  State state_;
  Workspace work_;
  History committed_;  ///< the rubber's memory at the last sample
};

/// The ramps of a static test: out until the load is met, and back.
class Ramps {
 public:
  Ramps(const Bushing& bushing, const RigTest& test)
      : rig_(bushing, test.axis), made_(test), start_(test.preset.value_or(0.0)) {
    const std::vector<double>& points = bushing.axis(test.axis).spring.displacement;
    reach_ = 1e3 * std::max({std::abs(points.front()), std::abs(points.back()), std::abs(start_)});
    rig_.relax(start_);
    rig_.step(start_, 0.0, 0.0);
    record(0.0, start_);
    wanted_ = test.protocol->to_force - load();
  }

  RigTest drive() {
    const TestProtocol& protocol = *made_.protocol;
    int steps = (protocol.samples_per_turn + 1) / 2;
    for (int ramp = 0; ramp < protocol.turns; ++ramp) {
      if (protocol.sample_rate) steps = samples_of_a_way(std::abs(find_turn(1) - start_) / *made_.rate);
      const double turn = find_turn(steps);
      go(start_, turn, steps, true);
      go(turn, start_, steps, true);
    }
    return std::move(made_);
  }

 private:
  /// Of `time` [s].
  [[nodiscard]] int samples_of_a_way(double time) const {
    constexpr double k_most = 1e6;
    const double rate = *made_.protocol->sample_rate, samples = std::ceil(time * rate);
    if (samples <= k_most) return std::max(1, static_cast<int>(samples));
    throw NumericalError(
        fmt::format("test {}: a way of the ramp takes {:.4g} s, at {:.4g} Hz {:.4g} samples: expected at "
                    "most {:.0f}; give it a lower sample_rate_Hz or a higher rate",
                    made_.name, time, rate, samples, k_most));
  }
  [[nodiscard]] double load() const { return rig_.load(index_of(made_.axis)); }

  void record(double time, double displacement) {
    made_.time.push_back(time);
    made_.displacement.push_back(displacement);
    made_.force.push_back(load());
  }

  void go(double from, double to, int steps, bool recorded) {
    const double h = std::abs(to - from) / steps / *made_.rate, rate = std::copysign(*made_.rate, to - from);
    const double begin = made_.time.back();
    for (int i = 1; i <= steps; ++i) {
      const double x = i < steps ? from + (to - from) * i / steps : to;
      rig_.step(x, rate, h);
      if (recorded) record(begin + h * i, x);
    }
  }

  /// Share of the wanted change of load after a ramp of `length` from here, which is then taken back.
  double share_after(double length, int steps) {
    const History before = rig_.memory();
    go(start_, start_ + std::copysign(length, wanted_), steps, false);
    const double share = 1.0 + (load() - made_.protocol->to_force) / wanted_;
    rig_.restore(before);
    return share;
  }

  /// Where a ramp of so many steps meets the load, by bisection.
  double find_turn(int steps) {
    double low = 0.0, high = 1e-6 * reach_;
    while (high < reach_ && share_after(high, steps) < 1.0) low = high, high *= 2.0;
    for (int halved = 0; halved < 100; ++halved) {
      const double middle = 0.5 * (low + high), share = share_after(middle, steps);
      if (std::abs(share - 1.0) <= k_turn_tolerance) return start_ + std::copysign(middle, wanted_);
      (share < 1.0 ? low : high) = middle;
    }
    const char* const unit = is_rotation(made_.axis) ? "N m" : "N";
    throw NumericalError(
        fmt::format("test {}: the ramp does not meet {:.6g} {}: {:.6g} {} at its start, {:.6g} {} at "
                    "{:.6g} {}",
                    made_.name, made_.protocol->to_force, unit, made_.force.front(), unit,
                    made_.protocol->to_force + (share_after(high, steps) - 1.0) * wanted_, unit, high,
                    is_rotation(made_.axis) ? "rad" : "m"));
  }

  Rig rig_;
  RigTest made_;
  double start_;         ///< where the ramps begin and end
  double wanted_ = 0.0;  ///< change of the load from the first sample to the turn
  double reach_ = 0.0;   ///< of the search
};

/// The loops of a cyclic test need no search.
RigTest drive_loops(const Bushing& bushing, RigTest test) {
  const int samples = test.protocol->samples_per_turn;
  for (int i = 0; i <= samples * test.protocol->turns; ++i) {
    const double turns = static_cast<double>(i) / samples;
    test.time.push_back(turns / *test.frequency);
    test.displacement.push_back(test.preset.value_or(0.0) + *test.amplitude * std::sin(2.0 * std::numbers::pi * turns));
  }
  RigWrench wrench = run_virtual_rig(bushing, test.axis, test.time, test.displacement);
  test.force = std::move(wrench[static_cast<std::size_t>(index_of(test.axis))]);
  return test;
}

}  // namespace

RigTest run_protocol(const Bushing& bushing, const RigTest& test) {
  RigTest made = test.kind == TestKind::static_ramp ? Ramps(bushing, test).drive() : drive_loops(bushing, test);
  made.time_measured = true;
  return made;
}

RigWrench run_virtual_rig(const Bushing& bushing, Axis axis, const std::vector<double>& time,
                          const std::vector<double>& displacement) {
  RigWrench wrench;
  for (std::vector<double>& component : wrench) component.reserve(displacement.size());
  if (displacement.empty()) return wrench;
  Rig rig(bushing, axis);
  rig.relax(displacement.front());
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    const double h = i > 0 ? time[i] - time[i - 1] : 0.0;
    const double rate = h > 0.0 ? (displacement[i] - displacement[i - 1]) / h : 0.0;
    rig.step(displacement[i], rate, h);
    for (int a = 0; a < k_num_axes; ++a) wrench[static_cast<std::size_t>(a)].push_back(rig.load(a));
  }
  return wrench;
}

}  // namespace grouser
