#include "render/scene.h"

#include <algorithm>
#include <cmath>

#include "render/parts.h"

namespace grouser {
namespace {

constexpr int k_tinted_every = 10;
const Eigen::Vector4f k_link_tint(0.75f, 0.42f, 0.07f, 0.55f);   ///< amber
const Eigen::Vector4f k_probe_tint(0.80f, 0.06f, 0.03f, 0.80f);  ///< red

using Placed = Eigen::Affine3d;

Placed placed(const Vector3d& position, double angle = 0.0) {
  return Eigen::Translation3d(position) * Placed(Eigen::AngleAxisd(angle, Vector3d::UnitY()));
}

Placed placed(const BodyPose& pose) { return Eigen::Translation3d(pose.position) * Placed(pose.orientation); }

/// A connector from the front pin of a link to the rear pin of the next one.
Placed placed_between(const BodyPose& link, const BodyPose& next, const Track& track) {
  const Vector3d joint(0.5 * (track.pitch - track.connector.length), 0.0, 0.0);
  const Vector3d rear = link.position + link.orientation * joint, front = next.position - next.orientation * joint;
  Eigen::Matrix3d axes;
  axes.col(0) = (front - rear).normalized();
  const Vector3d up = link.orientation * Vector3d::UnitZ() + next.orientation * Vector3d::UnitZ();
  axes.col(1) = up.cross(axes.col(0)).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return Eigen::Translation3d(0.5 * (rear + front)) * Placed(axes);
}

Instance instance(const Placed& X_WB, const Eigen::Vector4f& tint = Eigen::Vector4f::Zero()) {
  return {X_WB.matrix().cast<float>(), tint, 0.0f};
}

}  // namespace

VehicleModel::VehicleModel(const Vehicle& vehicle, const std::vector<ProbeLink>& probes)
    : vehicle_(vehicle), probes_(probes) {
  meshes_ = std::make_shared<std::vector<SceneMesh>>();
  const auto add = [this](const auto& make, Mesh shadow = {}) {
    SceneMesh mesh{make(Detail{Detail::k_middle}), std::move(shadow), false, make(Detail{Detail::k_coarse}),
                   make(Detail{Detail::k_fine})};
    for (Mesh* each : {&mesh.shape, &mesh.shadow, &mesh.coarse, &mesh.fine}) each->weld();
    meshes_->push_back(std::move(mesh));
    return meshes_->size() - 1;
  };
  const auto add_discs = [&add](Mesh make(const DiscPair&, const Detail&), const DiscPair& discs) {
    return add([&](const Detail& detail) { return make(discs, detail); }, disc_pair_shadow_mesh(discs));
  };
  const auto add_arm = [&add](const Vector3d& pivot, const DiscPair& wheel, double inboard) {
    const auto make = [&](const Detail& detail) { return arm_mesh(wheel.center - pivot, wheel, inboard, detail); };
    return add(make, make(Detail{Detail::k_coarse}));
  };
  chassis_mesh_ = add([&](const Detail& detail) { return chassis_mesh(vehicle, detail); });
  for (const Vertex& vertex : meshes_->back().shape.vertices) {
    nose_ = std::max(nose_, vertex.position.x());
    tail_ = std::min(tail_, vertex.position.x());
  }
  for (std::size_t s = 0; s < k_num_sides; ++s) {
    const RunningGear& gear = vehicle.sides[s];
    const double inboard = gear.track_center_y > 0.0 ? -1.0 : 1.0;
    SideMeshes& own = side_meshes_[s];
    for (const Station& station : gear.stations) {
      own.arms.push_back(add_arm(station.pivot, station.wheel, inboard));
      own.wheels.push_back(add_discs(road_wheel_mesh, station.wheel));
    }
    for (const DiscPair& roller : gear.support_rollers) own.rollers.push_back(add_discs(roller_mesh, roller));
    own.idler_arm = add_arm(gear.idler.pivot, gear.idler.wheel, inboard);
    own.idler = add_discs(idler_mesh, gear.idler.wheel);
    const auto sprocket = [&](const Detail& detail) { return sprocket_mesh(gear.sprocket, gear.track, detail); };
    own.sprocket = add(sprocket, sprocket(Detail{Detail::k_coarse}));
    own.link = add([&](const Detail& detail) { return link_mesh(gear.track, detail); }, link_shadow_mesh(gear.track));
    if (gear.track.connection == Connection::double_pin)
      own.connector = add([&](const Detail& detail) { return connector_mesh(gear.track, detail); });
  }
}

std::size_t VehicleModel::add_annotation(Mesh shape) {
  shape.weld();
  meshes_ = std::make_shared<std::vector<SceneMesh>>(*meshes_);  // scenes that were placed keep theirs
  meshes_->push_back({std::move(shape), {}, true, {}, {}});
  return meshes_->size() - 1;
}

void VehicleModel::color_links(Scene& scene, Side side, const std::vector<Vector3f>& colors, float glow) const {
  std::vector<Instance>& links = scene.instances[side_meshes_[static_cast<std::size_t>(index_of(side))].link];
  for (std::size_t i = 0; i < links.size() && i < colors.size(); ++i) {
    links[i].tint << colors[i], 0.88f;
    links[i].glow = glow;
  }
}

Scene VehicleModel::place(const VehiclePose& pose) const {
  Scene scene;
  scene.meshes = meshes_;
  scene.instances.resize(meshes_->size());
  const auto put = [&scene](std::size_t mesh, const Instance& at) { scene.instances[mesh].push_back(at); };
  const Placed X_WV = placed(pose.chassis);
  put(chassis_mesh_, instance(X_WV));
  for (const Side side : {Side::left, Side::right}) {
    const auto s = static_cast<std::size_t>(index_of(side));
    const RunningGear& gear = vehicle_.sides[s];
    const SideAngles& angles = pose.angles[s];
    const SideMeshes& mesh = side_meshes_[s];
    for (std::size_t i = 0; i < gear.stations.size(); ++i) {
      const Station& station = gear.stations[i];
      const Placed X_WA = X_WV * placed(station.pivot, angles.arms[i]);
      put(mesh.arms[i], instance(X_WA));
      put(mesh.wheels[i], instance(X_WA * placed(station.wheel.center - station.pivot, angles.wheels[i])));
    }
    for (std::size_t i = 0; i < gear.support_rollers.size(); ++i)
      put(mesh.rollers[i], instance(X_WV * placed(gear.support_rollers[i].center, angles.rollers[i])));
    const Placed X_WI = X_WV * placed(gear.idler.pivot, angles.idler_arm);
    put(mesh.idler_arm, instance(X_WI));
    put(mesh.idler, instance(X_WI * placed(gear.idler.wheel.center - gear.idler.pivot, angles.idler)));
    put(mesh.sprocket, instance(X_WV * placed(gear.sprocket.center, angles.sprocket)));
    for (std::size_t i = 0; i < pose.links[s].size(); ++i) {
      const bool probe = std::any_of(probes_.begin(), probes_.end(), [&](const ProbeLink& p) {
        return p.side == side && p.link == static_cast<int>(i);
      });
      const Eigen::Vector4f tint = probe                     ? k_probe_tint
                                   : i % k_tinted_every == 0 ? k_link_tint
                                                             : Eigen::Vector4f(Eigen::Vector4f::Zero());
      put(mesh.link, instance(placed(pose.links[s][i]), tint));
      if (!mesh.connector) continue;
      const BodyPose& next = pose.links[s][(i + 1) % pose.links[s].size()];
      put(*mesh.connector, instance(placed_between(pose.links[s][i], next, gear.track)));
    }
  }
  const Subject about = subject(pose, 0.0);
  const Vector3d middle = X_WV * Vector3d(0.5 * (about.front + about.rear), 0.0, 0.9);
  scene.shadow_center = middle.cast<float>();
  scene.shadow_radius = 0.5f * (about.front - about.rear) + 1.9f;  // a gun may reach out of it; its end casts none
  scene.footprint.center = middle.head<2>().cast<float>();
  scene.footprint.half = {0.5f * (about.front - about.rear) - 0.1f, about.half_width};
  scene.footprint.heading = static_cast<float>(heading_of(pose.chassis.orientation));
  return scene;
}

Subject VehicleModel::subject(const VehiclePose& pose, double start_heading) const {
  Subject subject;
  subject.pose = pose;
  subject.start_heading = start_heading;
  const RunningGear& gear = vehicle_.side(Side::right);
  subject.sprocket = gear.sprocket.center.cast<float>();
  subject.wheel = gear.stations[gear.stations.size() / 2].wheel.center.cast<float>();
  const Vector3d &a = gear.sprocket.center, &b = gear.idler.wheel.center;
  const double wrap = gear.track.wheel_path_height + gear.track.ground_depth;
  subject.front = static_cast<float>(std::max(a.x(), b.x()) + gear.idler.wheel.radius + wrap);
  subject.rear = static_cast<float>(std::min(a.x(), b.x()) - gear.idler.wheel.radius - wrap);
  subject.nose = std::max(nose_, subject.front);
  subject.tail = std::min(tail_, subject.rear);
  subject.half_width = static_cast<float>(std::abs(gear.track_center_y) + 0.5 * gear.track.shoe_width);
  return subject;
}

}  // namespace grouser
