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
  reserve_series();
}

/// Room for the whole run, or the first million rows of a very long one.
void RunRecorder::reserve_series() {
  const auto reserve = [&](double rate, std::initializer_list<std::vector<double>*> all) {
    constexpr double k_most_rows = 1 << 20;
    const double rows = std::min(rate * system_.scenario.duration + 2.0, k_most_rows);
    for (std::vector<double>* series : all) series->reserve(static_cast<std::size_t>(rows));
  };
  RunSeries& s = series_;
  reserve(system_.scenario.output.rate, {&s.time, &s.x, &s.y, &s.yaw, &s.speed, &s.yaw_rate, &s.ground_force});
  reserve(system_.scenario.output.probe_rate, {&s.probe_time, &s.probe_torque});
}

void RunRecorder::begin(const Snapshot& now) {
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
  watch_rubber(system_, now.state, now.work, stepper.last_step(), series_.rubber);
  for (const double offset : now.work.lateral_guide_offset)
    series_.largest_guide_offset = std::max(series_.largest_guide_offset, offset);
}

void RunRecorder::sample(const Snapshot& previous, const Snapshot& now) {
  if (probes_.write(previous, now)) {
    series_.probe_time.push_back(now.state.time);
    series_.probe_torque.push_back(now.work.chassis.joint_torque[system_.sprocket_body[0]]);
  }
  if (!samples_.write(previous, now)) return;
  const Matrix3d& R_WV = now.work.chassis.base_rotation;
  const Vector3d origin = now.state.chassis.position - R_WV * system_.chassis_center_V;
  series_.time.push_back(now.state.time);
  series_.x.push_back(origin.x());
  series_.y.push_back(origin.y());
  const double yaw = std::atan2(R_WV(1, 0), R_WV(0, 0));
  series_.yaw.push_back(
      series_.yaw.empty() ? yaw : series_.yaw.back() + std::remainder(yaw - series_.yaw.back(), 2.0 * k_pi));
  series_.speed.push_back(R_WV.col(0).dot(now.state.chassis.velocity));
  series_.yaw_rate.push_back(now.work.chassis.base_angular_velocity_W.z());
  double ground = 0.0;
  for (const double f : vertical_ground_force(now.work)) ground += f;
  series_.ground_force.push_back(ground);
  for (std::size_t c = 0; c < k_num_contact_cases; ++c)
    series_.case_total[c] += static_cast<double>(now.work.case_count[c]);
}

/// Steps at rest and at a held speed apart (the paper's Fig. 4).
void RunRecorder::sum_steps(const Stepper& stepper) {
  const double t = stepper.state().time, h = stepper.last_step();
  double rate = 0.0;
  for (const int sprocket : system_.sprocket_body)
    rate = std::max(rate, std::abs(stepper.state().chassis.rate[sprocket]));
  if (rate <= k_still_share * largest_rate_) series_.rest_steps.add(h, stepper.last_limit());
  if (steady_ && t > steady_->from && t <= steady_->to) series_.steady_steps.add(h, stepper.last_limit());
}

}  // namespace grouser
