#include "render/visible.h"

#include <gtest/gtest.h>

#include "render/parts.h"

namespace grouser {
namespace {

/// One unit box at each place, seen along +y from 10 m in a picture of 4 m x 4 m.
Scene boxes_at(const std::vector<Vector3f>& places) {
  SceneMesh box;
  box.shape.add_box({0, 0, 0}, {0.5f, 0.5f, 0.5f}, 0.0f, {});
  Scene scene;
  scene.instances.resize(1);
  for (const Vector3f& place : places) {
    Instance instance;
    instance.X_WB.topRightCorner<3, 1>() = place;
    scene.instances[0].push_back(instance);
  }
  scene.meshes = std::make_shared<const std::vector<SceneMesh>>(1, box);
  scene.camera.eye = {0, -10, 0};
  scene.camera.target = {0, 0, 0};
  scene.camera.parallel_height = 4.0f;
  scene.sun = Vector3f(1.0f, 0.0f, 1.0f).normalized();
  return scene;
}

VisibleParts seen(const Scene& scene) { return visible_parts(scene, {ball_round((*scene.meshes)[0].shape)}, 400, 400); }

TEST(Visible, WhatLiesOutOfThePictureIsLeftOut) {
  const Scene scene = boxes_at({{0, 0, 0}, {2.4f, 0, 0}, {9.0f, 0, 0}, {0, 0, -9.0f}, {0, -30.0f, 0}});
  const VisibleParts visible = seen(scene);
  ASSERT_EQ(visible.solids.size(), 1U);
  EXPECT_EQ(visible.solids[0].instances.size(), 2U);  // in the middle, and across the edge
}

TEST(Visible, WhoseShadowFallsIntoThePictureIsKeptAsACaster) {
  const Scene scene = boxes_at({{6.0f, 0, 6.0f}, {-6.0f, 0, 6.0f}});  // the sun shines from +x and above
  const VisibleParts visible = seen(scene);
  EXPECT_TRUE(visible.solids.empty());
  ASSERT_EQ(visible.casters.size(), 1U);
  ASSERT_EQ(visible.casters[0].instances.size(), 1U);
  EXPECT_EQ(visible.casters[0].instances[0], &scene.instances[0][0]);
}

TEST(Visible, TheNearerComesFirst) {
  const Scene scene = boxes_at({{0, 5.0f, 0}, {0, -5.0f, 0}, {0, 0, 0}});
  const VisibleParts visible = seen(scene);
  ASSERT_EQ(visible.instances().size(), 6U);
  const std::vector<const Instance*> expected{&scene.instances[0][1], &scene.instances[0][2], &scene.instances[0][0]};
  EXPECT_EQ(visible.solids[0].instances, expected);
}

TEST(Visible, DetailFollowsTheSizeOnThePicture) {
  EXPECT_EQ(Detail::level_for(100.0f), Detail::coarse);
  EXPECT_EQ(Detail::level_for(200.0f), Detail::middle);
  EXPECT_EQ(Detail::level_for(900.0f), Detail::fine);
  const float radius = 0.3f;
  for (const float scale : {Detail::k_coarse, Detail::k_middle, Detail::k_fine}) {
    const int segments = Detail{scale}.segments(radius);
    EXPECT_LE(radius * scale * (1.0 - std::cos(k_pi / segments)), 0.45);  // pixels
  }
}

}  // namespace
}  // namespace grouser
