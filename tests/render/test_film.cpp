#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "model/errors.h"
#include "render/pose.h"
#include "render/render.h"
#include "tests/support/mock_run.h"
#include "tests/support/temporary_folder.h"

namespace grouser {
namespace {

namespace fs = std::filesystem;

class Film : public testing::Test {
 protected:
  Film() {
    mock::RunOptions options;
    options.duration = 0.5;
    options.rate = 100.0;
    mock::write_run(folder_.path() / "run", options);
    options_.width = 160;
    options_.height = 90;
    options_.fps = 10.0;
  }
  [[nodiscard]] RunFolder run() const { return open_run(folder_.path() / "run"); }

  test::TemporaryFolder folder_;
  RenderOptions options_;
};

TEST_F(Film, HasAFrameForEveryTick) {
  const fs::path file = folder_.path() / "film.mp4";
  double told = 0.0;
  const int frames = render_film(run(), file, options_, [&told](const ProgressReport& report) {
    EXPECT_GE(report.fraction, told);
    told = report.fraction;
    return true;
  });
  EXPECT_EQ(frames, 5);  // 0.5 s at 10 a second; render_film() itself reads the file back and counts
  EXPECT_EQ(told, 1.0);
  EXPECT_GT(fs::file_size(file), 1000U);
}

TEST_F(Film, AnInterruptLeavesNothing) {
  int calls = 0;
  const fs::path target = folder_.path() / "films";
  fs::create_directories(target);
  const int frames =
      render_film(run(), target / "film.mp4", options_, [&calls](const ProgressReport&) { return ++calls < 3; });
  EXPECT_EQ(frames, 0);
  EXPECT_TRUE(fs::is_empty(target));
}

TEST_F(Film, CannotBeWrittenWhereThereIsNoFolder) {
  EXPECT_THROW((void)render_film(run(), folder_.path() / "missing" / "film.mp4", options_), FileError);
}

TEST_F(Film, FramesArePicturesThatDiffer) {
  const fs::path target = folder_.path() / "frames";
  fs::create_directories(target);
  EXPECT_EQ(render_frames(run(), target, options_), 5);
  const Image first = read_png(target / "frame_000000.png"), last = read_png(target / "frame_000004.png");
  EXPECT_EQ(first.width, 160);
  EXPECT_EQ(first.height, 90);
  EXPECT_NE(first.bgr, last.bgr);
}

TEST_F(Film, AStillIsTheFrameOfItsTime) {
  const Image a = render_still(run(), 0.2, options_), b = render_still(run(), 0.2, options_);
  EXPECT_EQ(a.bgr, b.bgr);
  EXPECT_EQ(a.width, 160);
  EXPECT_NE(a.bgr, render_still(run(), 0.3, options_).bgr);
}

TEST_F(Film, OddSizesAreRefused) {
  options_.width = 161;
  EXPECT_THROW((void)render_film(run(), folder_.path() / "film.mp4", options_), InputError);
}

TEST_F(Film, PosesBetweenSamplesLieBetween) {
  const RunFolder opened = run();
  PoseReader reader(opened);
  const VehiclePose a = reader.at(0.20), b = reader.at(0.21), middle = reader.at(0.205);
  const auto x = [](const VehiclePose& pose) { return pose.chassis.position.x(); };
  EXPECT_NEAR(x(middle), 0.5 * (x(a) + x(b)), 1e-12);
  EXPECT_NEAR(middle.links[1][7].orientation.norm(), 1.0, 1e-12);
  EXPECT_NEAR(middle.angles[0].sprocket, 0.5 * (a.angles[0].sprocket + b.angles[0].sprocket), 1e-12);
  EXPECT_EQ(x(reader.at(99.0)), x(reader.at(reader.last_time())));
  EXPECT_EQ(x(reader.at(0.205)), x(middle));  // going back in time reads the block again
}

TEST(Image, SurvivesPng) {
  Image image{3, 2, {}};
  for (int i = 0; i < 18; ++i) image.bgr.push_back(static_cast<std::uint8_t>(14 * i));
  const test::TemporaryFolder folder;
  write_png(image, folder.path() / "image.png");
  EXPECT_EQ(read_png(folder.path() / "image.png").bgr, image.bgr);
  std::ofstream(folder.path() / "other.png") << "no picture";
  EXPECT_THROW((void)read_png(folder.path() / "other.png"), FileError);
  EXPECT_THROW((void)read_png(folder.path() / "missing.png"), FileError);
}

}  // namespace
}  // namespace grouser
