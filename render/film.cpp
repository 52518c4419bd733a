#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>
#include <system_error>

#include "model/errors.h"
#include "render/frame_maker.h"
#include "render/frame_store.h"

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
  double first = 0.0, interval = 1.0;
  int count = 1;
  FrameTimes(const SplitScreen& screen, const RenderOptions& options) : first(screen.first_time()) {
    const auto require = [](const char* name, double value) {
      if (!(value > 0.0)) throw InputError({"", name, "a number > 0", fmt::format("{}", value), ""});
    };
    require("fps", options.fps);
    require("speed", options.speed);
    interval = options.speed / options.fps;
    count = std::max(1, static_cast<int>(std::lround((screen.last_time() - first) / interval)));
  }
  [[nodiscard]] double at(int frame) const { return first + frame * interval; }
};

bool keep_going(const Progress& progress, const FrameTimes& times, int done) {
  if (!progress) return true;
  return progress({static_cast<double>(done) / times.count, fmt::format("frame {} of {}", done, times.count)});
}

/// cv::VideoWriter tells nothing of a frame that it dropped, so the film is read again from end to end.
void check_film(const fs::path& file, const FrameTimes& times, const RenderOptions& options) {
  cv::VideoCapture film(file.string(), cv::CAP_FFMPEG);
  const auto value = [&film](int property) { return static_cast<int>(std::lround(film.get(property))); };
  const auto fail = [&file](const std::string& what) {
    throw FileError("film " + file.string() + " was not written right: " + what);
  };
  if (!film.isOpened()) fail("it does not open");
  if (value(cv::CAP_PROP_FOURCC) != cv::VideoWriter::fourcc('a', 'v', 'c', '1')) fail("it is not avc1");
  if (value(cv::CAP_PROP_FRAME_WIDTH) != options.width || value(cv::CAP_PROP_FRAME_HEIGHT) != options.height)
    fail(fmt::format("size {} x {}", value(cv::CAP_PROP_FRAME_WIDTH), value(cv::CAP_PROP_FRAME_HEIGHT)));
  int count = 0;
  cv::Mat frame, deviation;
  for (; film.grab(); ++count) {
    if (count % 50 != 0) continue;
    if (!film.retrieve(frame)) fail(fmt::format("frame {} cannot be read", count));
    cv::meanStdDev(frame, cv::noArray(), deviation);
    if (cv::norm(deviation) < 1.0) fail(fmt::format("frame {} is of one colour", count));
  }
  if (count != times.count) fail(fmt::format("{} frames of {}", count, times.count));
}

/// Draws frames into a folder, or reads those that stand there already.
class FrameSource {
 public:
  FrameSource(const Runs& runs, const RenderOptions& options, const fs::path& folder)
      : screen_(runs, options, 1), times_(screen_, options), store_(folder, frames_digest(runs, options)) {}
  [[nodiscard]] const FrameTimes& times() const { return times_; }
  [[nodiscard]] FrameStore& store() { return store_; }
  [[nodiscard]] Image get(int frame) {
    if (frame < store_.done()) return store_.read(frame);
    Image image = screen_.at(times_.at(frame));
    store_.add(image);
    return image;
  }

 private:
  SplitScreen screen_;
  FrameTimes times_;
  FrameStore store_;
};

}  // namespace

int render_frames(const Runs& runs, const fs::path& folder, const RenderOptions& options, const Progress& progress) {
  FrameSource source(runs, options, folder);
  const FrameTimes& times = source.times();
  for (int frame = source.store().done(); frame < times.count; ++frame) {
    if (!keep_going(progress, times, frame)) return frame;
    static_cast<void>(source.get(frame));
  }
  keep_going(progress, times, times.count);
  return times.count;
}

int render_film(const Runs& runs, const fs::path& file, const RenderOptions& options, const Progress& progress) {
  const std::string hidden = "." + file.stem().string();
  TemporaryFile partial(file.parent_path() / (hidden + ".partial.mp4"));
  cv::VideoWriter writer;
  // isColor must be said: without it colour frames are dropped in silence.
  if (!writer.open(partial.path().string(), cv::CAP_FFMPEG, cv::VideoWriter::fourcc('a', 'v', 'c', '1'), options.fps,
                   cv::Size(options.width, options.height), true))
    throw FileError("cannot write " + file.string() + ": no H.264 film can be opened there");
  const fs::path folder = file.parent_path() / (hidden + ".frames");
  FrameSource source(runs, options, folder);
  const FrameTimes& times = source.times();
  for (int frame = 0; frame < times.count; ++frame) {
    if (!keep_going(progress, times, frame)) return 0;
    Image image = source.get(frame);
    writer.write(cv::Mat(image.height, image.width, CV_8UC3, image.bgr.data()));
  }
  writer.release();
  check_film(partial.path(), times, options);
  partial.keep_as(file);
  source.store().remove();
  keep_going(progress, times, times.count);
  return times.count;
}

}  // namespace grouser
