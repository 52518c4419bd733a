#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <system_error>

#include "model/errors.h"
#include "model/provenance.h"
#include "model/replace_file.h"
#include "render/film_encoder.h"
#include "render/film_reader.h"
#include "render/frame_maker.h"
#include "render/part_store.h"

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
    replace_file(path_, file);
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
    require("fps", options.fps, 1e-3, 1e4);  // tried from end to end
    require("speed", options.speed, 1e-6, 1e6);
    interval = options.speed / options.fps;
    const double pictures = (screen.last_time() - first) / interval;
    if (pictures > k_most_pictures)
      throw InputError({"film", "fps and speed", fmt::format("at most {} pictures", k_most_pictures),
                        fmt::format("{:.4g}", pictures), ""});
    count = std::max(1, static_cast<int>(std::lround(pictures)));
  }
  [[nodiscard]] double at(int frame) const { return first + frame * interval; }

 private:
  static constexpr int k_most_pictures = 1'000'000;  ///< the last is frame_999999.png
  static void require(const char* name, double value, double least, double most) {
    if (value >= least && value <= most) return;
    throw InputError(
        {"film", name, fmt::format("a number from {:g} to {:g}", least, most), fmt::format("{}", value), ""});
  }
};

bool keep_going(const Progress& progress, const FrameTimes& times, int done) {
  if (!progress) return true;
  return progress({static_cast<double>(done) / times.count, fmt::format("frame {} of {}", done, times.count)});
}

/// Standard deviation of all bytes of a picture.
double spread(const Image& image) {
  double sum = 0.0, squares = 0.0;
  for (const double byte : image.bgr) {
    sum += byte;
    squares += byte * byte;
  }
  const auto count = static_cast<double>(image.bgr.size());
  return std::sqrt(std::max(0.0, squares / count - sum * sum / (count * count)));
}

/// Reads the film again from end to end: what the next program will find.
void check_film(const fs::path& file, const FrameTimes& times, const RenderOptions& options) {
  const auto fail = [&file](const std::string& what) {
    throw DamagedFilm("film " + file.string() + " was not written right: " + what);
  };
  FilmReader film(file);
  int count = 0;
  for (; film.next(); ++count) {
    if (count % 50 != 0) continue;
    const Image frame = film.frame();
    if (frame.width != options.width || frame.height != options.height)
      fail(fmt::format("size {} x {}", frame.width, frame.height));
    if (spread(frame) < 1.0) fail(fmt::format("frame {} is of one colour", count));
  }
  if (count != times.count) fail(fmt::format("{} frames of {}", count, times.count));
  const double shown = film.duration() * options.fps;
  if (std::abs(shown - count) > 0.5) fail(fmt::format("as long as {:g} frames of {}", shown, count));
}

constexpr PartNames k_frames{"frame_", 6, ".png", ".frames", "set of frames"},
    k_stretches{"stretch_", 4, ".mp4", "done", "film"};
constexpr int k_png_level = 1;  // of 9: half the time of a frame is not worth a fifth of its size

/// What frames are made of: equal digests give equal frames.
std::string digest_of(const std::string& mark, const RenderOptions& options) {
  std::string text = fmt::format("{} {}\n{}x{} {} {} {} {}\n", program_version(), mark, options.width, options.height,
                                 options.fps, options.speed, options.camera, fmt::join(options.overlays, ","));
  if (options.view) {
    const CameraView& view = *options.view;
    text += fmt::format("{} {} {} {} {}\n", static_cast<int>(view.mount), fmt::join(view.eye, " "),
                        fmt::join(view.target, " "), view.field_of_view, view.height.value_or(0.0));
  }
  return sha256_of(text);
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
  PartStore store(folder, k_frames, digest_of(film_mark(runs), options), times.count);
  for (int frame = store.done(); frame < times.count; ++frame) {
    if (!keep_going(progress, times, frame)) return frame;
    const std::vector<std::uint8_t> png = encode_png(screen.at(times.at(frame)), k_png_level);
    write_whole(store.next(), {reinterpret_cast<const char*>(png.data()), png.size()});
    store.add();
  }
  store.cut();
  keep_going(progress, times, times.count);
  return times.count;
}

int render_film(const Runs& runs, const fs::path& file, const RenderOptions& options, const Progress& progress) {
  SplitScreen screen(runs, options, 1);
  const FrameTimes times(screen, options);
  const std::string hidden = "." + file.stem().string(), mark = film_mark(runs);
  const fs::path stretches = file.parent_path() / (hidden + ".stretches");
  const fs::path joined = file.parent_path() / (hidden + ".partial.mp4");
  require_own(stretches);
  require_own_file(joined);
  require_place_of_file(file);
  PartStore store(stretches, k_stretches, digest_of(mark, options), (times.count - 1) / k_stretch + 1);
  for (int first = store.done() * k_stretch; first < times.count; first += k_stretch) {
    FilmEncoder encoder(store.next(), options.width, options.height, options.fps);
    if (!film_stretch(screen, times, first, std::min(first + k_stretch, times.count), encoder, progress)) return 0;
    sync_file(store.next());
    store.add();
  }
  TemporaryFile partial(joined);
  try {
    join_films(store.files(), partial.path(), mark);
    check_film(partial.path(), times, options);
  } catch (const DamagedFilm&) {
    store.remove();  // a stretch is damaged: the next try begins anew
    throw;
  }
  partial.keep_as(file);
  store.remove();
  keep_going(progress, times, times.count);
  return times.count;
}

}  // namespace grouser
