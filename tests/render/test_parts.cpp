#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "model/errors.h"
#include "render/parts.h"
#include "render/pose.h"
#include "render/scene.h"

namespace grouser {
namespace {

Vehicle reference() { return read_vehicle(GROUSER_SOURCE_DIR "/test_data/vehicles/reference.json"); }

/// Triangles whose corners run clockwise seen from outside, so that culling would open a hole.
int wrongly_wound(const Mesh& mesh) {
  int wrong = 0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const Vertex &a = mesh.vertices[mesh.indices[i]], &b = mesh.vertices[mesh.indices[i + 1]],
                 &c = mesh.vertices[mesh.indices[i + 2]];
    const Vector3f across = (b.position - a.position).cross(c.position - a.position);
    wrong += across.dot(a.normal + b.normal + c.normal) > 0.0f ? 0 : 1;
  }
  return wrong;
}

/// By the divergence theorem; right for closed bodies only.
double volume(const Mesh& mesh) {
  double sum = 0.0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const auto at = [&](std::size_t k) { return mesh.vertices[mesh.indices[i + k]].position; };
    sum += static_cast<double>(at(0).dot(at(1).cross(at(2))));
  }
  return sum / 6.0;
}

Eigen::AlignedBox3f bounds(const Mesh& mesh) {
  Eigen::AlignedBox3f box;
  for (const Vertex& vertex : mesh.vertices) box.extend(vertex.position);
  return box;
}

TEST(Mesh, BodiesEncloseTheirVolume) {
  const Material material;
  Mesh box, bevelled, frustum, hanging, cylinder;
  box.add_box({1, 2, 3}, {0.5f, 1.0f, 1.5f}, 0.0f, material);
  EXPECT_NEAR(volume(box), 6.0, 1e-5);
  bevelled.add_box({1, 2, 3}, {0.5f, 1.0f, 1.5f}, 0.1f, material);
  EXPECT_LT(volume(bevelled), 6.0);
  EXPECT_GT(volume(bevelled), 5.8);  // 12 edges lose half a square of 0.1 m over 24 m, a little less at the corners
  frustum.add_frustum({0, 0, 0}, {1, 1}, 3.0f, {0, 0}, material);
  EXPECT_NEAR(volume(frustum), 4.0, 1e-5);
  hanging.add_frustum({0, 0, 0}, {1, 1}, -3.0f, {1, 1}, material);
  EXPECT_NEAR(volume(hanging), 12.0, 1e-5);
  cylinder.add_lathe({{0, -1}, {1, -1}, {1, 1}, {0, 1}}, 90, {0, 0, 0}, material);
  EXPECT_NEAR(volume(cylinder), 2.0 * 90.0 * 0.5 * std::sin(2.0 * k_pi / 90.0), 1e-4);
}

TEST(Mesh, WeldingKeepsTheBody) {
  Mesh mesh = link_mesh(reference().side(Side::left).track);
  const double before = volume(mesh);
  const std::size_t vertices = mesh.vertices.size(), triangles = mesh.num_triangles();
  mesh.weld();
  EXPECT_EQ(volume(mesh), before);
  EXPECT_EQ(mesh.num_triangles(), triangles);
  EXPECT_LT(mesh.vertices.size(), vertices);
}

TEST(Parts, EveryTriangleFacesOutwards) {
  const Vehicle vehicle = reference();
  const RunningGear& gear = vehicle.side(Side::right);
  const Station& station = gear.stations.front();
  EXPECT_EQ(wrongly_wound(link_mesh(gear.track)), 0);
  EXPECT_EQ(wrongly_wound(link_shadow_mesh(gear.track)), 0);
  EXPECT_EQ(wrongly_wound(sprocket_mesh(gear.sprocket, gear.track)), 0);
  EXPECT_EQ(wrongly_wound(road_wheel_mesh(station.wheel)), 0);
  EXPECT_EQ(wrongly_wound(idler_mesh(gear.idler.wheel)), 0);
  EXPECT_EQ(wrongly_wound(roller_mesh(gear.support_rollers.front())), 0);
  EXPECT_EQ(wrongly_wound(arm_mesh(station.wheel.center - station.pivot, station.wheel, 1.0)), 0);
  EXPECT_EQ(wrongly_wound(chassis_mesh(vehicle)), 0);
}

TEST(Parts, ALinkHasTheTracksDimensionsInFewTriangles) {
  const Track track = reference().side(Side::left).track;
  const Mesh mesh = link_mesh(track);
  EXPECT_LT(mesh.num_triangles(), 400U);
  EXPECT_LT(link_mesh(track, {Detail::k_coarse}).num_triangles(), 180U);
  const Eigen::AlignedBox3f box = bounds(mesh);
  EXPECT_NEAR(box.max().y() - box.min().y(), track.shoe_width, 1e-6);
  EXPECT_NEAR(box.min().z(), -track.ground_depth, 1e-6);
  EXPECT_NEAR(box.max().z(), track.wheel_path_height + track.guide_height, 1e-6);
  EXPECT_GT(box.max().x(), 0.5 * track.pitch);  // the pin at the next joint
}

TEST(Parts, ADoublePinHasAConnectorFromPinToPin) {
  const Vehicle vehicle = read_vehicle(GROUSER_SOURCE_DIR "/test_data/vehicles/reference_double_pin.json");
  const Track& track = vehicle.side(Side::left).track;
  const Mesh link = link_mesh(track), connector = connector_mesh(track);
  EXPECT_EQ(wrongly_wound(link), 0);
  EXPECT_EQ(wrongly_wound(connector), 0);
  EXPECT_NEAR(bounds(link).max().x(), -bounds(link).min().x(), 1e-6);  // a pin at either end
  EXPECT_LT(bounds(link).max().x(), 0.5 * track.pitch);                // and none in the joint's middle
  EXPECT_NEAR(bounds(connector).max().x(), 0.5 * track.connector.length + 1.3 * track.pin_radius, 1e-6);
  EXPECT_LT(bounds(connector).max().y(), 0.5 * track.shoe_width);
}

TEST(Parts, ThePinFitsTheSprocketsGap) {
  const RunningGear gear = reference().side(Side::left);
  const Mesh mesh = sprocket_mesh(gear.sprocket, gear.track);
  const double pitch_radius = gear.track.pitch / (2.0 * std::sin(k_pi / gear.sprocket.teeth));
  double nearest = 1.0, farthest = 0.0;
  for (const Vertex& v : mesh.vertices) {
    if (std::abs(std::abs(v.position.y()) - gear.sprocket.ring_offset) > 0.0181) continue;  // the rings' own width
    const double radius = std::hypot(v.position.x(), v.position.z());
    farthest = std::max(farthest, radius);
    if (radius > 0.9 * gear.sprocket.base_radius)
      nearest = std::min(nearest, std::hypot(v.position.x() - pitch_radius, v.position.z()));
  }
  EXPECT_NEAR(farthest, gear.sprocket.tip_radius, 1e-6);
  EXPECT_GE(nearest, gear.track.pin_radius - 1e-6);  // no tooth reaches into a seated pin
  EXPECT_LT(nearest, gear.track.pin_radius + 2.0 * gear.sprocket.seat_clearance + 1e-3);
}

TEST(Parts, AVehicleWithoutVisualSectionGetsAHull) {
  Vehicle vehicle = reference();
  vehicle.visual_parts.clear();
  vehicle.visual_tubes.clear();
  const Mesh hull = chassis_mesh(vehicle);
  EXPECT_GT(volume(hull), 1.0);  // m^3
  const RunningGear& gear = vehicle.side(Side::left);
  EXPECT_LT(bounds(hull).max().y(), gear.track_center_y - 0.5 * gear.track.shoe_width);
}

TEST(Parts, ColoursAreRead) {
  EXPECT_EQ(parse_color("#ff8000")[0], 1.0f);
  EXPECT_NEAR(parse_color("#ff8000")[1], 128.0 / 255.0, 1e-6);
  for (const char* wrong : {"ff8000", "#ff80", "#gg8000", ""}) EXPECT_THROW((void)parse_color(wrong), InputError);
}

TEST(DesignPose, LinksHangTogetherAndLieOnTheGround) {
  const Vehicle vehicle = reference();
  const VehiclePose pose = design_pose(vehicle, 0.3);
  const Track& track = vehicle.side(Side::left).track;
  const std::vector<BodyPose>& links = pose.links[0];
  ASSERT_EQ(links.size(), static_cast<std::size_t>(track.num_links));
  const Vector3d half(0.5 * track.pitch, 0.0, 0.0);
  double lowest = 1.0;
  for (std::size_t i = 0; i < links.size(); ++i) {
    const BodyPose &a = links[i], &b = links[(i + 1) % links.size()];
    const double gap = (a.position + a.orientation * half - b.position + b.orientation * half).norm();
    EXPECT_LT(gap, 0.004);  // the taut line is 38 mm longer than 76 unstretched pitches
    lowest = std::min(lowest, a.position.z() - track.ground_depth);
  }
  EXPECT_NEAR(lowest, 0.0, 1e-3);
}

TEST(VehicleModel, PlacesEveryBody) {
  const Vehicle vehicle = reference();
  const Scene scene = VehicleModel(vehicle).place(design_pose(vehicle));
  std::size_t bodies = 0;
  for (const auto& group : scene.instances) bodies += group.size();
  EXPECT_EQ(bodies, 189U);
}

TEST(VehicleModel, TurningATrailingArmAboutYRaisesItsWheel) {
  const Vehicle vehicle = reference();
  VehiclePose pose = design_pose(vehicle);
  const VehicleModel model(vehicle);
  const auto wheel_height = [&] { return model.place(pose).instances[2].front().X_WB(2, 3); };  // first left wheel
  const float before = wheel_height();
  pose.angles[0].arms[0] = 0.1;  // about +y: what lies behind the pivot rises
  EXPECT_GT(wheel_height(), before + 0.02f);
}

}  // namespace
}  // namespace grouser
