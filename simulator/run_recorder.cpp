#include "simulator/run_recorder.h"

#include <algorithm>
#include <cmath>

namespace grouser {
namespace {

constexpr auto k_samples = static_cast<std::size_t>(RunTable::samples);
constexpr double k_still_share = 0.02;  // of the largest sprocket speed

std::span<const double> vertical_ground_force(const Workspace& work) {
  const Field& ground = work.contact_force_W[static_cast<std::size_t>(Partner::ground)];
  return {ground[2], static_cast<std::size_t>(ground.length())};
}

}  // namespace

RunRecorder::RunRecorder(const System& system, const std::filesystem::path& file,
                         const std::vector<std::size_t>& kept_rows)
    : system_(system),
      rows_(system),
      writer_(file, rows_.tables(), rows_.names(), kept_rows),
      samples_(rows_, RunTable::samples, system.scenario.output.rate, writer_),
      probes_(rows_, RunTable::probes, system.scenario.output.probe_rate, writer_),
      steady_(steady_drive(system.scenario)) {
  for (const DriveTable& table : system.scenario.drive) {
    for (const double speed : table.speed) largest_rate_ = std::max(largest_rate_, std::abs(speed));
  }
  if (!steady_) return;
  const Interval heard = tone_window(*steady_);
  constexpr double k_most_rows = 1 << 20;
  const double rows = std::min(system.scenario.output.probe_rate * (heard.to - heard.from) + 2.0, k_most_rows);
  for (std::vector<double>* values : {&measures_.tone_time, &measures_.left_torque})
    values->reserve(static_cast<std::size_t>(std::max(0.0, rows)));
}

void RunRecorder::begin(const Snapshot& now) {
  publish();
  sample(now, now);
  writer_.flush();
}

void RunRecorder::record(const Snapshot& previous, const Snapshot& now, const Stepper& stepper) {
  const std::size_t chunks = writer_.chunks(k_samples);
  sample(previous, now);
  chunk_filled_ = writer_.chunks(k_samples) > chunks;
  const std::array<double, 4> step{now.state.time, stepper.last_step(), stepper.last_error(),
                                   static_cast<double>(stepper.last_limit())};
  writer_.append(static_cast<std::size_t>(RunTable::steps), step);
  sum_steps(stepper);
  watch_rubber(system_, now.state, now.work, stepper.last_step(), measures_.rubber);
  for (const double offset : now.work.lateral_guide_offset)
    measures_.largest_guide_offset = std::max(measures_.largest_guide_offset, offset);
}

void RunRecorder::sample(const Snapshot& previous, const Snapshot& now) {
  if (probes_.write(previous, now) && steady_ && tone_window(*steady_).holds(now.state.time)) {
    measures_.tone_time.push_back(now.state.time);
    measures_.left_torque.push_back(now.work.chassis.joint_torque[system_.sprocket_body[0]]);
  }
  if (samples_.write(previous, now)) measure(now);
}

/// One sample's part in the results.
void RunRecorder::measure(const Snapshot& now) {
  RunMeasures& m = measures_;
  const Matrix3d& R_WV = now.work.chassis.base_rotation;
  const Vector3d origin = now.state.chassis.position - R_WV * system_.chassis_center_V;
  const double yaw = std::atan2(R_WV(1, 0), R_WV(0, 0)), speed = R_WV.col(0).dot(now.state.chassis.velocity);
  const double turns = m.samples > 0 ? m.last.yaw + std::remainder(yaw - m.last.yaw, 2.0 * k_pi) : yaw;
  m.last = {origin.x(), origin.y(), turns, speed};
  if (m.samples == 0) {
    m.first = m.last;
    for (const double f : vertical_ground_force(now.work)) m.rest_ground_force += f;
  }
  ++m.samples;
  m.largest_aside = std::max(m.largest_aside, std::abs(m.last.y - m.first.y));
  m.largest_way = std::max(m.largest_way, std::hypot(m.last.x - m.first.x, m.last.y - m.first.y));
  const double time = now.state.time;
  if (steady_ && straight_window(*steady_).holds(time)) m.straight_speed.add(speed);
  if (steady_ && turn_window(*steady_).holds(time)) m.turn_rate.add(now.work.chassis.base_angular_velocity_W.z());
  for (std::size_t c = 0; c < k_num_contact_cases; ++c) m.case_total[c] += static_cast<double>(now.work.case_count[c]);
}

/// Steps at rest and at a held speed apart (the paper's Fig. 4).
void RunRecorder::sum_steps(const Stepper& stepper) {
  const double t = stepper.state().time, h = stepper.last_step();
  double rate = 0.0;
  for (const int sprocket : system_.sprocket_body)
    rate = std::max(rate, std::abs(stepper.state().chassis.rate[sprocket]));
  if (rate <= k_still_share * largest_rate_) measures_.rest_steps.add(h, stepper.last_limit());
  if (steady_ && t > steady_->from && t <= steady_->to) measures_.steady_steps.add(h, stepper.last_limit());
}

}  // namespace grouser
