#include "render/load_overlay.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "model/errors.h"
#include "render/render.h"

namespace grouser {
namespace {

constexpr double k_trail_interval = 1.0 / 30.0;  // s
constexpr double k_pressure_depth = 0.45;        // m of a bar at the scale's end
constexpr float k_link_glow = 0.72f;

/// Colours of Okabe & Ito (2008), told apart by all.
constexpr std::array<Rgb, k_num_load_partners> k_partner_colors{{{0.000f, 0.447f, 0.698f},
                                                                 {0.337f, 0.706f, 0.914f},
                                                                 {0.000f, 0.620f, 0.451f},
                                                                 {0.835f, 0.369f, 0.000f},
                                                                 {0.800f, 0.475f, 0.655f},
                                                                 {0.050f, 0.050f, 0.060f}}};
constexpr std::array<const char*, k_num_load_partners> k_partner_texts{"road wheel", "support roller", "idler",
                                                                       "sprocket",   "centre guide",   "ground"};
constexpr Rgb k_front_trail{0.000f, 0.447f, 0.698f}, k_rear_trail{0.835f, 0.369f, 0.000f};

/// The least 1, 2 or 5 times a power of ten that is not below x > 0.
double round_up(double x) {
  const double power = std::pow(10.0, std::floor(std::log10(x)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (x <= factor * power * (1.0 + 1e-9)) return factor * power;
  }
  return 10.0 * power;
}

/// The range of a scale: least and most of the values, moved out to whole steps.
std::array<double, 2> round_range(double least, double most) {
  const double step = round_up(std::max(most - least, 1e-9) / 10.0);
  return {step * std::floor(least / step), step * std::ceil(most / step)};
}

double weight_per_wheel(const Vehicle& vehicle) {
  double mass = vehicle.chassis.mass;
  std::size_t wheels = 0;
  for (const RunningGear& gear : vehicle.sides) {
    mass += gear.sprocket.body.mass + gear.idler.arm.mass + gear.idler.wheel.body.mass;
    mass += gear.track.num_links * gear.track.link.mass;
    for (const DiscPair& roller : gear.support_rollers) mass += roller.body.mass;
    for (const Station& station : gear.stations) mass += station.arm.mass + station.wheel.body.mass;
    wheels += gear.stations.size();
  }
  return mass * k_standard_gravity / static_cast<double>(wheels);
}

/// Where a partner meets a link, in L: at the outer edge of the shoe, where it is seen.
Vector3d meeting_point(const Track& track, LoadPartner partner, double outward) {
  const double edge = outward * (0.5 * track.shoe_width + 0.02);
  switch (partner) {
    case LoadPartner::ground:
      return {0.0, edge, -track.ground_depth};
    case LoadPartner::sprocket:
      return {0.5 * track.pitch, edge, 0.0};
    case LoadPartner::guide:
      return {0.0, 0.0, track.wheel_path_height + 0.5 * track.guide_height};
    default:
      return {0.0, edge, track.wheel_path_height};
  }
}

Vector3f axle_of(const VehiclePose& pose, const Vehicle& vehicle, Side side, std::size_t station) {
  const Station& at = vehicle.side(side).stations[station];
  const double angle = pose.angles[static_cast<std::size_t>(index_of(side))].arms[station];
  const Eigen::AngleAxisd turn(angle, Vector3d::UnitY());
  const Vector3d in_V = at.pivot + turn * (at.wheel.center - at.pivot);
  return (pose.chassis.position + pose.chassis.orientation * in_V).eval().cast<float>();
}

/// A rod with three faces.
void add_rod(const Vector3f& from, const Vector3f& to, float radius, const Material& material, Mesh& mesh) {
  const Vector3f along = (to - from).normalized();
  const Vector3f u = along.cross(std::abs(along.z()) < 0.9f ? Vector3f::UnitZ() : Vector3f::UnitX()).normalized();
  const Vector3f v = along.cross(u);
  const auto corner = [&](int i) -> Vector3f {
    const auto angle = static_cast<float>(2.0 * k_pi * i / 3.0);
    return radius * (std::cos(angle) * u + std::sin(angle) * v);
  };
  for (int i = 0; i < 3; ++i) {
    const Vector3f a = corner(i), b = corner(i + 1);
    mesh.add_quad(from + a, from + b, to + b, to + a, material);
  }
}

Instance glowing(const Eigen::Affine3f& X_WB, const Rgb& color) {
  Instance instance;
  instance.X_WB = X_WB.matrix();
  instance.tint << linear_rgb(color), 1.0f;
  instance.glow = 1.0f;
  return instance;
}

}  // namespace

std::vector<std::string> overlay_names() { return {"forces", "tension", "pressure", "paths"}; }

LoadOverlay::LoadOverlay(const RunFolder& run, const std::vector<std::string>& names, VehicleModel& model)
    : run_(run), model_(model), loads_(run) {
  const std::vector<std::string> known = overlay_names();
  for (const std::string& name : names) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    throw InputError({"", "overlay", fmt::format("{}", fmt::join(known, " | ")), name, ""});
  }
  const auto asked = [&names](const char* name) { return std::find(names.begin(), names.end(), name) != names.end(); };
  if (asked("forces")) set_up_forces();
  if (asked("tension") || asked("pressure")) {
    const LoadReader::Range range = loads_.range();
    if (asked("tension")) set_up_tension(range);
    if (asked("pressure")) set_up_pressure(range);
  }
  if (asked("paths")) set_up_paths();
}

void LoadOverlay::set_up_forces() {
  forces_ = true;
  force_per_metre_ = round_up(2.0 * weight_per_wheel(run_.vehicle));
  Mesh shaft, head;  // along +y
  shaft.add_lathe({{0, 0}, {1, 0}, {1, 1}}, 8, Vector3f::Zero(), {});
  head.add_lathe({{0, 0}, {1, 0}, {0, 1}}, 10, Vector3f::Zero(), {});
  shaft_ = model_.add_annotation(std::move(shaft));
  head_ = model_.add_annotation(std::move(head));
  Legend legend{"Contact force on a link", {}, {}, fmt::format("1 m of arrow: {:g} kN", force_per_metre_ / 1e3)};
  for (std::size_t p = 0; p < k_num_load_partners; ++p)
    legend.keys.push_back({k_partner_colors[p], std::string("from ") + k_partner_texts[p]});
  legends_.push_back(std::move(legend));
}

void LoadOverlay::set_up_tension(const LoadReader::Range& range) {
  const auto [low, high] = round_range(range.least_tension, range.most_tension);
  tension_ = {viridis(), low, high};
  legends_.push_back({"Track tension [kN]", {}, Legend::Bar{*tension_, 1e3}, ""});
}

void LoadOverlay::set_up_pressure(const LoadReader::Range& range) {
  const Track& track = run_.vehicle.side(Side::left).track;
  const double most = std::max(range.most_ground_load, 1.0) / (track.pitch * track.shoe_width);
  pressure_ = {yellow_to_red(), 0.0, round_range(0.0, most)[1]};
  Mesh tile;
  tile.add_box({0.0f, 0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}, 0.0f, {});
  tile_ = model_.add_annotation(std::move(tile));
  legends_.push_back({"Nominal ground pressure [kPa]", {}, Legend::Bar{*pressure_, 1e3}, ""});
}

void LoadOverlay::set_up_paths() {
  for (const Side side : {Side::left, Side::right}) {
    trails_.push_back({k_front_trail, side, 0, {}, {}});
    trails_.push_back({k_rear_trail, side, run_.vehicle.side(side).stations.size() - 1, {}, {}});
  }
  PoseReader poses(run_);
  const double first = poses.first_time(), last = poses.last_time();
  for (double time = first; time <= last; time += k_trail_interval) {
    const VehiclePose pose = poses.at(time);
    for (Trail& trail : trails_) {
      trail.time.push_back(time);
      trail.place.push_back(axle_of(pose, run_.vehicle, trail.side, trail.station));
    }
  }
  legends_.push_back({"Path of a wheel's axle", {{k_front_trail, "first"}, {k_rear_trail, "last"}}, {}, ""});
}

void LoadOverlay::add_to(Scene& scene, const VehiclePose& pose) {
  if (forces_ || tension_ || pressure_) {
    scene.see_through = model_.chassis_mesh_index();
    const TrackLoads loads = loads_.at(pose.time);
    if (forces_) add_forces(scene, pose, loads);
    if (tension_) add_tension(scene, loads);
    if (pressure_) add_pressure(scene, pose, loads);
  }
  if (!trails_.empty()) add_paths(scene, pose);
}

void LoadOverlay::add_arrow(Scene& scene, const Vector3d& tip, const Vector3d& force, LoadPartner partner) const {
  constexpr float k_radius = 0.017f, k_head_radius = 0.046f, k_head_length = 0.13f;
  const auto length = static_cast<float>(force.norm() / force_per_metre_);
  if (length < 0.02f) return;
  const Vector3f direction = force.normalized().cast<float>(), end = tip.cast<float>();
  const Eigen::Quaternionf turn = Eigen::Quaternionf::FromTwoVectors(Vector3f::UnitY(), direction);
  const float head = std::min(k_head_length, 0.6f * length), slim = head / k_head_length;
  const Rgb& color = k_partner_colors[static_cast<std::size_t>(partner)];
  const auto put = [&](std::size_t mesh, const Vector3f& from, float radius, float reach) {
    scene.instances[mesh].push_back(
        glowing(Eigen::Translation3f(from) * turn * Eigen::Scaling(radius, reach, radius), color));
  };
  put(shaft_, end - length * direction, slim * k_radius, length - head);
  put(head_, end - head * direction, slim * k_head_radius, head);
}

void LoadOverlay::add_forces(Scene& scene, const VehiclePose& pose, const TrackLoads& loads) const {
  for (std::size_t s = 0; s < k_num_sides; ++s) {
    const RunningGear& gear = run_.vehicle.sides[s];
    const double outward = gear.track_center_y > 0.0 ? 1.0 : -1.0;
    for (std::size_t p = 0; p < k_num_load_partners; ++p) {
      const auto partner = static_cast<LoadPartner>(p);
      const Vector3d at_L = meeting_point(gear.track, partner, outward);
      for (std::size_t i = 0; i < pose.links[s].size(); ++i) {
        const BodyPose& link = pose.links[s][i];
        add_arrow(scene, link.position + link.orientation * at_L, loads[s].force[p][i], partner);
      }
    }
  }
}

void LoadOverlay::add_tension(Scene& scene, const TrackLoads& loads) const {
  for (const Side side : {Side::left, Side::right}) {
    const std::vector<double>& tension = loads[static_cast<std::size_t>(index_of(side))].tension;
    std::vector<Vector3f> colors;
    for (std::size_t i = 0; i < tension.size(); ++i) {  // a link carries what its two joints do
      const double behind = tension[(i + tension.size() - 1) % tension.size()];
      colors.push_back(linear_rgb(tension_->at(0.5 * (behind + tension[i]))));
    }
    model_.color_links(scene, side, colors, k_link_glow);
  }
}

void LoadOverlay::add_pressure(Scene& scene, const VehiclePose& pose, const TrackLoads& loads) const {
  for (std::size_t s = 0; s < k_num_sides; ++s) {
    const RunningGear& gear = run_.vehicle.sides[s];
    const Track& track = gear.track;
    const double outward = gear.track_center_y > 0.0 ? 1.0 : -1.0;
    const Vector3d edge_L(0.0, outward * (0.5 * track.shoe_width + 0.03), -track.ground_depth);
    for (std::size_t i = 0; i < pose.links[s].size(); ++i) {
      const BodyPose& link = pose.links[s][i];
      const double pressure =
          loads[s].force[static_cast<std::size_t>(LoadPartner::ground)][i].z() / (track.pitch * track.shoe_width);
      if (pressure < 0.01 * pressure_->high) continue;
      const Vector3d place = link.position + link.orientation * edge_L + Vector3d(0.0, 0.0, 0.012);
      // Upright whatever the link's slope, along its heading, outwards from the track.
      const Eigen::AngleAxisd turn(heading_of(link.orientation), Vector3d::UnitZ());
      const double depth = 0.012 + k_pressure_depth * pressure / pressure_->high;
      Eigen::Affine3d X_WB = Eigen::Translation3d(place) * turn * Eigen::Scaling(0.94 * track.pitch, 0.3, depth);
      if (outward < 0.0) X_WB = X_WB * Eigen::Translation3d(0.0, -1.0, 0.0);
      scene.instances[tile_].push_back(glowing(X_WB.cast<float>(), pressure_->at(pressure)));
    }
  }
}

void LoadOverlay::add_paths(Scene& scene, const VehiclePose& pose) const {
  constexpr float k_radius = 0.022f, k_shortest = 0.02f;  // m
  for (const Trail& trail : trails_) {
    const Material material{trail.color, 0.0f};
    Vector3f from = trail.place.front();
    const auto to = [&](const Vector3f& place) {
      if ((place - from).norm() < k_shortest) return;
      add_rod(from, place, k_radius, material, scene.trails);
      from = place;
    };
    for (std::size_t i = 1; i < trail.time.size() && trail.time[i] < pose.time; ++i) to(trail.place[i]);
    to(axle_of(pose, run_.vehicle, trail.side, trail.station));
  }
}

}  // namespace grouser
