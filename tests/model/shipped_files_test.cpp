#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "model/check.h"
#include "model/provenance.h"
#include "model/vehicle.h"
#include "tests/support/test_data.h"

namespace grouser {
namespace {

namespace fs = std::filesystem;

TEST(ShippedFiles, AreAllRight) {
  int files = 0;
  for (const char* const folder : {"vehicles", "scenarios", "bushings", "rig/reference", "rig/protocol"}) {
    for (const auto& entry : fs::directory_iterator(test_data(folder))) {
      if (entry.path().extension() != ".json" || entry.path().stem() == "truth") continue;
      EXPECT_THAT(check_file(entry.path()), testing::StartsWith("ok: ")) << entry.path();
      ++files;
    }
  }
  EXPECT_GE(files, 5);  // a vehicle, two runs, a bushing, a campaign
}

TEST(FormatsPage, ShowsOnlyExamplesThatAreRead) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "docs");
  fs::create_directory_symlink(test_data(""), folder.path() / "test_data");
  folder.write("docs/ramp.csv", "displacement_mm,force_kN\n0,0\n1,1\n");
  folder.write("docs/loop.csv", "time_s,lvdt_a_V,load_V\n0,0,0\n1,1,1\n");
  folder.write("docs/torsion.csv", "time_s,angle_deg,torque_N_m\n0,0,0\n1,1,1\n");
  const std::string page = read_whole(fs::path(GROUSER_SOURCE_DIR) / "docs/files.md");
  int examples = 0;
  for (std::size_t at = page.find("```json\n"); at != std::string::npos; at = page.find("```json\n", at + 1)) {
    const std::size_t begin = at + 8, end = page.find("```", begin);
    const std::string example = page.substr(begin, end - begin);
    EXPECT_THAT(check_file(folder.write("docs/example.json", example)), testing::StartsWith("ok: ")) << example;
    ++examples;
  }
  EXPECT_EQ(examples, 4);
}

TEST(ReferenceVehicle, KeepsItsPictureClearOfTheTracks) {
  const Vehicle vehicle = read_vehicle(test_data("vehicles/reference.json"));
  const RunningGear& gear = vehicle.side(Side::left);
  const double inner_edge = gear.track_center_y - 0.5 * gear.track.shoe_width;
  const DiscPair& roller = gear.support_rollers.front();
  const double top = roller.center.z() + roller.radius + gear.track.wheel_path_height + gear.track.ground_depth;
  for (const VisualPart& part : vehicle.visual_parts) {
    if (part.half_width < inner_edge) continue;
    for (const Vector3d& point : part.outline) EXPECT_GT(point.z(), top) << part.name;
  }
}

}  // namespace
}  // namespace grouser
