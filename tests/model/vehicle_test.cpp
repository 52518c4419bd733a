#include "model/vehicle.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "model/errors.h"
#include "model/provenance.h"
#include "tests/support/test_data.h"

namespace grouser {
namespace {

TEST(ReferenceVehicle, WeighsWhatItShould) {
  const Vehicle vehicle = read_vehicle(test_data("vehicles/reference.json"));
  double mass = vehicle.chassis.mass;
  int bodies = 1, joints = 0;
  for (const RunningGear& gear : vehicle.sides) {
    mass += gear.sprocket.body.mass + gear.idler.arm.mass + gear.idler.wheel.body.mass;
    for (const DiscPair& roller : gear.support_rollers) mass += roller.body.mass;
    for (const Station& station : gear.stations) mass += station.arm.mass + station.wheel.body.mass;
    mass += gear.track.num_links * gear.track.link.mass;
    const int jointed = 3 + static_cast<int>(gear.support_rollers.size() + 2 * gear.stations.size());
    joints += jointed;
    bodies += jointed + gear.track.num_links;
  }
  EXPECT_DOUBLE_EQ(mass, 51100.0);
  EXPECT_EQ(bodies, 189);
  EXPECT_EQ(joints, 36);
  // 20 % of the weight in each track, stated to a tenth of a kilonewton.
  EXPECT_NEAR(vehicle.side(Side::left).track.pre_tension, 0.2 * 51100.0 * 9.81, 50.0);
}

TEST(ReferenceVehicle, PutsEveryWheelAtTheEndOfItsArm) {
  const Vehicle vehicle = read_vehicle(test_data("vehicles/reference.json"));
  for (const Station& station : vehicle.side(Side::right).stations) {
    const Vector3d arm = station.wheel.center - station.pivot;
    EXPECT_NEAR(arm.norm(), 0.45, 1e-6);
    EXPECT_NEAR(std::atan2(-arm.z(), -arm.x()), 25.0 * k_pi / 180.0, 1e-5);
    EXPECT_NEAR((station.arm.center_of_mass - 0.5 * arm).norm(), 0.0, 1e-6);
  }
}

TEST(MirroredSide, ReversesEveryLateralPosition) {
  const Vehicle vehicle = read_vehicle(test_data("vehicles/reference.json"));
  const RunningGear &left = vehicle.side(Side::left), &right = vehicle.side(Side::right);
  EXPECT_EQ(right.track_center_y, -left.track_center_y);
  EXPECT_EQ(right.sprocket.center.y(), -left.sprocket.center.y());
  EXPECT_EQ(right.stations[3].wheel.center.y(), -left.stations[3].wheel.center.y());
  EXPECT_EQ(right.idler.pivot.y(), -left.idler.pivot.y());
  EXPECT_EQ(right.stations[3].pivot.x(), left.stations[3].pivot.x());
  EXPECT_EQ(right.track.ground_points[0], left.track.ground_points[0]);  // in the link's own frame
}

TEST(MirroredSide, MayDifferInWhatItStates) {
  auto json = nlohmann::ordered_json::parse(read_whole(test_data("vehicles/reference.json")));
  json["right"]["track"] = {{"pre_tension_kN", 60.0}};
  const TemporaryFolder folder;
  const Vehicle vehicle = read_vehicle(folder.write("v.json", json.dump()));
  EXPECT_EQ(vehicle.side(Side::right).track.pre_tension, 60e3);
  EXPECT_EQ(vehicle.side(Side::left).track.pre_tension, 100.3e3);
}

TEST(DoublePin, NeedsALengthOfItsConnector) {
  auto json = nlohmann::ordered_json::parse(read_whole(test_data("vehicles/reference.json")));
  json["left"]["track"]["connection"] = "double_pin";
  const TemporaryFolder folder;
  EXPECT_THROW(static_cast<void>(read_vehicle(folder.write("v.json", json.dump()))), InputError);
  json["left"]["track"]["connector_length_mm"] = 63;
  EXPECT_EQ(read_vehicle(folder.write("v.json", json.dump())).side(Side::right).track.connector.length, 0.063);
}

TEST(DoublePin, MayStateItsConnectorsAsBodies) {
  const Track track = read_vehicle(test_data("vehicles/reference_double_pin.json")).side(Side::left).track;
  EXPECT_TRUE(track.connector.condensed);
  EXPECT_EQ(track.connector.mass, 4.0);
  // Half a connector at either end of a link of 194 mm: 2 (2 kg) (0.097 m)^2.
  EXPECT_NEAR(lumped_inertia(track.connector, track.pitch).y(), 0.006 + 4.0 * 0.097 * 0.097, 1e-12);
}

TEST(TrackJoints, HaveNoPlayAndNoStopUnlessStated) {
  auto json = nlohmann::ordered_json::parse(read_whole(test_data("vehicles/reference.json")));
  const TemporaryFolder folder;
  const Track plain = read_vehicle(folder.write("v.json", json.dump())).side(Side::left).track;
  EXPECT_EQ(plain.clearance, 0.0);
  EXPECT_FALSE(plain.stop_angle);
  json["left"]["track"]["clearance_mm"] = 0.5;
  json["left"]["track"]["stop_angle_deg"] = 10;
  json["left"]["track"]["stop_stiffness_kN_m_per_rad"] = 300;
  const Track worn = read_vehicle(folder.write("v.json", json.dump())).side(Side::right).track;
  EXPECT_EQ(worn.clearance, 0.5e-3);
  EXPECT_NEAR(worn.stop_angle.value(), 10.0 * k_pi / 180.0, 1e-15);
  EXPECT_EQ(worn.stop_stiffness, 3e5);
}

}  // namespace
}  // namespace grouser
