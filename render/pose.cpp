#include "render/pose.h"

#include <algorithm>
#include <cmath>

#include "model/errors.h"

namespace grouser {
namespace {

constexpr std::size_t k_block_rows = 64;  ///< about a third of a second at 200 Hz, 0.7 MB

Vector3d vector_at(std::span<const double> row, std::size_t i) { return {row[3 * i], row[3 * i + 1], row[3 * i + 2]}; }
Quaterniond quaternion_at(std::span<const double> row, std::size_t i) {
  return {row[4 * i], row[4 * i + 1], row[4 * i + 2], row[4 * i + 3]};
}

/// Normalised blend, the short way round.
Quaterniond blend(const Quaterniond& a, const Quaterniond& b, double weight) {
  const double sign = a.dot(b) < 0.0 ? -1.0 : 1.0;
  Quaterniond mixed;
  mixed.coeffs() = (1.0 - weight) * a.coeffs() + weight * sign * b.coeffs();
  return mixed.normalized();
}
double blend(double a, double b, double weight) { return (1.0 - weight) * a + weight * b; }
BodyPose blend(const BodyPose& a, const BodyPose& b, double weight) {
  return {(1.0 - weight) * a.position + weight * b.position, blend(a.orientation, b.orientation, weight)};
}
template <typename T>
std::vector<T> blend(const std::vector<T>& a, const std::vector<T>& b, double weight) {
  std::vector<T> mixed;
  for (std::size_t i = 0; i < a.size(); ++i) mixed.push_back(blend(a[i], b[i], weight));
  return mixed;
}
SideAngles blend(const SideAngles& a, const SideAngles& b, double weight) {
  return {blend(a.arms, b.arms, weight),       blend(a.wheels, b.wheels, weight),
          blend(a.rollers, b.rollers, weight), blend(a.idler_arm, b.idler_arm, weight),
          blend(a.idler, b.idler, weight),     blend(a.sprocket, b.sprocket, weight)};
}

}  // namespace

PoseReader::PoseReader(const RunFolder& run) : run_(run) {
  time_ = run.channels.read("/time").values;
  const std::string file = (run.path / "run.h5").string();
  if (time_.empty()) throw InputError({file, "/time", "at least one sample", "none", ""});
  const std::vector<std::string> names = run.channels.read_names("/joints/names");
  const auto column = [&](const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) throw InputError({file, "/joints/names", "joint " + name, "none of that name", ""});
    return static_cast<std::size_t>(found - names.begin());
  };
  for (const Side side : {Side::left, Side::right}) {
    const RunningGear& gear = run.vehicle.side(side);
    const std::string prefix = std::string(name_of(side)) + "/";
    JointColumns& columns = columns_[static_cast<std::size_t>(index_of(side))];
    for (std::size_t i = 1; i <= gear.stations.size(); ++i) {
      columns.arms.push_back(column(prefix + "arm_" + std::to_string(i)));
      columns.wheels.push_back(column(prefix + "wheel_" + std::to_string(i)));
    }
    for (std::size_t i = 1; i <= gear.support_rollers.size(); ++i)
      columns.rollers.push_back(column(prefix + "roller_" + std::to_string(i)));
    columns.idler_arm = column(prefix + "idler_arm");
    columns.idler = column(prefix + "idler");
    columns.sprocket = column(prefix + "sprocket");
  }
}

void PoseReader::load(std::size_t row) {
  if (row >= block_.first && row + 1 < block_.first + block_.count) return;
  block_.first = row;
  block_.count = std::min(k_block_rows, time_.size() - row);
  const auto rows = [this](const std::string& path) {
    return run_.channels.read_rows(path, block_.first, block_.count);
  };
  block_.position = rows("/chassis/position");
  block_.orientation = rows("/chassis/orientation");
  block_.velocity = rows("/chassis/velocity");
  block_.angle = rows("/joints/angle");
  for (const Side side : {Side::left, Side::right}) {
    const auto s = static_cast<std::size_t>(index_of(side));
    const std::string track = std::string("/tracks/") + name_of(side);
    block_.link_position[s] = rows(track + "/link_position");
    block_.link_orientation[s] = rows(track + "/link_orientation");
  }
}

VehiclePose PoseReader::sample(std::size_t row) const {
  const std::size_t i = row - block_.first;
  VehiclePose pose;
  pose.time = time_[row];
  pose.chassis = {vector_at(block_.position.row(i), 0), quaternion_at(block_.orientation.row(i), 0)};
  pose.speed = vector_at(block_.velocity.row(i), 0).head<2>().norm();
  const std::span<const double> angle = block_.angle.row(i);
  for (std::size_t s = 0; s < k_num_sides; ++s) {
    const JointColumns& columns = columns_[s];
    SideAngles& angles = pose.angles[s];
    for (const std::size_t c : columns.arms) angles.arms.push_back(angle[c]);
    for (const std::size_t c : columns.wheels) angles.wheels.push_back(angle[c]);
    for (const std::size_t c : columns.rollers) angles.rollers.push_back(angle[c]);
    angles.idler_arm = angle[columns.idler_arm];
    angles.idler = angle[columns.idler];
    angles.sprocket = angle[columns.sprocket];
    const std::span<const double> position = block_.link_position[s].row(i);
    const std::span<const double> orientation = block_.link_orientation[s].row(i);
    for (std::size_t link = 0; link < position.size() / 3; ++link)
      pose.links[s].push_back({vector_at(position, link), quaternion_at(orientation, link).normalized()});
  }
  return pose;
}

VehiclePose PoseReader::at(double time) {
  const double held = std::clamp(time, time_.front(), time_.back());
  const auto after = std::upper_bound(time_.begin(), time_.end(), held);
  const auto next = std::min(static_cast<std::size_t>(after - time_.begin()), time_.size() - 1);
  const std::size_t row = next > 0 ? next - 1 : 0;
  load(row);
  const VehiclePose a = sample(row);
  if (next == row) return a;
  const VehiclePose b = sample(next);
  const double weight = std::clamp((held - a.time) / (b.time - a.time), 0.0, 1.0);
  VehiclePose pose;
  pose.time = held;
  pose.speed = blend(a.speed, b.speed, weight);
  pose.chassis = blend(a.chassis, b.chassis, weight);
  for (std::size_t s = 0; s < k_num_sides; ++s) {
    pose.angles[s] = blend(a.angles[s], b.angles[s], weight);
    pose.links[s] = blend(a.links[s], b.links[s], weight);
  }
  return pose;
}

}  // namespace grouser
