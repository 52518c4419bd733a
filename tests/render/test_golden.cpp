#include <gtest/gtest.h>

#include <cstdlib>

#include "render/frame_maker.h"

/// Pictures of the reference vehicle against pictures that were looked at. GROUSER_WRITE_GOLDEN=1 writes them anew.
namespace grouser {
namespace {

namespace fs = std::filesystem;

/// llvmpipe gives the same bytes for any number of threads and width of vectors; another version of Mesa may round
/// colours and place edges differently by a part of a pixel.
constexpr double k_mean_difference = 1.0;      ///< of 255, over all pixels
constexpr double k_share_of_outliers = 0.005;  ///< of pixels that differ by more than 24

class Golden : public testing::TestWithParam<const char*> {};

TEST_P(Golden, LooksAsItDid) {
  const Vehicle vehicle = read_vehicle(GROUSER_SOURCE_DIR "/test_data/vehicles/reference.json");
  RenderOptions options;
  options.width = 256;
  options.height = 144;
  options.camera = GetParam();
  const Image image = render_pose(vehicle, design_pose(vehicle, 0.35), options);
  const fs::path file = fs::path(GROUSER_SOURCE_DIR "/tests/render/golden") / (options.camera + ".png");
  if (std::getenv("GROUSER_WRITE_GOLDEN") != nullptr) write_png(image, file);
  const Image golden = read_png(file);
  ASSERT_EQ(image.bgr.size(), golden.bgr.size());
  double sum = 0.0;
  int outliers = 0;
  for (std::size_t i = 0; i < image.bgr.size(); ++i) {
    const int difference = std::abs(image.bgr[i] - golden.bgr[i]);
    sum += difference;
    outliers += difference > 24 ? 1 : 0;
  }
  EXPECT_LT(sum / static_cast<double>(image.bgr.size()), k_mean_difference);
  EXPECT_LT(outliers, k_share_of_outliers * static_cast<double>(image.bgr.size()));
}

INSTANTIATE_TEST_SUITE_P(Cameras, Golden,
                         testing::Values("chase", "side", "front", "sprocket", "road_wheel", "top", "orbit"),
                         [](const auto& camera) { return std::string(camera.param); });

}  // namespace
}  // namespace grouser
