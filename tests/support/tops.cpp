#include "tests/support/tops.h"

#include <stdexcept>

namespace grouser::test {

LinkMotion spin_top(const Vector3d& inertia, const Vector3d& spin, double duration, int steps) {
  Vehicle vehicle = bare_vehicle(8);
  for (RunningGear& gear : vehicle.sides) gear.track.link.inertia = inertia;
  Scenario scenario = parked(vehicle, no_bushing(), 0.0);
  scenario.integrator.fixed_step = duration / steps;
  const System system = compile(scenario);
  State state = strewn_state(system);
  LinkMotion link = get_link(state, 0);
  link.angular_velocity = spin;
  set_link(state, 0, link);
  close_chains(system, state);
  Stepper stepper(system, state, {});
  for (int i = 0; i < steps; ++i) {
    if (stepper.step(1e9) != StepStatus::ok) throw std::runtime_error("a step of the top failed");
  }
  return get_link(stepper.state(), 0);
}

LinkMotion reference_top(const Vector3d& inertia, const Vector3d& spin, double duration) {
  using Vector7d = Eigen::Matrix<double, 7, 1>;
  const auto rate = [&](const Vector7d& y) {
    const Vector3d w = y.tail<3>();
    const Quaterniond q(y[0], y[1], y[2], y[3]), dq = q * Quaterniond(0.0, w.x(), w.y(), w.z());
    Vector7d d;
    d << 0.5 * dq.w(), 0.5 * dq.x(), 0.5 * dq.y(), 0.5 * dq.z(),
        (-w.cross(inertia.cwiseProduct(w))).cwiseQuotient(inertia);
    return d;
  };
  Vector7d y;
  y << 1.0, 0.0, 0.0, 0.0, spin;
  constexpr int k_steps = 20000;
  const double h = duration / k_steps;
  for (int i = 0; i < k_steps; ++i) {
    const Vector7d k1 = rate(y), k2 = rate(y + 0.5 * h * k1), k3 = rate(y + 0.5 * h * k2), k4 = rate(y + h * k3);
    y += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  LinkMotion end;
  end.orientation = Quaterniond(y[0], y[1], y[2], y[3]);
  end.angular_velocity = y.tail<3>();
  return end;
}

double quaternion_distance(const Quaterniond& a, const Quaterniond& b) {
  return std::min((a.coeffs() - b.coeffs()).norm(), (a.coeffs() + b.coeffs()).norm());
}

TopReference euler_top() {
  return {{3.0, 2.0, 1.0},
          {1.0, 0.0, 1.0},
          {{0.5, {0.96188484855263, -0.473637640369356, 0.880719811078046}},
           {1.0, {0.882015815510536, -0.816176637479811, 0.57780247181208}},
           {2.0, {0.825998304800579, -0.976309582765481, -0.216378369067458}},
           {5.0, {0.821991699829143, 0.986402015527123, -0.164350429765268}},
           {10.0, {0.974400660583082, -0.38939704411533, -0.921069998444333}}}};
}

TopReference tumbling_top() {
  return {{1.0, 2.0, 3.0},
          {1e-3, 5.0, 1e-3},
          {{1.0, {-0.00648847970338624, 4.99999588996142, 0.00383407393691776}},
           {2.0, {-0.117716086244797, 4.99861420025983, 0.067968318504022}},
           {3.0, {-2.02146664094795, 4.57314701486128, 1.16709459491871}},
           {4.0, {-2.46840571843186, -4.34821506013819, 1.42513493990185}},
           {5.0, {-0.147191765065145, -4.9978330888793, 0.0849851275283396}},
           {8.0, {0.0195665968565627, -4.99996181468291, 0.0113262484606751}},
           {10.0, {4.51062715474487, -2.15736961851195, 2.60421193000377}}}};
}

}  // namespace grouser::test
