#include "render/frame_store.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <fstream>
#include <system_error>

#include "model/errors.h"
#include "model/provenance.h"

namespace grouser {

namespace fs = std::filesystem;

namespace {

constexpr int k_png_level = 1;  // of 9: half the time of a frame is not worth a fifth of its size

/// Without a sync: only a frame that is counted is read again, and a lost count costs time alone.
void write_bytes(const fs::path& file, std::string_view bytes) {
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out) throw FileError("cannot write " + file.string());
}

}  // namespace

std::string frames_digest(const Runs& runs, const RenderOptions& options) {
  std::string text = fmt::format("{}x{} {} {} {} {}\n", options.width, options.height, options.fps, options.speed,
                                 options.camera, fmt::join(options.overlays, ","));
  if (options.view) {
    const CameraView& view = *options.view;
    text += fmt::format("{} {} {} {} {}\n", static_cast<int>(view.mount), fmt::join(view.eye, " "),
                        fmt::join(view.target, " "), view.field_of_view, view.height.value_or(0.0));
  }
  for (const RunFolder* run : runs) {
    // The same inputs give the same run; its size tells how far it came.
    text += fmt::format("{} {} {}\n", run->summary.name, run->summary.provenance.version,
                        fs::file_size(run->path / "run.h5"));
    for (const Provenance::Input& input : run->summary.provenance.inputs) text += input.sha256 + "\n";
    for (const auto& [name, value] : run->summary.provenance.options) text += name + "=" + value + "\n";
  }
  return sha256_of(text);
}

FrameStore::FrameStore(fs::path folder, std::string digest) : folder_(std::move(folder)), digest_(std::move(digest)) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) throw FileError("cannot write into " + folder_.string() + ": " + error.message());
  std::ifstream known(mark());
  std::string of;
  int count = 0;
  if (known >> of >> count && of == digest_) done_ = count;
  while (done_ > 0 && !fs::exists(file_of(done_ - 1))) --done_;
}

fs::path FrameStore::file_of(int frame) const { return folder_ / fmt::format("frame_{:06}.png", frame); }

void FrameStore::add(const Image& image) {
  const std::vector<std::uint8_t> bytes = encode_png(image, k_png_level);
  write_bytes(file_of(done_), {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  ++done_;
  write_bytes(mark(), fmt::format("{} {}\n", digest_, done_));
}

}  // namespace grouser
