#pragma once
#include "model/ground_surface.h"
#include "render/gl_canvas.h"
#include "render/load_overlay.h"
#include "render/render.h"
#include "render/scene_renderer.h"

namespace grouser {

/// Pictures of one run in one size: poses, scene, camera, caption.
class FrameMaker {
 public:
  /// `supersampling`: pixels drawn for one pixel of the picture, along each axis; stills take 2. The run must outlive
  /// it.
  FrameMaker(const RunFolder& run, const RenderOptions& options, int supersampling);

  [[nodiscard]] Image at(double time);
  FrameMaker(const FrameMaker&) = delete;
  FrameMaker& operator=(const FrameMaker&) = delete;

  [[nodiscard]] double first_time() const { return poses_.first_time(); }
  [[nodiscard]] double last_time() const { return poses_.last_time(); }

 private:
  [[nodiscard]] Camera camera_at(const VehiclePose& pose) const;
  void write_caption(const VehiclePose& pose);

  RenderOptions options_;
  GroundSurface ground_;
  int supersampling_;
  std::string name_, note_;
  PoseReader poses_;
  VehicleModel model_;
  std::optional<LoadOverlay> overlay_;
  std::shared_ptr<const Mesh> terrain_;
  Vector2f slope_ = Vector2f::Zero();  ///< of the plane on which everything stands
  double start_heading_ = 0.0;
  GlContext context_;
  SceneRenderer renderer_;
  GlCanvas caption_;
};

/// Frames of several runs side by side, on one clock.
class SplitScreen {
 public:
  SplitScreen(const Runs& runs, const RenderOptions& options, int supersampling);
  [[nodiscard]] Image at(double time);
  [[nodiscard]] double first_time() const;
  [[nodiscard]] double last_time() const;

 private:
  std::vector<std::unique_ptr<FrameMaker>> parts_;
};

/// Picture of a vehicle in a pose without a run.
[[nodiscard]] Image render_pose(const Vehicle& vehicle, const VehiclePose& pose, const RenderOptions& options = {});

}  // namespace grouser
