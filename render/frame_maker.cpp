#include "render/frame_maker.h"

#include <fmt/format.h>

#include <opencv2/imgproc.hpp>

#include "render/terrain_mesh.h"

namespace grouser {
namespace {

constexpr int k_still_supersampling = 2;

Image reduced(const Image& from, int factor) {
  if (factor == 1) return from;
  const cv::Mat large(from.height, from.width, CV_8UC3, const_cast<std::uint8_t*>(from.bgr.data()));
  Image image{from.width / factor, from.height / factor, {}};
  image.bgr.resize(static_cast<std::size_t>(image.width) * image.height * 3);
  cv::Mat small(image.height, image.width, CV_8UC3, image.bgr.data());
  cv::resize(large, small, small.size(), 0.0, 0.0, cv::INTER_AREA);
  return image;
}

float aspect_of(const RenderOptions& options) {
  return static_cast<float>(options.width) / static_cast<float>(options.height);
}

}  // namespace

FrameMaker::FrameMaker(const RunFolder& run, const RenderOptions& options, int supersampling)
    : options_(options),
      ground_(run.scenario.terrain),
      supersampling_(supersampling),
      name_(run.summary.name),
      note_(run.summary.provenance.synthetic.empty() ? "" : "synthetic rig data"),
      poses_(run),
      model_(run.vehicle, run.scenario.output.probes),
      renderer_(context_, supersampling * options.width, supersampling * options.height),
      caption_(context_, renderer_.width(), renderer_.height(), renderer_.picture()) {
  if (!ground_.level()) {
    const auto& [left, right] = run.vehicle.sides;
    terrain_ = std::make_shared<const Mesh>(terrain_mesh(ground_, left.track_center_y - right.track_center_y));
  }
  start_heading_ = heading_of(poses_.at(first_time()).chassis.orientation);
}

void FrameMaker::write_caption(const VehiclePose& pose) {
  caption_.begin();
  const float unit = static_cast<float>(renderer_.height()) / 720.0f;
  const float size = std::max(17.0f * unit, 9.0f), left = 22.0f * unit;
  const float bottom = caption_.size().y() - 20.0f * unit;
  std::string name = name_;
  if (!note_.empty()) name += " · " + note_;
  const std::string numbers = fmt::format("t = {:5.2f} s     {:4.1f} km/h", pose.time, 3.6 * pose.speed);
  TextStyle style{size, {{0.0f, 0.0f, 0.0f}, 0.55f}, TextAlign::left, true, false};
  const auto write = [&](float x, float y) {
    style.bold = true;
    caption_.text({left + x, bottom - 1.45f * size + y}, numbers, style);
    style.bold = false;
    caption_.text({left + x, bottom + y}, name, style);
  };
  write(std::max(1.0f, 1.3f * unit), std::max(1.0f, 1.3f * unit));  // a shadow keeps the text legible on any ground
  style.color = {{1.0f, 1.0f, 1.0f}};
  write(0.0f, 0.0f);
}

Image FrameMaker::at(double time) {
  const VehiclePose pose = poses_.at(time);
  Scene scene = model_.place(pose);
  scene.terrain = terrain_;
  Subject subject = model_.subject(pose, start_heading_);
  const Vector3d& chassis = pose.chassis.position;
  subject.ground = static_cast<float>(ground_.slope * chassis.x() + ground_.cross_slope * chassis.y());
  scene.camera = make_camera(options_.camera, subject, aspect_of(options_));
  renderer_.draw(scene);
  write_caption(pose);
  return reduced(caption_.read(), supersampling_);
}

Image render_pose(const Vehicle& vehicle, const VehiclePose& pose, const RenderOptions& options) {
  const GlContext context;
  SceneRenderer renderer(context, k_still_supersampling * options.width, k_still_supersampling * options.height);
  const VehicleModel model(vehicle);
  Scene scene = model.place(pose);
  scene.camera =
      make_camera(options.camera, model.subject(pose, heading_of(pose.chassis.orientation)), aspect_of(options));
  renderer.draw(scene);
  return reduced(renderer.read(), k_still_supersampling);
}

Image render_still(const RunFolder& run, double time, const RenderOptions& options) {
  return FrameMaker(run, options, k_still_supersampling).at(time);
}

}  // namespace grouser
