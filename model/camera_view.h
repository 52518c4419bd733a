#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "model/geometry.h"

namespace grouser {

/// What a camera moves with. Origin of `follow` and `heading`: under the vehicle frame's origin, on the ground.
enum class CameraMount {
  world,    ///< stands still: positions are in W
  follow,   ///< moves along, axes as at the start of the run
  heading,  ///< moves along and turns with the vehicle about z
  chassis   ///< fixed to the hull: positions are in V
};

/// A camera of the user's own (camera.json).
struct CameraView {
  std::string name;
  CameraMount mount = CameraMount::heading;
  Vector3d eye = Vector3d::Zero(), target = Vector3d::Zero();  ///< m, in the frame of the mount; not the same place
  double field_of_view = 0.0;                                  ///< rad, vertical, of a perspective: below pi
  std::optional<double> height;                                ///< m across the picture's height, of a parallel view
};

/// Reads `grouser.camera/1`; throws InputError with every finding.
[[nodiscard]] CameraView read_camera_view(const std::filesystem::path& file);

}  // namespace grouser
