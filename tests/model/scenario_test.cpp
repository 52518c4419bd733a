#include "model/scenario.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "model/errors.h"
#include "tests/support/test_data.h"

namespace grouser {
namespace {

/// Run A with a bushing that stands beside the broken files, whatever identification has written.
ScenarioOverrides with(std::map<std::string, std::string> set) {
  return {"", test_data("broken/good_bushing.json").string(), std::move(set)};
}
Scenario run_a(std::map<std::string, std::string> set = {}) {
  return read_scenario(test_data("scenarios/run_a.json"), with(std::move(set)));
}

std::string message_of(std::map<std::string, std::string> set) {
  try {
    static_cast<void>(run_a(std::move(set)));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(RunA, IsTheDriveOfThePaper) {
  const Scenario scenario = run_a();
  EXPECT_EQ(scenario.drive[0].time, (std::vector<double>{0.0, 10.0, 13.0, 17.0}));
  EXPECT_EQ(scenario.drive[0].speed, (std::vector<double>{0.0, 45.0, 45.0, 0.0}));
  EXPECT_EQ(scenario.duration, 17.0);
  EXPECT_EQ(scenario.terrain.friction, 0.7);
  EXPECT_NEAR(scenario.integrator.beta, 28.0 / 27.0, 1e-15);
  EXPECT_EQ(scenario.output.probes.size(), 2u);
  EXPECT_EQ(scenario.provenance.inputs.size(), 3u);
}

TEST(RunB, TurnsLeft) {
  const Scenario scenario = read_scenario(test_data("scenarios/run_b.json"), with({}));
  EXPECT_EQ(scenario.drive[static_cast<std::size_t>(index_of(Side::right))].speed.back(), 9.0);
  EXPECT_EQ(scenario.drive[static_cast<std::size_t>(index_of(Side::left))].speed.back(), -9.0);
}

TEST(Override, ReplacesAQuantityInAnyUnit) {
  const Scenario scenario = run_a({{"integrator.max_step_s", "0.0001"},
                                   {"/duration_min", "0.5"},
                                   {"integrator.fixed_step_us", "50"},
                                   {"drive.left.speed_rad_per_s.1", "40"},
                                   {"vehicle./left/track/pre_tension_N", "60000"},
                                   {"vehicle.right.track.pitch_cm", "19.5"},
                                   {"bushing.axes.x.viscous_N_s_per_m", "123"}});
  EXPECT_DOUBLE_EQ(scenario.integrator.max_step, 1e-4);
  EXPECT_DOUBLE_EQ(scenario.duration, 30.0);
  EXPECT_DOUBLE_EQ(scenario.integrator.fixed_step, 5e-5);
  EXPECT_EQ(scenario.drive[0].speed[1], 40.0);
  EXPECT_EQ(scenario.vehicle.side(Side::left).track.pre_tension, 60e3);
  EXPECT_EQ(scenario.vehicle.side(Side::right).track.pitch, 0.195);
  EXPECT_EQ(scenario.bushing.axis(Axis::x).viscous, 123.0);
  EXPECT_EQ(scenario.provenance.options.at("/duration_min"), "0.5");
}

TEST(Override, OfOneSideIsFollowedByTheSideThatMirrorsItUnlessThatIsSetToo) {
  const Scenario both = run_a({{"vehicle.left.track.pre_tension_N", "60000"}});
  EXPECT_EQ(both.vehicle.side(Side::left).track.pre_tension, 60e3);
  EXPECT_EQ(both.vehicle.side(Side::right).track.pre_tension, 60e3);
  const Scenario apart =
      run_a({{"vehicle.left.track.pre_tension_N", "60000"}, {"vehicle.right.track.pre_tension_kN", "70"}});
  EXPECT_EQ(apart.vehicle.side(Side::left).track.pre_tension, 60e3);
  EXPECT_EQ(apart.vehicle.side(Side::right).track.pre_tension, 70e3);
}

TEST(Override, OfSomethingUnknownSaysWhatWasMeant) {
  EXPECT_THAT(message_of({{"integrater.max_step_ms", "0.1"}}), testing::HasSubstr("did you mean integrator?"));
  EXPECT_THAT(message_of({{"integrator.max_stp_ms", "0.1"}}), testing::HasSubstr("/integrator/max_stp_ms"));
  EXPECT_THAT(message_of({{"vehicle.left.stations.9.bump_angle_deg", "20"}}), testing::HasSubstr("an index below 6"));
  EXPECT_THAT(message_of({{"duration_s.x", "1"}}), testing::HasSubstr("/duration_s"));
  EXPECT_THAT(message_of({{"duration_kg", "1"}}), testing::HasSubstr("expected a unit of time"));
  EXPECT_THAT(message_of({{"duration_s", "-1"}}), testing::HasSubstr("expected a time > 0, found -1"));
}

TEST(Scenario, CollectsTheFindingsOfAllItsFiles) {
  const std::string message =
      message_of({{"duration_s", "0"}, {"vehicle.chassis.mass_kg", "0"}, {"bushing.axes.x.viscous_N_s_per_m", "-1"}});
  EXPECT_THAT(message, testing::AllOf(testing::HasSubstr("run_a.json#/duration_s"),
                                      testing::HasSubstr("reference.json#/chassis/mass_kg"),
                                      testing::HasSubstr("good_bushing.json#/axes/x/viscous_N_s_per_m")));
}

TEST(Scenario, StartsNoRunWithAFileThatTheUserNamedInVain) {
  EXPECT_THROW(static_cast<void>(read_scenario(test_data("scenarios/run_a.json"), {"absent.json", "", {}})), FileError);
}

TEST(BushingScale, StandsForAllAxesOrForSome) {
  const double x = run_a().bushing.axis(Axis::x).spring.force.back(),
               ry = run_a().bushing.axis(Axis::ry).spring.force.back();
  const Scenario all = run_a({{"bushing_scale", "0.25"}});
  EXPECT_EQ(all.bushing.axis(Axis::x).spring.force.back(), 0.25 * x);
  EXPECT_EQ(all.bushing.axis(Axis::ry).spring.force.back(), 0.25 * ry);
  EXPECT_EQ(all.provenance.options.at("bushing_scale"), "0.25");
  const Scenario hinge = run_a({{"bushing_scale.ry", "4"}});
  EXPECT_EQ(hinge.bushing.axis(Axis::x).spring.force.back(), x);
  EXPECT_EQ(hinge.bushing.axis(Axis::ry).spring.force.back(), 4.0 * ry);
}

TEST(BushingScale, ReachesTheBushingOfOneTrackToo) {
  const std::string own = test_data("broken/good_bushing.json").string();
  const Scenario scenario = run_a({{"vehicle.right.track.bushing", own}, {"bushing_scale", "2"}});
  EXPECT_EQ(scenario.side_bushing[1]->axis(Axis::z).spring.slope, scenario.bushing.axis(Axis::z).spring.slope);
}

TEST(RunInputs, ReadAgainGiveTheSameScenario) {
  const TemporaryFolder folder;
  const Scenario scenario =
      run_a({{"vehicle.left.track.pre_tension_kN", "60"}, {"duration_s", "3"}, {"bushing_scale", "2"}});
  write_inputs(scenario, folder.path());
  const Scenario again = read_scenario(folder.path() / "inputs/scenario.json");
  EXPECT_EQ(again.duration, 3.0);
  EXPECT_EQ(again.vehicle.side(Side::left).track.pre_tension, 60e3);
  EXPECT_EQ(again.documents.vehicle, scenario.documents.vehicle);
  EXPECT_EQ(again.documents.bushing, scenario.documents.bushing);
  // Once, not once for every reading.
  EXPECT_EQ(again.bushing.axis(Axis::x).spring.force, scenario.bushing.axis(Axis::x).spring.force);
}

TEST(RunInputs, KeepABushingOfOneTrack) {
  const TemporaryFolder folder;
  const std::string own = test_data("broken/good_bushing.json").string();
  const Scenario scenario = run_a({{"vehicle.right.track.bushing", own}});
  EXPECT_TRUE(scenario.side_bushing[1]);
  EXPECT_EQ(&scenario.bushing_of(Side::left), &scenario.bushing);
  write_inputs(scenario, folder.path());
  EXPECT_EQ(read_scenario(folder.path() / "inputs/scenario.json").vehicle.side(Side::right).track.bushing,
            "bushing_right.json");
}

/// What is held against the inputs of a run before it begins.
TEST(RunInputs, AreAllNamedBeforehand) {
  const TemporaryFolder folder;
  const std::string own = test_data("broken/good_bushing.json").string();
  write_inputs(run_a({{"vehicle.left.track.bushing", own}, {"vehicle.right.track.bushing", own}}), folder.path());
  write_inputs(read_scenario(test_data("scenarios/run_a_rms_course.json")), folder.path());
  std::vector<std::string> written, named = input_names();
  for (const auto& entry : std::filesystem::directory_iterator(folder.path() / "inputs"))
    written.push_back(entry.path().filename().string());
  std::ranges::sort(written);
  std::ranges::sort(named);
  EXPECT_EQ(written, named);
}

}  // namespace
}  // namespace grouser
