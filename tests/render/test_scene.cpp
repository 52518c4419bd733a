#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "model/errors.h"
#include "render/frame_maker.h"
#include "render/scene_renderer.h"

namespace grouser {
namespace {

constexpr int k_size = 400;  ///< pixels
constexpr std::size_t k_pixels = k_size * k_size;
constexpr float k_view = 4.0f;  ///< m across the picture
const Material k_red{{1.0f, 0.0f, 0.0f}, 0.0f}, k_blue{{0.0f, 0.0f, 1.0f}, 0.0f};

/// Meshes in a view along +y: World's x to the right, z up, 1 m = 100 pixels.
Scene view_of(std::vector<Mesh> meshes) {
  Scene scene;
  std::vector<SceneMesh> all;
  for (Mesh& mesh : meshes) all.push_back({std::move(mesh), {}});
  scene.instances.assign(all.size(), {Instance{}});
  scene.meshes = std::make_shared<const std::vector<SceneMesh>>(std::move(all));
  scene.camera.eye = {0, -10, 0};
  scene.camera.target = {0, 0, 0};
  scene.camera.parallel_height = k_view;
  scene.ground = false;
  return scene;
}

Image draw_scene(const Scene& scene) {
  const GlContext context(k_pixels);
  SceneRenderer renderer(context, k_size, k_size);
  renderer.draw(scene);
  return renderer.read();
}

struct Pixel {
  int blue, green, red;
};
Pixel pixel(const Image& image, int x, int y) {
  const auto i = static_cast<std::size_t>(3 * (image.width * y + x));
  return {image.bgr[i], image.bgr[i + 1], image.bgr[i + 2]};
}

/// Pixels that are more red than blue: of the red bodies before the blue sky.
int count_red(const Image& image) {
  int count = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const Pixel p = pixel(image, x, y);
      count += p.red > p.blue ? 1 : 0;
    }
  }
  return count;
}

TEST(Scene, ABoxCoversTheAreaOfItsFace) {
  Mesh box;
  box.add_box({0, 0, 0}, {0.5f, 0.5f, 0.75f}, 0.0f, k_red);
  EXPECT_EQ(count_red(draw_scene(view_of({box}))), 100 * 150);  // its edges lie between pixels
}

TEST(Scene, ABallCoversTheAreaOfItsDisc) {
  std::vector<Vector2f> profile;
  for (int i = 0; i <= 64; ++i) {
    const auto angle = static_cast<float>(k_pi * i / 64.0);
    profile.emplace_back(i % 64 == 0 ? 0.0f : std::sin(angle), -std::cos(angle));
  }
  Mesh ball;
  ball.add_lathe(profile, 128, {0, 0, 0}, k_red);
  const double area = k_pi * 100.0 * 100.0;
  // 128 chords lose 0.04 %; a rim of 628 pixels is counted by halves.
  EXPECT_NEAR(count_red(draw_scene(view_of({ball}))), area, 0.01 * area);
}

TEST(Scene, UpIsUpAndForwardOfTheRightSideIsRight) {
  Mesh box;
  box.add_box({1.0f, 0, 1.0f}, {0.4f, 0.4f, 0.4f}, 0.0f, k_red);
  const Image image = draw_scene(view_of({box}));
  EXPECT_GT(pixel(image, 300, 100).red, pixel(image, 300, 100).blue);
  EXPECT_LT(pixel(image, 300, 300).red, pixel(image, 300, 300).blue);
  EXPECT_LT(pixel(image, 100, 100).red, pixel(image, 100, 100).blue);
}

TEST(Scene, TheNearerBodyHidesTheFartherInAnyOrder) {
  Mesh near, far;
  near.add_box({0, -1.5f, 0}, {0.3f, 0.3f, 0.3f}, 0.0f, k_red);
  far.add_box({0, 1.5f, 0}, {0.6f, 0.3f, 0.6f}, 0.0f, k_blue);
  for (const auto& order : {std::vector{near, far}, std::vector{far, near}}) {
    const Image image = draw_scene(view_of(order));
    EXPECT_GT(pixel(image, 200, 200).red, 2 * pixel(image, 200, 200).blue);
    EXPECT_GT(pixel(image, 245, 200).blue, 2 * pixel(image, 245, 200).red);
  }
}

TEST(Scene, AnAnnotationIsSeenThroughBodiesFaintly) {
  Mesh body, mark;
  body.add_box({0, -1.5f, 0}, {0.3f, 0.3f, 0.3f}, 0.0f, k_blue);
  mark.add_box({0, 1.5f, 0}, {0.6f, 0.3f, 0.6f}, 0.0f, k_red);
  const auto drawn = [&](bool annotation) {
    Scene scene = view_of({body, mark});
    auto meshes = std::make_shared<std::vector<SceneMesh>>(*scene.meshes);
    (*meshes)[1].annotation = annotation;
    scene.meshes = meshes;
    return draw_scene(scene);
  };
  const Pixel hidden = pixel(drawn(false), 200, 200), through = pixel(drawn(true), 200, 200);
  const Pixel open = pixel(drawn(true), 245, 200);
  EXPECT_GT(through.red, hidden.red + 40);
  EXPECT_GT(through.blue, open.blue + 40);
}

TEST(Scene, ASeeThroughBodyShowsWhatItHides) {
  Mesh front, behind;
  front.add_box({0, -1.5f, 0}, {0.3f, 0.3f, 0.3f}, 0.0f, k_blue);
  behind.add_box({0, 1.5f, 0}, {0.6f, 0.3f, 0.6f}, 0.0f, k_red);
  Scene scene = view_of({front, behind});
  scene.see_through = 0;
  const Pixel p = pixel(draw_scene(scene), 200, 200);
  EXPECT_GT(p.red, p.blue);
  EXPECT_GT(p.blue, 20);
}

TEST(Scene, ABodyShadesTheGroundBehindItAsSeenFromTheSun) {
  Mesh box;
  box.add_box({0, 0, 1.0f}, {0.3f, 0.3f, 0.05f}, 0.0f, k_red);
  Scene scene = view_of({box});
  scene.ground = true;
  scene.camera.eye = {0.0f, -0.01f, 10.0f};  // from above: x to the right, y up
  scene.sun = Vector3f(1.0f, 0.0f, 1.0f).normalized();
  const Image image = draw_scene(scene);
  const auto brightness = [&](int x, int y) {
    const Pixel p = pixel(image, x, y);
    return p.red + p.green + p.blue;
  };
  EXPECT_LT(brightness(100, 200), 0.7 * brightness(310, 260));  // 1 m to -x of the box that hangs 1 m high
  EXPECT_GT(brightness(300, 190), 0.8 * brightness(310, 260));
}

TEST(Scene, BodiesWithoutCoverHaveNoAcne) {
  Mesh plate;
  plate.add_box({0, 0, 0.5f}, {1.5f, 1.5f, 0.05f}, 0.0f, k_red);
  Scene scene = view_of({plate});
  scene.camera.eye = {0.0f, -0.01f, 10.0f};
  const Image image = draw_scene(scene);
  int low = 255, high = 0;
  for (int y = 100; y < 300; ++y) {
    for (int x = 100; x < 300; ++x) {
      low = std::min(low, pixel(image, x, y).red);
      high = std::max(high, pixel(image, x, y).red);
    }
  }
  EXPECT_LE(high - low, 3);  // of 255; the sky's mirror image varies a little
}

TEST(Scene, TheSameSceneGivesTheSameBytes) {
  const Vehicle vehicle = read_vehicle(GROUSER_SOURCE_DIR "/test_data/vehicles/reference.json");
  RenderOptions options;
  options.width = 320;
  options.height = 180;
  const VehiclePose pose = design_pose(vehicle, 0.5);
  const Image a = render_pose(vehicle, pose, options), b = render_pose(vehicle, pose, options);
  EXPECT_EQ(a.bgr, b.bgr);
  EXPECT_NE(a.bgr, render_pose(vehicle, design_pose(vehicle, 0.55), options).bgr);  // the links have moved on
}

TEST(Scene, OddSizesAreRefused) {
  const GlContext context(k_pixels);
  EXPECT_THROW(SceneRenderer(context, 321, 180), InputError);
  EXPECT_THROW(SceneRenderer(context, 320, 181), InputError);
  EXPECT_THROW(SceneRenderer(context, 0, 180), InputError);
}

TEST(GlContext, AGlErrorBecomesAnException) {
  const GlContext context(k_pixels);
  context.check("nothing");
  context.gl().Enable(0xFFFFFFFFU);
  EXPECT_THROW(context.check("a wrong call"), GlError);
  context.check("nothing again");
}

TEST(GlContext, APictureThatMemoryCannotHoldIsRefusedBeforeMesaTakesIt) {
  EXPECT_THROW(GlContext{std::size_t{1} << 50}, std::bad_alloc);
}

TEST(GlContext, TwoContextsDoNotDisturbEachOther) {
  Mesh box;
  box.add_box({0, 0, 0}, {0.5f, 0.5f, 0.75f}, 0.0f, k_red);
  const Scene scene = view_of({box});
  const GlContext context(k_pixels);
  SceneRenderer renderer(context, k_size, k_size);
  renderer.draw(scene);
  { (void)draw_scene(scene); }  // made and gone in between
  renderer.draw(scene);
  EXPECT_EQ(count_red(renderer.read()), 100 * 150);
}

}  // namespace
}  // namespace grouser
