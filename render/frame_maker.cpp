#include "render/frame_maker.h"

#include <fmt/format.h>

#include <algorithm>

#include "render/ground_section.h"
#include "render/terrain_mesh.h"

namespace grouser {
namespace {

constexpr int k_still_supersampling = 2;

/// Every pixel the mean of as many of the larger picture, rounded.
Image reduced(const Image& from, int factor) {
  if (factor == 1) return from;
  Image image{from.width / factor, from.height / factor, {}};
  image.bgr.reserve(3 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  const int stride = 3 * from.width, count = factor * factor;
  for (int y = 0; y < image.height; ++y) {
    for (int byte = 0; byte < 3 * image.width; ++byte) {
      const std::uint8_t* corner =
          &from.bgr[static_cast<std::size_t>(y * factor * stride + byte / 3 * 3 * factor + byte % 3)];
      int sum = count / 2;
      for (int i = 0; i < factor; ++i)
        for (int j = 0; j < factor; ++j) sum += corner[i * stride + 3 * j];
      image.bgr.push_back(static_cast<std::uint8_t>(sum / count));
    }
  }
  return image;
}

double tread_of(const Vehicle& vehicle) {
  return vehicle.side(Side::left).track_center_y - vehicle.side(Side::right).track_center_y;
}

std::size_t drawn_pixels(const RenderOptions& options, int supersampling) {
  return static_cast<std::size_t>(supersampling * options.width) *
         static_cast<std::size_t>(supersampling * options.height);
}

float aspect_of(const RenderOptions& options) {
  return static_cast<float>(options.width) / static_cast<float>(options.height);
}

/// A white line between two pictures side by side: the last column of one, the first of the other.
void draw_edges(Image& left, Image& right) {
  const auto whiten = [](Image& image, int x) {
    for (int y = 0; y < image.height; ++y)
      std::fill_n(image.bgr.begin() + 3 * (y * image.width + x), 3, std::uint8_t{255});
  };
  whiten(left, left.width - 1);
  whiten(right, 0);
}

}  // namespace

FrameMaker::FrameMaker(const RunFolder& run, const RenderOptions& options, int supersampling)
    : options_(options),
      ground_(run.scenario.terrain, tread_of(run.vehicle)),
      supersampling_(supersampling),
      name_(run.summary.name),
      note_(run.summary.provenance.synthetic.empty() ? "" : "synthetic rig data"),
      poses_(run),
      model_(run.vehicle, run.scenario.output.probes),
      context_(drawn_pixels(options, supersampling)),
      renderer_(context_, supersampling * options.width, supersampling * options.height),
      caption_(context_, renderer_.width(), renderer_.height(), renderer_.picture()) {
  if (!options.overlays.empty()) overlay_.emplace(run, options.overlays, model_);
  if (!ground_.level())
    terrain_ = std::make_shared<const Mesh>(terrain_mesh(run.scenario.terrain, tread_of(run.vehicle)));
  slope_ = {static_cast<float>(run.scenario.terrain.slope), static_cast<float>(run.scenario.terrain.cross_slope)};
  start_heading_ = heading_of(poses_.at(first_time()).chassis.orientation);
}

Camera FrameMaker::camera_at(const VehiclePose& pose) const {
  Subject subject = model_.subject(pose, start_heading_);
  subject.ground = slope_.dot(pose.chassis.position.head<2>().cast<float>());
  return options_.view ? make_camera(*options_.view, subject)
                       : make_camera(options_.camera, subject, aspect_of(options_));
}

void FrameMaker::write_caption(const VehiclePose& pose) {
  caption_.begin();
  const float unit = static_cast<float>(renderer_.height()) / 720.0f;
  const float size = std::max(17.0f * unit, 9.0f), left = 22.0f * unit;
  const float bottom = caption_.size().y() - 20.0f * unit;
  std::string name = name_;
  if (!note_.empty()) name += " · " + note_;
  std::string numbers = fmt::format("t = {:5.2f} s     {:4.1f} km/h", pose.time, 3.6 * pose.speed);
  if (options_.speed != 1.0) numbers += fmt::format("     at {:g} of its speed", options_.speed);
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
  if (overlay_) draw_legends(caption_, overlay_->legends(), unit);
}

Image FrameMaker::at(double time) {
  const VehiclePose pose = poses_.at(time);
  Scene scene = model_.place(pose);
  scene.terrain = terrain_;
  scene.camera = camera_at(pose);
  if (scene.camera.shows_section()) scene.section = ground_section(ground_, scene.camera, aspect_of(options_));
  if (overlay_) overlay_->add_to(scene, pose);
  renderer_.draw(scene);
  write_caption(pose);
  return reduced(caption_.read(), supersampling_);
}

SplitScreen::SplitScreen(const Runs& runs, const RenderOptions& options, int supersampling) {
  const int count = static_cast<int>(runs.size());
  int left = 0;
  for (int i = 0; i < count; ++i) {
    const int right = i + 1 == count ? options.width : (i + 1) * options.width / count / 2 * 2;
    RenderOptions own = options;
    own.width = right - left;
    left = right;
    parts_.push_back(std::make_unique<FrameMaker>(*runs[static_cast<std::size_t>(i)], own, supersampling));
  }
}

double SplitScreen::first_time() const {
  double first = parts_.front()->first_time();
  for (const auto& part : parts_) first = std::min(first, part->first_time());
  return first;
}

double SplitScreen::last_time() const {
  double last = parts_.front()->last_time();
  for (const auto& part : parts_) last = std::max(last, part->last_time());
  return last;
}

Image SplitScreen::at(double time) {
  if (parts_.size() == 1) return parts_.front()->at(time);
  std::vector<Image> views;
  for (const auto& part : parts_) views.push_back(part->at(time));
  for (std::size_t i = 0; i + 1 < views.size(); ++i) draw_edges(views[i], views[i + 1]);
  Image joined{0, views.front().height, {}};
  for (const Image& view : views) joined.width += view.width;
  for (int y = 0; y < joined.height; ++y) {
    for (const Image& view : views) {
      const auto row = view.bgr.begin() + 3 * y * view.width;
      joined.bgr.insert(joined.bgr.end(), row, row + 3 * view.width);
    }
  }
  return joined;
}

Image render_pose(const Vehicle& vehicle, const VehiclePose& pose, const RenderOptions& options) {
  const GlContext context(drawn_pixels(options, k_still_supersampling));
  SceneRenderer renderer(context, k_still_supersampling * options.width, k_still_supersampling * options.height);
  const VehicleModel model(vehicle);
  Scene scene = model.place(pose);
  scene.camera =
      make_camera(options.camera, model.subject(pose, heading_of(pose.chassis.orientation)), aspect_of(options));
  if (scene.camera.shows_section())
    scene.section = ground_section(GroundSurface({}, tread_of(vehicle)), scene.camera, aspect_of(options));
  renderer.draw(scene);
  return reduced(renderer.read(), k_still_supersampling);
}

Image render_still(const Runs& runs, double time, const RenderOptions& options) {
  return SplitScreen(runs, options, k_still_supersampling).at(time);
}

}  // namespace grouser
