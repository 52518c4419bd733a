#include "tests/support/trees.h"

#include <random>

namespace grouser::test {
namespace {

TreeBody unit_body(int parent, const Vector3d& axis, const Vector3d& origin, const Vector3d& center_of_mass) {
  TreeBody body;
  body.parent = parent;
  body.axis = axis;
  body.origin = origin;
  body.mass = 1.0;
  body.center_of_mass = center_of_mass;
  body.inertia = Matrix3d::Identity();
  return body;
}

/// state + h * rate; the orientation by the quaternion's own rate, normalised.
struct TreeRate {
  Vector3d velocity, acceleration, angular_velocity, angular_acceleration;
  Eigen::VectorXd rate, joint;
};

TreeState moved(const TreeState& from, const TreeRate& r, double h) {
  TreeState to = from;
  to.position += h * r.velocity;
  to.velocity += h * r.acceleration;
  to.orientation = from.orientation * quaternion_exp(h * r.angular_velocity);
  to.angular_velocity += h * r.angular_acceleration;
  to.angle += h * r.rate;
  to.rate += h * r.joint;
  return to;
}

}  // namespace

Tree five_body_tree() {
  Tree tree;
  tree.base_fixed = true;
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  tree.bodies = {unit_body(-1, z, Vector3d::Zero(), x), unit_body(0, y, x, y), unit_body(1, x, y, z),
                 unit_body(0, y, -0.5 * x, y), unit_body(3, x, -0.5 * y, z)};
  return tree;
}

Tree random_tree(std::uint32_t seed, int num_bodies) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0), size(0.2, 1.0);
  const auto vector = [&] { return Vector3d(unit(random), unit(random), unit(random)); };
  const auto inertia = [&](double mass) {  // of a turned box, so that the triangle inequality holds
    const Vector3d d2 = Vector3d(size(random), size(random), size(random)).cwiseAbs2();
    const Vector3d about(d2.y() + d2.z(), d2.z() + d2.x(), d2.x() + d2.y());
    const Matrix3d R = quaternion_exp(2.0 * vector()).toRotationMatrix();
    return Matrix3d(R * (mass / 12.0 * about).asDiagonal() * R.transpose());
  };
  Tree tree;
  tree.base_mass = 3.0;
  tree.base_inertia = inertia(tree.base_mass);
  for (int i = 0; i < num_bodies; ++i) {
    TreeBody body;
    body.parent = std::uniform_int_distribution<int>(-1, i - 1)(random);
    body.axis = vector().normalized();
    body.origin = vector();
    body.mass = size(random);
    body.center_of_mass = vector();
    body.inertia = inertia(body.mass);
    tree.bodies.push_back(body);
  }
  return tree;
}

TreeState random_state(const Tree& tree, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto vector = [&] { return Vector3d(unit(random), unit(random), unit(random)); };
  TreeState state = make_state(tree);
  if (!tree.base_fixed) {
    state.position = vector();
    state.orientation = quaternion_exp(2.0 * vector());
    state.velocity = vector();
    state.angular_velocity = vector();
  }
  for (Eigen::Index j = 0; j < state.angle.size(); ++j) {
    state.angle[j] = 3.0 * unit(random);
    state.rate[j] = 2.0 * unit(random);
  }
  return state;
}

TreeAnswer accelerate(const Tree& tree, const TreeState& state, const Vector3d& gravity_W,
                      const Eigen::VectorXd& torque) {
  TreeAnswer answer{make_workspace(tree), {}};
  answer.acceleration.joint = Eigen::VectorXd::Zero(state.angle.size());
  const std::vector<double> no_motion(tree.bodies.size(), 0.0);
  place_tree(tree, state, gravity_W, answer.work);
  answer.work.joint_torque = torque;
  tree_accelerations(tree, state, no_motion, answer.work, answer.acceleration);
  return answer;
}

TreeState runge_kutta(const Tree& tree, TreeState state, const Vector3d& gravity_W, const TorqueLaw& torque,
                      double duration, int steps) {
  const auto rate_at = [&](const TreeState& s) {
    const TreeAcceleration a = accelerate(tree, s, gravity_W, torque(s)).acceleration;
    return TreeRate{s.velocity, a.linear, s.angular_velocity, a.angular, s.rate, a.joint};
  };
  const double h = duration / steps;
  for (int i = 0; i < steps; ++i) {
    const TreeRate k1 = rate_at(state), k2 = rate_at(moved(state, k1, 0.5 * h));
    const TreeRate k3 = rate_at(moved(state, k2, 0.5 * h)), k4 = rate_at(moved(state, k3, h));
    const auto mean = [](const auto& a, const auto& b, const auto& c, const auto& d) {
      return ((a + 2.0 * b + 2.0 * c + d) / 6.0).eval();
    };
    // Turning by the mean rate alone would be of second order: the commutator of the rates completes it (Munthe-Kaas).
    Vector3d turn_rate = mean(k1.angular_velocity, k2.angular_velocity, k3.angular_velocity, k4.angular_velocity);
    turn_rate += h / 12.0 * k1.angular_velocity.cross(k4.angular_velocity);
    state =
        moved(state,
              {mean(k1.velocity, k2.velocity, k3.velocity, k4.velocity),
               mean(k1.acceleration, k2.acceleration, k3.acceleration, k4.acceleration), turn_rate,
               mean(k1.angular_acceleration, k2.angular_acceleration, k3.angular_acceleration, k4.angular_acceleration),
               mean(k1.rate, k2.rate, k3.rate, k4.rate), mean(k1.joint, k2.joint, k3.joint, k4.joint)},
              h);
    state.orientation.normalize();
  }
  return state;
}

TreeMomentum tree_momentum(const Tree& tree, const TreeState& state, const Vector3d& gravity_W) {
  const TreeAnswer answer = accelerate(tree, state, gravity_W, Eigen::VectorXd::Zero(state.angle.size()));
  TreeMomentum sum;
  sum.kinetic = answer.work.kinetic_energy;
  sum.potential = gravity_energy(tree, state, gravity_W, answer.work);
  sum.linear = tree.base_mass * state.velocity;
  sum.angular = state.position.cross(sum.linear) + state.orientation * (tree.base_inertia * state.angular_velocity);
  for (std::size_t n = 0; n < tree.bodies.size(); ++n) {
    const TreeBody& body = tree.bodies[n];
    const auto i = static_cast<int>(n);
    const Vector3d center = answer.work.center_W(i), w = answer.work.angular_velocity_W(i);
    const Vector3d p = body.mass * answer.work.velocity_at(i, center);
    const Matrix3d R = answer.work.rotation(i);
    sum.linear += p;
    sum.angular += (state.position + center).cross(p) + R * (body.inertia * (R.transpose() * w));
  }
  return sum;
}

}  // namespace grouser::test
