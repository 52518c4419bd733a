#include <gtest/gtest.h>

#include <cmath>

#include "model/errors.h"
#include "render/ground_section.h"
#include "render/load_overlay.h"
#include "render/render.h"
#include "tests/support/mock_run.h"
#include "tests/support/temporary_folder.h"

namespace grouser {
namespace {

constexpr double k_time = 0.31;  ///< s, between two samples

class Overlay : public testing::Test {
 protected:
  [[nodiscard]] static RunFolder written(const std::filesystem::path& folder) {
    mock::RunOptions options;
    options.duration = 0.5;
    options.rate = 100.0;
    options.contact_forces = true;
    mock::write_run(folder, options);
    return open_run(folder);
  }
  /// The scene of k_time with the overlays of these names.
  Scene scene_with(const std::vector<std::string>& names) {
    VehicleModel model(run_.vehicle);
    LoadOverlay overlay(run_, names, model);
    PoseReader poses(run_);
    const VehiclePose pose = poses.at(k_time);
    Scene scene = model.place(pose);
    overlay.add_to(scene, pose);
    legends_ = overlay.legends();
    return scene;
  }
  /// Instances of the n-th mesh that is an annotation.
  static const std::vector<Instance>& annotation(const Scene& scene, int n) {
    std::size_t mesh = 0;
    for (int seen = -1; seen < n; ++mesh) seen += (*scene.meshes)[mesh].annotation ? 1 : 0;
    return scene.instances[mesh - 1];
  }
  static float reach(const Instance& instance) { return instance.X_WB.block<3, 1>(0, 1).norm(); }

  test::TemporaryFolder folder_;
  RunFolder run_ = written(folder_.path() / "run");
  std::vector<Legend> legends_;
};

TEST_F(Overlay, AnArrowIsAsLongAsItsForceIsLarge) {
  const Scene scene = scene_with({"forces"});
  const std::vector<Instance>&shafts = annotation(scene, 0), &heads = annotation(scene, 1);
  ASSERT_EQ(shafts.size(), heads.size());
  ASSERT_FALSE(shafts.empty());
  double newton_per_metre = 0.0;
  ASSERT_EQ(std::sscanf(legends_.front().note.c_str(), "1 m of arrow: %lf kN", &newton_per_metre), 1);
  newton_per_metre *= 1e3;
  double drawn = 0.0, drawn_up = 0.0, present = 0.0, present_up = 0.0;
  for (std::size_t i = 0; i < shafts.size(); ++i) {
    const Vector3f along = shafts[i].X_WB.block<3, 1>(0, 1) + heads[i].X_WB.block<3, 1>(0, 1);
    drawn += newton_per_metre * static_cast<double>(along.norm());
    drawn_up += newton_per_metre * static_cast<double>(along.z());
  }
  for (const SideLoads& side : LoadReader(run_).at(k_time)) {
    for (const std::vector<Vector3d>& forces : side.force) {
      for (const Vector3d& force : forces) {
        if (force.norm() < 0.02 * newton_per_metre) continue;  // not drawn
        present += force.norm();
        present_up += force.z();
      }
    }
  }
  EXPECT_NEAR(drawn, present, 1e-5 * present);  // single precision
  EXPECT_NEAR(drawn_up, present_up, 1e-5 * present);
}

TEST_F(Overlay, ALinkHasTheColourOfTheTensionThatItCarries) {
  const Scene scene = scene_with({"tension"});
  const Scene plain = VehicleModel(run_.vehicle).place(PoseReader(run_).at(k_time));
  const ColorScale scale = legends_.front().bar->scale;
  const std::vector<double> tension = LoadReader(run_).at(k_time)[0].tension;
  for (const std::vector<Instance>& group : scene.instances) {
    if (group.size() != tension.size()) continue;
    for (std::size_t i = 0; i < group.size(); ++i) {
      const double mean = 0.5 * (tension[i] + tension[(i + tension.size() - 1) % tension.size()]);
      ASSERT_TRUE((group[i].tint.head<3>().isApprox(linear_rgb(scale.at(mean))))) << i;
    }
    break;  // the left side
  }
  EXPECT_EQ(scene.see_through, VehicleModel(run_.vehicle).chassis_mesh_index());
  EXPECT_FALSE(plain.see_through);
}

TEST_F(Overlay, GroundPressureHangsBelowTheLoadedLinks) {
  const Scene scene = scene_with({"pressure"});
  std::size_t loaded = 0;
  const double most = legends_.front().bar->scale.high;
  const Track& track = run_.vehicle.side(Side::left).track;
  double load = 0.0;
  for (const SideLoads& side : LoadReader(run_).at(k_time)) {
    for (const Vector3d& force : side.force[static_cast<std::size_t>(LoadPartner::ground)]) {
      if (force.z() < 0.01 * most * track.pitch * track.shoe_width) continue;
      ++loaded;
      load += force.z();
    }
  }
  const std::vector<Instance>& tiles = annotation(scene, 0);
  ASSERT_EQ(tiles.size(), loaded);
  double drawn = 0.0;  // depth of a bar at full scale: 0.45 m, and 12 mm that every bar has
  for (const Instance& tile : tiles) drawn += static_cast<double>(tile.X_WB.block<3, 1>(0, 2).norm()) - 0.012;
  EXPECT_NEAR(drawn / 0.45 * most * track.pitch * track.shoe_width, load, 1e-4 * load);
}

TEST_F(Overlay, PathsGrowWithTime) {
  VehicleModel model(run_.vehicle);
  LoadOverlay overlay(run_, {"paths"}, model);
  PoseReader poses(run_);
  const auto rods = [&](double time) {
    Scene scene = model.place(poses.at(time));
    overlay.add_to(scene, poses.at(time));
    return scene.trails.num_triangles();
  };
  EXPECT_LT(rods(0.2), rods(0.5));
}

TEST_F(Overlay, AnUnknownNameIsAnErrorThatNamesTheKnownOnes) {
  try {
    scene_with({"stress"});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("pressure"), std::string::npos);
  }
}

TEST_F(Overlay, IsSeenInThePicture) {
  RenderOptions options;
  options.width = 160;
  options.height = 90;
  const Image plain = render_still(run_, k_time, options);
  for (const std::string& name : overlay_names()) {
    options.overlays = {name};
    EXPECT_NE(render_still(run_, k_time, options).bgr, plain.bgr) << name;
  }
}

/// Relative luminance (ITU-R BT.709).
double luminance(const Rgb& color) {
  const Vector3f linear = linear_rgb(color);
  return static_cast<double>(0.2126f * linear[0] + 0.7152f * linear[1] + 0.0722f * linear[2]);
}

TEST(ColorScale, BrightnessAloneTellsTheOrder) {
  const ColorScale rising{viridis(), 0.0, 1.0}, falling{yellow_to_red(), 0.0, 1.0};
  for (int i = 0; i < 40; ++i) {
    const double a = i / 40.0, b = (i + 1) / 40.0;
    EXPECT_LT(luminance(rising.at(a)), luminance(rising.at(b)));
    EXPECT_GT(luminance(falling.at(a)), luminance(falling.at(b)));
  }
  EXPECT_EQ(rising.at(-1.0), rising.at(0.0));
  EXPECT_EQ(rising.at(2.0), rising.at(1.0));
}

TEST(GroundSection, FollowsTheGround) {
  Terrain terrain;
  terrain.slope = 0.1;
  terrain.obstacles.push_back({ObstacleKind::half_round, {}, 1.0, 0.2, 0.0, 0.0});
  const GroundSurface ground(terrain, 2.8);
  Camera camera;
  camera.eye = {0.0f, -20.0f, 1.0f};
  camera.target = {0.0f, -2.0f, 1.0f};
  camera.parallel_height = 4.0f;
  ASSERT_TRUE(camera.shows_section());
  float least = 1e9f, most = -1e9f;
  for (const Vertex& v : ground_section(ground, camera, 2.0f).vertices) {
    EXPECT_EQ(v.position.y(), -2.0f);
    least = std::min(least, v.position.x());
    most = std::max(most, v.position.x());
    const double top = ground.top(static_cast<double>(v.position.x()), -2.0);
    EXPECT_NEAR(v.position.z() + v.normal.z(), top, 1e-5) << v.position.x();  // depth below the surface
  }
  EXPECT_LE(least, -4.0f);  // as wide as the picture
  EXPECT_GE(most, 4.0f);
}

}  // namespace
}  // namespace grouser
