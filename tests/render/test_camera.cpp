#include <gtest/gtest.h>

#include "model/errors.h"
#include "render/render.h"
#include "render/scene.h"

namespace grouser {
namespace {

/// Where a point of World is seen: -1..1 from left to right and from bottom to top.
Vector3f seen(const Camera& camera, const Vector3f& point) {
  const Eigen::Vector4f clip = camera.view_projection(16.0f / 9.0f) * point.homogeneous();
  return clip.head<3>() / clip.w();
}

VehiclePose turned(double heading) {
  VehiclePose pose;
  pose.chassis.position = {30.0, -4.0, 0.0};
  pose.chassis.orientation = Quaterniond(Eigen::AngleAxisd(heading, Vector3d::UnitZ()));
  return pose;
}

TEST(Camera, EveryCameraSeesTheVehicleWhereverItStands) {
  const Vehicle vehicle = read_vehicle(GROUSER_SOURCE_DIR "/test_data/vehicles/reference.json");
  const VehicleModel model(vehicle);
  for (const std::string& name : camera_names()) {
    for (const double heading : {0.0, 2.0}) {
      const Subject subject = model.subject(turned(heading), 0.3);
      const Camera camera = make_camera(name, subject, 16.0f / 9.0f);
      const RunningGear& gear = vehicle.side(Side::right);
      const Vector3d aim_V = name == "sprocket"     ? gear.sprocket.center
                             : name == "road_wheel" ? gear.stations[gear.stations.size() / 2].wheel.center
                                                    : Vector3d(0.0, 0.0, 1.0);
      const VehiclePose& pose = subject.pose;
      const Vector3d aim = pose.chassis.position + pose.chassis.orientation * aim_V;
      const Vector3f at = seen(camera, aim.cast<float>());
      EXPECT_LT(at.head<2>().cwiseAbs().maxCoeff(), 0.5f) << name;
      EXPECT_LT(std::abs(at.z()), 1.0f) << name;
    }
  }
}

TEST(Camera, SideShowsTheWholeTrackFrontToTheRight) {
  const Vehicle vehicle = read_vehicle(GROUSER_SOURCE_DIR "/test_data/vehicles/reference.json");
  const VehicleModel model(vehicle);
  const Subject subject = model.subject(design_pose(vehicle), 0.0);
  const Camera camera = make_camera("side", subject, 16.0f / 9.0f);
  const Vector3f front = seen(camera, {subject.front, -1.4f, 0.7f}), rear = seen(camera, {subject.rear, -1.4f, 0.7f});
  const float nose = seen(camera, {subject.nose, 0.0f, 2.0f}).x(), tail = seen(camera, {subject.tail, 0.0f, 1.5f}).x();
  EXPECT_GT(front.x() - rear.x(), 1.2f);  // of 2
  EXPECT_GT(nose, front.x() + 0.2f);      // a gun, which is in the picture too
  EXPECT_LT(nose, 0.97f);
  EXPECT_LE(tail, rear.x());
  EXPECT_GT(tail, -0.97f);
}

TEST(Camera, ChaseShowsATurnAsATurn) {
  const VehicleModel model(read_vehicle(GROUSER_SOURCE_DIR "/test_data/vehicles/reference.json"));
  const auto eye = [&](const char* name, double heading) {
    return make_camera(name, model.subject(turned(heading), 0.0), 1.5f).eye;
  };
  EXPECT_TRUE(eye("chase", 0.0).isApprox(eye("chase", 1.0)));
  EXPECT_FALSE(eye("side", 0.0).isApprox(eye("side", 1.0)));
}

TEST(Camera, ChaseKeepsTheGunInThePictureAtEveryHeading) {
  const Vehicle vehicle = read_vehicle(GROUSER_SOURCE_DIR "/test_data/vehicles/reference.json");
  ASSERT_FALSE(vehicle.visual_tubes.empty());
  const VehicleModel model(vehicle);
  for (double heading = 0.0; heading < 6.3; heading += 0.1) {
    const Subject subject = model.subject(turned(heading), 0.0);
    const Camera camera = make_camera("chase", subject, 16.0f / 9.0f);
    for (const VisualTube& tube : vehicle.visual_tubes) {
      const Vector3d end = subject.pose.chassis.position + subject.pose.chassis.orientation * tube.to;
      EXPECT_LT(seen(camera, end.cast<float>()).head<2>().cwiseAbs().maxCoeff(), 0.96f) << heading;
    }
  }
}

TEST(Camera, AFilesCameraStandsWhereItsMountSays) {
  Subject subject;
  subject.pose = turned(0.5);
  subject.pose.chassis.position.z() = 0.2;
  subject.start_heading = 0.1;
  subject.ground = 0.05f;
  CameraView view{"own", CameraMount::world, {1, 2, 3}, {0, 0, 1}, 0.6, {}};
  const auto eye = [&](CameraMount mount) {
    view.mount = mount;
    return make_camera(view, subject).eye;
  };
  EXPECT_TRUE(eye(CameraMount::world).isApprox(Vector3f(1, 2, 3)));
  const auto beside = [](double heading, float z) -> Vector3f {
    const auto c = static_cast<float>(std::cos(heading)), s = static_cast<float>(std::sin(heading));
    return {30.0f + c - 2.0f * s, -4.0f + s + 2.0f * c, z};
  };
  EXPECT_TRUE(eye(CameraMount::follow).isApprox(beside(0.1, 3.05f), 1e-5f));
  EXPECT_TRUE(eye(CameraMount::heading).isApprox(beside(0.5, 3.05f), 1e-5f));
  EXPECT_TRUE(eye(CameraMount::chassis).isApprox(beside(0.5, 3.2f), 1e-5f));
  view.eye = {0, 0, 9};
  view.target = {0, 0, 0};  // straight down
  EXPECT_TRUE(make_camera(view, subject).view_projection(1.5f).allFinite());
}

TEST(Camera, AnUnknownNameIsAnErrorThatNamesTheKnownOnes) {
  try {
    (void)make_camera("drone", {}, 1.5f);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("sprocket"), std::string::npos);
  }
}

}  // namespace
}  // namespace grouser
