#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>
#include <system_error>

#include "model/errors.h"
#include "render/film_encoder.h"
#include "render/film_store.h"
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

constexpr int k_stretch = 60;  ///< frames that are encoded together; a stopped film loses fewer

/// Draws and encodes the frames [first, last); false when stopped. A frame is encoded while the next one is drawn.
bool film_stretch(SplitScreen& screen, const FrameTimes& times, int first, int last, FilmEncoder& encoder,
                  const Progress& progress) {
  std::future<void> encoded;
  for (int frame = first; frame < last; ++frame) {
    if (!keep_going(progress, times, frame)) return false;
    Image image = screen.at(times.at(frame));
    if (encoded.valid()) encoded.get();
    encoded = std::async(std::launch::async, [&encoder, drawn = std::move(image)] { encoder.add(drawn); });
  }
  encoded.get();
  encoder.finish();
  return true;
}

}  // namespace

int render_frames(const Runs& runs, const fs::path& folder, const RenderOptions& options, const Progress& progress) {
  SplitScreen screen(runs, options, 1);
  const FrameTimes times(screen, options);
  FrameStore store(folder, frames_digest(runs, options));
  for (int frame = store.done(); frame < times.count; ++frame) {
    if (!keep_going(progress, times, frame)) return frame;
    store.add(screen.at(times.at(frame)));
  }
  keep_going(progress, times, times.count);
  return times.count;
}

int render_film(const Runs& runs, const fs::path& file, const RenderOptions& options, const Progress& progress) {
  SplitScreen screen(runs, options, 1);
  const FrameTimes times(screen, options);
  const std::string hidden = "." + file.stem().string();
  FilmStore store(file.parent_path() / (hidden + ".stretches"), frames_digest(runs, options));
  for (int first = store.done() * k_stretch; first < times.count; first += k_stretch) {
    FilmEncoder encoder(store.next(), options.width, options.height, options.fps);
    if (!film_stretch(screen, times, first, std::min(first + k_stretch, times.count), encoder, progress)) return 0;
    store.add();
  }
  TemporaryFile partial(file.parent_path() / (hidden + ".partial.mp4"));
  join_films(store.stretches(), partial.path());
  check_film(partial.path(), times, options);
  partial.keep_as(file);
  store.remove();
  keep_going(progress, times, times.count);
  return times.count;
}

}  // namespace grouser
