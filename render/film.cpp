#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>
#include <system_error>

#include "model/errors.h"
#include "render/frame_maker.h"

namespace grouser {
namespace {

namespace fs = std::filesystem;

/// A file that goes away unless it was kept: no half film is left behind by an interrupt or an error.
class TemporaryFile {
 public:
  explicit TemporaryFile(fs::path path) : path_(std::move(path)) {}
  ~TemporaryFile() {
    std::error_code ignored;
    if (!kept_) fs::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }
  void keep_as(const fs::path& file) {
    std::error_code error;
    fs::rename(path_, file, error);
    if (error) throw FileError("cannot write " + file.string() + ": " + error.message());
    kept_ = true;
  }

 private:
  fs::path path_;
  bool kept_ = false;
};

/// Times of the frames: from the first sample, each shown for 1 / fps up to the last.
struct FrameTimes {
  double first = 0.0, fps = 30.0;
  int count = 1;
  FrameTimes(const FrameMaker& maker, const RenderOptions& options) : first(maker.first_time()), fps(options.fps) {
    if (!(fps > 0.0)) throw InputError({"", "fps", "a number > 0", fmt::format("{}", fps), ""});
    count = std::max(1, static_cast<int>(std::lround((maker.last_time() - first) * fps)));
  }
  [[nodiscard]] double at(int frame) const { return first + frame / fps; }
};

bool keep_going(const Progress& progress, const FrameTimes& times, int done) {
  if (!progress) return true;
  return progress({static_cast<double>(done) / times.count, fmt::format("frame {} of {}", done, times.count)});
}

/// cv::VideoWriter tells nothing of a frame that it dropped, so the film is read again.
void check_film(const fs::path& file, const FrameTimes& times, const RenderOptions& options) {
  cv::VideoCapture film(file.string(), cv::CAP_FFMPEG);
  const auto value = [&film](int property) { return static_cast<int>(std::lround(film.get(property))); };
  const auto fail = [&file](const std::string& what) {
    throw FileError("film " + file.string() + " was not written right: " + what);
  };
  if (!film.isOpened()) fail("it does not open");
  if (value(cv::CAP_PROP_FRAME_COUNT) != times.count)
    fail(fmt::format("{} frames of {}", value(cv::CAP_PROP_FRAME_COUNT), times.count));
  if (value(cv::CAP_PROP_FRAME_WIDTH) != options.width || value(cv::CAP_PROP_FRAME_HEIGHT) != options.height)
    fail(fmt::format("size {} x {}", value(cv::CAP_PROP_FRAME_WIDTH), value(cv::CAP_PROP_FRAME_HEIGHT)));
  cv::Mat frame, deviation;
  if (!film.read(frame)) fail("its first frame cannot be read");
  cv::meanStdDev(frame, cv::noArray(), deviation);
  if (cv::norm(deviation) < 1.0) fail("its first frame is of one colour");
}

}  // namespace

int render_frames(const RunFolder& run, const fs::path& folder, const RenderOptions& options,
                  const Progress& progress) {
  FrameMaker maker(run, options, 1);
  const FrameTimes times(maker, options);
  for (int frame = 0; frame < times.count; ++frame) {
    if (!keep_going(progress, times, frame)) return frame;
    write_png(maker.at(times.at(frame)), folder / fmt::format("frame_{:06}.png", frame));
  }
  keep_going(progress, times, times.count);
  return times.count;
}

int render_film(const RunFolder& run, const fs::path& file, const RenderOptions& options, const Progress& progress) {
  FrameMaker maker(run, options, 1);
  const FrameTimes times(maker, options);
  TemporaryFile partial(file.parent_path() / ("." + file.stem().string() + ".partial.mp4"));
  cv::VideoWriter writer;
  // isColor must be said: without it colour frames are dropped in silence.
  if (!writer.open(partial.path().string(), cv::CAP_FFMPEG, cv::VideoWriter::fourcc('a', 'v', 'c', '1'), options.fps,
                   cv::Size(options.width, options.height), true))
    throw FileError("cannot write " + file.string() + ": no H.264 film can be opened there");
  for (int frame = 0; frame < times.count; ++frame) {
    if (!keep_going(progress, times, frame)) return 0;
    Image image = maker.at(times.at(frame));
    writer.write(cv::Mat(image.height, image.width, CV_8UC3, image.bgr.data()));
  }
  writer.release();
  check_film(partial.path(), times, options);
  partial.keep_as(file);
  keep_going(progress, times, times.count);
  return times.count;
}

}  // namespace grouser
