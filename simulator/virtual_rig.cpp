#include "simulator/virtual_rig.h"

#include <cmath>

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

}  // namespace

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
