#include "tests/support/linear_vehicle.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace grouser::test {
namespace {

constexpr int k_six = 6;

/// Accelerations of one side as a function of its motions from a state.
class OneSide {
 public:
  OneSide(const System& system, const AssemblyKnobs& knobs, const State& state, Side side)
      : system_(system),
        knobs_(knobs),
        state_(state),
        work_(make_workspace(system)),
        acceleration_(make_acceleration(system)) {
    for (CompiledTrack& track : system_.tracks) {
      for (CompiledAxis& axis : track.bushing) {
        for (FrictionStop& stop : axis.stops) stop.yield *= 1e6;  // sticks, with the force that it has
      }
    }
    for (const LinkBodies& bodies : system.tracks[static_cast<std::size_t>(index_of(side))].bodies) {
      for (int i = 0; i < bodies.count; ++i) links_.push_back(bodies.offset + i);
    }
    for (std::size_t j = 0; j < system.tree.bodies.size(); ++j) {
      const TreeBody& body = system.tree.bodies[j];
      if (!body.prescribed && body.mirror_group == index_of(side)) joints_.push_back(static_cast<int>(j));
    }
  }
  [[nodiscard]] int size() const {
    return k_six * (static_cast<int>(links_.size()) + 1) + static_cast<int>(joints_.size());
  }

  [[nodiscard]] Eigen::VectorXd accelerations(int motion, double by, bool rate) {
    State moved = state_;
    rate ? set_off(moved, motion, by) : shift(moved, motion, by);
    close_chains(system_, moved);
    evaluate(system_, knobs_, state_.history, 1e-4, moved, work_, acceleration_);
    Eigen::VectorXd all(size());
    Eigen::Index row = 0;
    for (const int i : links_) {
      for (int c = 0; c < 3; ++c) all[row++] = acceleration_.linear[c][i];
      for (int c = 0; c < 3; ++c) all[row++] = acceleration_.angular[c][i];
    }
    all.segment<3>(row) = acceleration_.chassis.linear;
    all.segment<3>(row + 3) = acceleration_.chassis.angular;
    row += k_six;
    for (const int j : joints_) all[row++] = acceleration_.chassis.joint[j];
    return all;
  }

 private:
  static Quaterniond turned(const Quaterniond& q, int axis, double angle) {
    return (q * Quaterniond(Eigen::AngleAxisd(angle, Vector3d::Unit(axis)))).normalized();
  }
  void shift(State& state, int motion, double by) const {
    const int body = motion / k_six, c = motion % k_six, num_links = static_cast<int>(links_.size());
    if (body < num_links) {
      const int i = links_[static_cast<std::size_t>(body)];
      if (c < 3) {
        state.position[c][i] += by;
        return;
      }
      Field& q = state.orientation;
      const Quaterniond next = turned({q[0][i], q[1][i], q[2][i], q[3][i]}, c - 3, by);
      q[0][i] = next.w(), q[1][i] = next.x(), q[2][i] = next.y(), q[3][i] = next.z();
    } else if (body > num_links) {
      state.chassis.angle[joints_[static_cast<std::size_t>(motion - k_six * (num_links + 1))]] += by;
    } else if (c < 3) {
      state.chassis.position[c] += by;
    } else {
      state.chassis.orientation = turned(state.chassis.orientation, c - 3, by);
    }
  }
  void set_off(State& state, int motion, double by) const {
    const int body = motion / k_six, c = motion % k_six, num_links = static_cast<int>(links_.size());
    if (body < num_links) {
      const int i = links_[static_cast<std::size_t>(body)];
      (c < 3 ? state.velocity[c][i] : state.angular_velocity[c - 3][i]) += by;
    } else if (body > num_links) {
      state.chassis.rate[joints_[static_cast<std::size_t>(motion - k_six * (num_links + 1))]] += by;
    } else {
      (c < 3 ? state.chassis.velocity[c] : state.chassis.angular_velocity[c - 3]) += by;
    }
  }

  System system_;
  AssemblyKnobs knobs_;
  State state_;
  Workspace work_;
  Acceleration acceleration_;
  std::vector<int> links_, joints_;
};

}  // namespace

LinearVehicle linearise(const System& system, const AssemblyKnobs& knobs, const State& state, Side side) {
  constexpr double k_shift = 1e-8, k_rate = 1e-5;  // m or rad, a second
  OneSide vehicle(system, knobs, state, side);
  LinearVehicle linear;
  linear.stiffness.resize(vehicle.size(), vehicle.size());
  linear.damping.resize(vehicle.size(), vehicle.size());
  for (int m = 0; m < vehicle.size(); ++m) {
    linear.stiffness.col(m) =
        (vehicle.accelerations(m, -k_shift, false) - vehicle.accelerations(m, k_shift, false)) / (2.0 * k_shift);
    linear.damping.col(m) =
        (vehicle.accelerations(m, -k_rate, true) - vehicle.accelerations(m, k_rate, true)) / (2.0 * k_rate);
  }
  return linear;
}

double largest_stable_step(const LinearVehicle& vehicle, double beta) {
  double h = 1e-4;
  for (int n = 0; n < 6; ++n) {  // between the first and the second power of h: converges by a factor of 5 or more
    const Eigen::MatrixXd sum = (4.0 * beta - 3.0) * h * h * vehicle.stiffness + 4.0 * h * vehicle.damping;
    const double largest = Eigen::EigenSolver<Eigen::MatrixXd>(sum, false).eigenvalues().real().maxCoeff();
    h *= std::pow(4.0 / largest, 0.6);
  }
  return h;
}

}  // namespace grouser::test
