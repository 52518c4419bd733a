#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <fstream>
#include <iterator>

#include "model/errors.h"
#include "model/folder_lock.h"
#include "model/provenance.h"
#include "render/film_encoder.h"
#include "render/film_reader.h"
#include "render/part_store.h"
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
    options_.width = 160;
    options_.height = 90;
    options_.fps = 10.0;
  }
  [[nodiscard]] RunFolder run() const { return open_run(folder_.path() / "run"); }
  [[nodiscard]] RunFolder written() const {
    mock::RunOptions options;
    options.duration = 0.5;
    options.rate = 100.0;
    mock::write_run(folder_.path() / "run", options);
    return run();
  }

  test::TemporaryFolder folder_;
  RunFolder opened_ = written();
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

/// Stops after so many frames.
Progress stop_after(int frames) {
  return [left = frames](const ProgressReport&) mutable { return left-- > 0; };
}

TEST_F(Film, StoppedGoesOnAndEndsAsIfItHadNotBeenStopped) {
  options_.fps = 140.0;  // a whole stretch of 60 frames, and part of another
  const fs::path whole = folder_.path() / "whole.mp4";
  const int count = render_film(run(), whole, options_);
  ASSERT_GT(count, 65);
  ASSERT_LT(count, 80);
  const fs::path target = folder_.path() / "films", kept = target / ".film.stretches";
  fs::create_directories(target);
  EXPECT_EQ(render_film(run(), target / "film.mp4", options_, stop_after(63)), 0);
  EXPECT_FALSE(fs::exists(target / "film.mp4"));
  EXPECT_TRUE(fs::exists(kept / "stretch_0000.mp4"));
  std::ofstream(kept / "stretch_0001.mp4") << "what a killed program leaves";
  double from = 1.0;
  EXPECT_EQ(render_film(run(), target / "film.mp4", options_,
                        [&from](const ProgressReport& report) {
                          from = std::min(from, report.fraction);
                          return true;
                        }),
            count);
  EXPECT_EQ(from, 60.0 / count);
  EXPECT_EQ(std::distance(fs::directory_iterator(target), {}), 1);  // the film, and nothing of how it was made
  EXPECT_EQ(read_whole(target / "film.mp4"), read_whole(whole));
}

/// libavformat does not know how long a frame is shown from 1000 fields a second on, where stretches must still follow
/// one another.
TEST_F(Film, OfStretchesIsAsLongAsItsFramesAtAnyRate) {
  const Image image{32, 18, std::vector<std::uint8_t>(std::size_t{3 * 32 * 18}, 90)};
  for (const double fps : {0.001, 23.976, 123.456789, 499.0, 500.0, 1001.0, 9999.5, 1e4}) {
    std::vector<fs::path> stretches;
    for (const int frames : {60, 60, 1}) {
      stretches.push_back(folder_.path() / fmt::format("stretch_{}.mp4", stretches.size()));
      FilmEncoder encoder(stretches.back(), image.width, image.height, fps);
      for (int i = 0; i < frames; ++i) encoder.add(image);
      encoder.finish();
    }
    join_films(stretches, folder_.path() / "film.mp4", "mark");
    FilmReader film(folder_.path() / "film.mp4");
    int count = 0;
    while (film.next()) ++count;
    EXPECT_EQ(count, 121) << fps;
    EXPECT_NEAR(film.duration() * fps, 121.0, 1e-3) << fps;
  }
}

/// Writes a stretch of so many grey frames.
void write_stretch(const fs::path& file, int frames) {
  const Image image{32, 18, std::vector<std::uint8_t>(std::size_t{3 * 32 * 18}, 90)};
  FilmEncoder encoder(file, image.width, image.height, 25.0);
  for (int i = 0; i < frames; ++i) encoder.add(image);
  encoder.finish();
}

/// A stretch that lies about its length would push those behind it out of order, which the result would be blamed for.
TEST_F(Film, AStretchThatTellsOfOtherFramesThanItHoldsIsDamaged) {
  const fs::path damaged = folder_.path() / "stretch_0.mp4", other = folder_.path() / "stretch_1.mp4";
  write_stretch(other, 60);
  for (const std::pair<const char*, int>& count : {std::pair{"stts", 28}, {"stts", 61}, {"stsz", 28}}) {
    write_stretch(damaged, 60);
    std::string bytes = read_whole(damaged);
    const std::size_t box = bytes.find(count.first);
    ASSERT_NE(box, std::string::npos);
    ASSERT_EQ(bytes[box + 15], count.first == std::string("stts") ? 60 : bytes[box + 15]);
    bytes[box + 15] = static_cast<char>(count.second);
    std::ofstream(damaged, std::ios::binary) << bytes;
    EXPECT_THROW(join_films({damaged, other}, folder_.path() / "film.mp4", "mark"), DamagedFilm)
        << count.first << count.second;
  }
}

TEST_F(Film, OfOtherFramesIsBegunAnew) {
  options_.fps = 140.0;
  const fs::path file = folder_.path() / "film.mp4";
  EXPECT_EQ(render_film(run(), file, options_, stop_after(63)), 0);
  options_.camera = "top";
  double from = 1.0;
  render_film(run(), file, options_, [&from](const ProgressReport& report) {
    from = std::min(from, report.fraction);
    return true;
  });
  EXPECT_EQ(from, 0.0);
}

/// Mean over all bytes of two pictures of one size.
double mean_difference(const Image& a, const Image& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.bgr.size(); ++i) sum += std::abs(static_cast<int>(a.bgr[i]) - b.bgr[i]);
  return sum / static_cast<double>(a.bgr.size());
}

Image upside_down(const Image& image) {
  Image turned{image.width, image.height, {}};
  for (int y = image.height - 1; y >= 0; --y) {
    const auto row = image.bgr.begin() + 3 * y * image.width;
    turned.bgr.insert(turned.bgr.end(), row, row + 3 * image.width);
  }
  return turned;
}

TEST_F(Film, ShowsItsFramesTheRightWayUpAndInTheirColours) {
  options_.width = 320;
  options_.height = 180;
  EXPECT_EQ(render_film(run(), folder_.path() / "film.mp4", options_), 5);
  EXPECT_EQ(render_frames({&opened_}, folder_.path() / "frames", options_), 5);
  FilmReader film(folder_.path() / "film.mp4");
  for (int i = 0; i < 5; ++i) {
    const Image drawn = read_png(folder_.path() / "frames" / ("frame_00000" + std::to_string(i) + ".png"));
    ASSERT_TRUE(film.next());
    const Image shown = film.frame();
    const double difference = mean_difference(shown, drawn);
    EXPECT_LT(difference, 2.0) << i;  // of 255, by what x264 leaves away
    EXPECT_GT(mean_difference(shown, upside_down(drawn)), 3.0 * difference) << i;
  }
  EXPECT_FALSE(film.next());
}

TEST_F(Film, FramesAreTakenUpWhereTheyWereLeftUnlessOthersAreAskedFor) {
  const fs::path target = folder_.path() / "frames";
  EXPECT_EQ(render_frames({&opened_}, target, options_, stop_after(2)), 2);
  const fs::path first = target / "frame_000000.png";
  const fs::file_time_type kept = fs::last_write_time(first);
  EXPECT_EQ(render_frames({&opened_}, target, options_), 5);
  EXPECT_EQ(fs::last_write_time(first), kept);
  const Image chase = read_png(first);
  const fs::path whole = folder_.path() / "whole";
  EXPECT_EQ(render_frames({&opened_}, whole, options_), 5);
  for (int frame = 0; frame < 5; ++frame) {
    const std::string name = "frame_00000" + std::to_string(frame) + ".png";
    EXPECT_EQ(read_png(target / name).bgr, read_png(whole / name).bgr) << frame;
  }
  options_.camera = "top";
  EXPECT_EQ(render_frames({&opened_}, target, options_), 5);
  EXPECT_NE(read_png(first).bgr, chase.bgr);
}

TEST_F(Film, FramesThatWentMissingAreMadeAgain) {
  const fs::path target = folder_.path() / "frames";
  ASSERT_EQ(render_frames({&opened_}, target, options_), 5);
  fs::remove(target / "frame_000000.png");
  EXPECT_EQ(render_frames({&opened_}, target, options_), 5);
  EXPECT_TRUE(fs::exists(target / "frame_000000.png"));
}

TEST_F(Film, APartThatAKilledProgramLeftInPlaceOfOneThatWentMissingDoesNotCount) {
  const fs::path target = folder_.path() / "parts";
  constexpr PartNames k_names{"part_", 2, ".txt", "done", "set of parts"};
  const auto write = [&target](int part) {
    std::ofstream(target / ("part_0" + std::to_string(part) + ".txt")) << "part";
  };
  {
    PartStore store(target, k_names, "digest", 3);
    for (int part = 0; part < 3; ++part) {
      write(part);
      store.add();
    }
  }
  fs::remove(target / "part_00.txt");
  EXPECT_EQ(PartStore(target, k_names, "digest", 3).done(), 0);
  write(0);  // and killed before add()
  EXPECT_EQ(PartStore(target, k_names, "digest", 3).done(), 0);
}

TEST_F(Film, AMarkThatCountsTooManyPartsIsNotBelieved) {
  const fs::path target = folder_.path() / "parts";
  constexpr PartNames k_names{"part_", 2, ".txt", "done", "set of parts"};
  fs::create_directories(target);
  for (const char* name : {"part_00.txt", "part_01.txt", "part_02.txt"}) std::ofstream(target / name) << "part";
  std::ofstream(target / "done") << "digest 2147483647\n";
  EXPECT_EQ(PartStore(target, k_names, "digest", 2).done(), 2);
}

/// A pipe would hold whoever opens it for ever.
TEST_F(Film, APipeInPlaceOfAMarkIsRefusedAndInPlaceOfAPartDoesNotCount) {
  const fs::path target = folder_.path() / "parts";
  constexpr PartNames k_names{"part_", 2, ".txt", "done", "set of parts"};
  fs::create_directories(target);
  ASSERT_EQ(mkfifo((target / "part_00.txt").c_str(), 0600), 0);
  std::ofstream(target / "done") << "digest 1\n";
  EXPECT_EQ(PartStore(target, k_names, "digest", 3).done(), 0);
  fs::remove(target / "done");
  ASSERT_EQ(mkfifo((target / "done").c_str(), 0600), 0);
  EXPECT_THROW(PartStore(target, k_names, "digest", 3), FileError);
}

TEST_F(Film, IsLeftToTheProcessThatMakesIt) {
  const fs::path target = folder_.path() / "frames";
  ASSERT_EQ(render_frames({&opened_}, target, options_, stop_after(2)), 2);
  const std::string mark = read_whole(target / ".frames");
  options_.camera = "top";
  {
    const FolderLock other(target, "set of frames", ".frames.lock");
    EXPECT_THROW((void)render_frames({&opened_}, target, options_), FileError);
  }
  EXPECT_EQ(read_whole(target / ".frames"), mark);
}

TEST_F(Film, FramesAreDrawnIntoTheFolderOfARunThatIsBeingWritten) {
  const fs::path target = folder_.path() / "frames";
  fs::create_directory(target);
  const FolderLock simulation(target, "run");
  EXPECT_EQ(render_frames({&opened_}, target, options_, stop_after(2)), 2);
}

TEST_F(Film, IsBegunAnewWhereAStretchCannotBeRead) {
  options_.fps = 140.0;
  const fs::path file = folder_.path() / "film.mp4", stretch = folder_.path() / ".film.stretches/stretch_0000.mp4";
  const std::vector<std::string> spoilt{"no film", ""};
  for (const std::string& content : spoilt) {
    ASSERT_EQ(render_film(run(), file, options_, stop_after(63)), 0);
    std::ofstream(stretch) << content;
    EXPECT_THROW((void)render_film(run(), file, options_), FileError);
    EXPECT_FALSE(fs::exists(stretch));
  }
  EXPECT_GT(render_film(run(), file, options_), 60);
}

TEST_F(Film, KeepsItsStretchesWhereItCannotBeWritten) {
  options_.fps = 140.0;
  const fs::path file = folder_.path() / "film.mp4", stretches = folder_.path() / ".film.stretches";
  ASSERT_EQ(render_film(run(), file, options_, stop_after(63)), 0);
  fs::create_directories(folder_.path() / ".film.partial.mp4/inside");  // neither written over nor removed
  EXPECT_THROW((void)render_film(run(), file, options_), FileError);
  EXPECT_TRUE(fs::exists(stretches / "stretch_0001.mp4"));
}

TEST_F(Film, LearnsBeforeItsFirstFrameThatItHasNoPlace) {
  const fs::path file = folder_.path() / "film.mp4", partial = folder_.path() / ".film.partial.mp4";
  const auto refused = [&] {
    int asked = 0;
    const auto count = [&asked](const ProgressReport&) { return ++asked > 0; };
    EXPECT_THROW((void)render_film(run(), file, options_, count), FileError);
    return asked == 0;
  };
  fs::create_directory(file);
  EXPECT_TRUE(refused());
  fs::remove(file);
  fs::create_symlink("elsewhere", partial);
  EXPECT_TRUE(refused());
  EXPECT_TRUE(fs::is_symlink(partial));  // not ours to remove
}

TEST_F(Film, KeepsItsStretchesWhereTheSystemRefusesToReadOne) {
  options_.fps = 140.0;
  const fs::path file = folder_.path() / "film.mp4", stretches = folder_.path() / ".film.stretches",
                 stretch = stretches / "stretch_0000.mp4", aside = folder_.path() / "aside.mp4";
  ASSERT_EQ(render_film(run(), file, options_, stop_after(63)), 0);
  fs::rename(stretch, aside);
  fs::create_directory(stretch);  // what the system refuses to read
  EXPECT_THROW((void)render_film(run(), file, options_), FileError);
  EXPECT_TRUE(fs::exists(stretches / "stretch_0001.mp4"));
  fs::remove(stretch);
  fs::rename(aside, stretch);
  EXPECT_GT(render_film(run(), file, options_), 60);
}

TEST_F(Film, AQuarterOfTheSpeedTakesFourTimesTheFrames) {
  options_.speed = 0.25;
  EXPECT_EQ(render_frames({&opened_}, folder_.path() / "slow", options_), 20);
  options_.speed = 0.0;
  EXPECT_THROW((void)render_film(run(), folder_.path() / "film.mp4", options_), InputError);
}

/// Frames of an earlier, longer film, of which a step was taken away before: none of them is taken for one of this
/// film.
TEST_F(Film, NoFrameOfALongerOneIsLeft) {
  const fs::path frames = folder_.path() / "frames";
  const int count = render_frames({&opened_}, frames, options_);
  const auto frame = [&](int number) { return frames / fmt::format("frame_{:06}.png", number); };
  for (const int number : {count, count + 2}) fs::copy_file(frame(0), frame(number));
  fs::copy_file(frame(0), frames / "frame_of_mine.png");
  render_frames({&opened_}, frames, options_);
  EXPECT_TRUE(fs::exists(frame(count - 1)));
  EXPECT_FALSE(fs::exists(frame(count)));
  EXPECT_FALSE(fs::exists(frame(count + 2)));
  EXPECT_TRUE(fs::exists(frames / "frame_of_mine.png"));
}

TEST_F(Film, TwoRunsStandSideBySideInOnePicture) {
  const RunFolder again = run();
  const Image both = render_still({&opened_, &again}, 0.2, options_);
  RenderOptions half = options_;
  half.width = options_.width / 2;
  const Image one = render_still(opened_, 0.2, half);
  ASSERT_EQ(both.width, options_.width);
  ASSERT_EQ(both.height, options_.height);
  for (int y = 0; y < one.height; ++y) {
    for (int x = 0; x < one.width - 1; ++x) {  // but for the line between them
      const auto in_one = static_cast<std::size_t>(3 * (one.width * y + x));
      const auto left = static_cast<std::size_t>(3 * (both.width * y + x)),
                 right = left + static_cast<std::size_t>(3 * one.width);
      ASSERT_EQ(both.bgr[left], one.bgr[in_one]);
      if (x > 0) {
        ASSERT_EQ(both.bgr[right], one.bgr[in_one]);
      }
    }
  }
}

TEST_F(Film, ACameraFileTakesThePlaceOfANamedCamera) {
  std::ofstream(folder_.path() / "camera.json") << R"({"format": "grouser.camera/1", "name": "own", "mount": "heading",
      "eye_m": [6, -8, 3], "target_m": [0, 0, 1], "field_of_view_deg": 40})";
  const Image named = render_still(opened_, 0.2, options_);
  options_.view = read_camera_view(folder_.path() / "camera.json");
  EXPECT_NE(render_still(opened_, 0.2, options_).bgr, named.bgr);
}

TEST_F(Film, CannotBeWrittenWhereThereIsNoFolder) {
  EXPECT_THROW((void)render_film(run(), folder_.path() / "missing" / "film.mp4", options_), FileError);
}

TEST_F(Film, FramesArePicturesThatDiffer) {
  const fs::path target = folder_.path() / "frames";
  fs::create_directories(target);
  EXPECT_EQ(render_frames({&opened_}, target, options_), 5);
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

TEST_F(Film, MorePicturesThanHaveNamesAreRefused) {
  options_.fps = 1e4;
  options_.speed = 1e-6;
  EXPECT_THROW((void)render_frames({&opened_}, folder_.path(), options_, {}), InputError);
  options_.fps = 1e300;
  EXPECT_THROW((void)render_frames({&opened_}, folder_.path(), options_, {}), InputError);
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
