#include "tests/support/vehicle_rk4.h"

#include <cmath>
#include <utility>

#include "simulator/drive.h"

namespace grouser::test {
namespace {

void add(double h, const Field& rate, Field& value) {
  for (std::size_t k = 0; k < value.data().size(); ++k) value.data()[k] += h * rate.data()[k];
}

/// q += h q w / 2, not yet of unit length.
void add_turn(double h, const Field& q, const Field& w, Field& sum) {
  for (int i = 0; i < q.length(); ++i) {
    const Quaterniond half_rate =
        Quaterniond(q[0][i], q[1][i], q[2][i], q[3][i]) * Quaterniond(0.0, 0.5 * w[0][i], 0.5 * w[1][i], 0.5 * w[2][i]);
    sum[0][i] += h * half_rate.w();
    sum[1][i] += h * half_rate.x();
    sum[2][i] += h * half_rate.y();
    sum[3][i] += h * half_rate.z();
  }
}

void make_unit(Field& q) {
  for (int i = 0; i < q.length(); ++i) {
    const double norm = std::sqrt(q[0][i] * q[0][i] + q[1][i] * q[1][i] + q[2][i] * q[2][i] + q[3][i] * q[3][i]);
    if (norm == 0.0) continue;  // padding
    for (int c = 0; c < 4; ++c) q[c][i] /= norm;
  }
}

/// sum += h d(state)/dt.
void add(double h, const State& at, const Acceleration& a, State& sum) {
  add(h, at.velocity, sum.position);
  add(h, a.linear, sum.velocity);
  add(h, a.angular, sum.angular_velocity);
  add_turn(h, at.orientation, at.angular_velocity, sum.orientation);
  TreeState& base = sum.chassis;
  base.position += h * at.chassis.velocity;
  base.velocity += h * a.chassis.linear;
  base.angular_velocity += h * a.chassis.angular;
  const Vector3d& w = at.chassis.angular_velocity;
  base.orientation.coeffs() +=
      h * (at.chassis.orientation * Quaterniond(0.0, 0.5 * w.x(), 0.5 * w.y(), 0.5 * w.z())).coeffs();
  base.angle += h * at.chassis.rate;
  base.rate += h * a.chassis.joint;
}

}  // namespace

VehicleRk4::VehicleRk4(const System& system, State start, const AssemblyKnobs& knobs)
    : system_(system),
      knobs_(knobs),
      now_(std::move(start)),
      stage_(now_),
      next_(now_),
      before_(now_.history),
      work_(make_workspace(system)),
      a_now_(make_acceleration(system)),
      a_stage_(make_acceleration(system)) {
  evaluate_at(0.0, now_, a_now_);
}

void VehicleRk4::evaluate_at(double h, State& state, Acceleration& acceleration) {
  make_unit(state.orientation);
  state.chassis.orientation.normalize();
  for (std::size_t s = 0; s < k_num_sides; ++s) {  // given motion is exact
    const int body = system_.sprocket_body[s];
    const DriveTable& table = system_.scenario.drive[s];
    if (table.kind != DriveKind::speed) continue;
    const DriveMotion from = drive_motion(table, now_.time), to = drive_motion(table, state.time);
    state.chassis.angle[body] = now_.chassis.angle[body] + (to.angle - from.angle);
    state.chassis.rate[body] = to.speed;
  }
  close_chains(system_, state);
  evaluate(system_, knobs_, before_, h, state, work_, acceleration);
}

void VehicleRk4::step(double h) {
  next_ = now_;
  add(h / 6.0, now_, a_now_, next_);
  State at = now_;
  Acceleration a = a_now_;
  for (const auto& [reach, weight] :
       {std::pair(0.5, 1.0 / 3.0), std::pair(0.5, 1.0 / 3.0), std::pair(1.0, 1.0 / 6.0)}) {
    stage_ = now_;
    add(reach * h, at, a, stage_);
    stage_.time = now_.time + reach * h;
    evaluate_at(reach * h, stage_, a_stage_);
    add(weight * h, stage_, a_stage_, next_);
    at = stage_;
    a = a_stage_;
  }
  next_.time = now_.time + h;
  evaluate_at(h, next_, a_stage_);
  now_ = next_;
  a_now_ = a_stage_;
  before_ = now_.history;
}

}  // namespace grouser::test
