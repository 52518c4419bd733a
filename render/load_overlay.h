#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "render/legend.h"
#include "render/loads.h"
#include "render/scene.h"

namespace grouser {

/// The physics drawn over a scene; see overlay_names(). Scales are those of the whole run, so that a colour means the
/// same in every frame.
class LoadOverlay {
 public:
  /// Adds its meshes to `model`. Throws InputError for an unknown name. The run must outlive it.
  LoadOverlay(const RunFolder& run, const std::vector<std::string>& names, VehicleModel& model);

  void add_to(Scene& scene, const VehiclePose& pose);
  [[nodiscard]] const std::vector<Legend>& legends() const { return legends_; }

 private:
  /// Way of one wheel's axle.
  struct Trail {
    Rgb color{};
    Side side = Side::left;
    std::size_t station = 0;
    std::vector<double> time;     ///< s
    std::vector<Vector3f> place;  ///< m, W
  };
  void set_up_forces();
  void set_up_tension(const LoadReader::Range& range);
  void set_up_pressure(const LoadReader::Range& range);
  void set_up_paths();
  void add_forces(Scene& scene, const VehiclePose& pose, const TrackLoads& loads) const;
  void add_arrow(Scene& scene, const Vector3d& tip, const Vector3d& force, LoadPartner partner) const;
  void add_tension(Scene& scene, const TrackLoads& loads) const;
  void add_pressure(Scene& scene, const VehiclePose& pose, const TrackLoads& loads) const;
  void add_paths(Scene& scene, const VehiclePose& pose) const;

  const RunFolder& run_;
  VehicleModel& model_;
  LoadReader loads_;
  bool forces_ = false;
  double force_per_metre_ = 1.0;  ///< N
  std::size_t shaft_ = 0, head_ = 0, tile_ = 0;
  std::optional<ColorScale> tension_, pressure_;  ///< N, Pa
  std::vector<Trail> trails_;
  std::vector<Legend> legends_;
};

}  // namespace grouser
