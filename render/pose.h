#pragma once
#include <array>
#include <vector>

#include "model/geometry.h"
#include "model/run.h"

namespace grouser {

/// Pose of one body in World.
struct BodyPose {
  Vector3d position = Vector3d::Zero();  ///< m
  Quaterniond orientation = Quaterniond::Identity();
};

/// Joint angles of one side [rad] about V's +y relative to the parent, 0 at design.
struct SideAngles {
  std::vector<double> arms, wheels, rollers;
  double idler_arm = 0.0, idler = 0.0, sprocket = 0.0;
};

/// Where every body of a vehicle is at one time.
struct VehiclePose {
  double time = 0.0;   ///< s
  double speed = 0.0;  ///< m/s, horizontal
  BodyPose chassis;    ///< the vehicle frame V
  std::array<SideAngles, k_num_sides> angles;
  std::array<std::vector<BodyPose>, k_num_sides> links;
};

/// The vehicle at design height with its links along the taut line round the running gear, the track moved by `travel`
/// [m] and the wheels turned with it: a pose without a run, for stills of a vehicle file and for tests.
[[nodiscard]] VehiclePose design_pose(const Vehicle& vehicle, double travel = 0.0);

/// Poses of a run by time. Reads rows in blocks, so that a film passes once over run.h5 and keeps little of it.
class PoseReader {
 public:
  /// The run must outlive the reader. Throws InputError when the run has no samples or lacks a joint of its vehicle.
  explicit PoseReader(const RunFolder& run);

  [[nodiscard]] double first_time() const { return time_.front(); }
  [[nodiscard]] double last_time() const { return time_.back(); }
  /// Interpolated between samples (positions linearly, orientations by normalised blend); held at the ends.
  [[nodiscard]] VehiclePose at(double time);

 private:
  struct Block {
    std::size_t first = 0, count = 0;
    Array position, orientation, velocity, angle;
    std::array<Array, k_num_sides> link_position, link_orientation;
  };
  /// Column of each joint in /joints/angle.
  struct JointColumns {
    std::vector<std::size_t> arms, wheels, rollers;
    std::size_t idler_arm = 0, idler = 0, sprocket = 0;
  };
  [[nodiscard]] VehiclePose sample(std::size_t row) const;
  void load(std::size_t row);

  const RunFolder& run_;
  std::vector<double> time_;
  std::array<JointColumns, k_num_sides> columns_;
  Block block_;
};

}  // namespace grouser
