#include "render/image.h"

#include <opencv2/imgcodecs.hpp>

#include "model/errors.h"
#include "model/provenance.h"

namespace grouser {

std::vector<std::uint8_t> encode_png(const Image& image, int level) {
  const cv::Mat pixels(image.height, image.width, CV_8UC3, const_cast<std::uint8_t*>(image.bgr.data()));
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(".png", pixels, bytes, {cv::IMWRITE_PNG_COMPRESSION, level}))
    throw FileError("cannot encode a picture as PNG");
  return bytes;
}

std::vector<std::uint8_t> encode_webp(const Image& image, int quality) {
  const cv::Mat pixels(image.height, image.width, CV_8UC3, const_cast<std::uint8_t*>(image.bgr.data()));
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(".webp", pixels, bytes, {cv::IMWRITE_WEBP_QUALITY, quality}))
    throw FileError("cannot encode a picture as WebP");
  return bytes;
}

void write_png(const Image& image, const std::filesystem::path& file) {
  const std::vector<std::uint8_t> bytes = encode_png(image);
  write_whole(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

Image read_png(const std::filesystem::path& file) {
  const std::string bytes = read_whole(file);
  const cv::Mat raw(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<char*>(bytes.data()));
  const cv::Mat pixels = bytes.empty() ? cv::Mat() : cv::imdecode(raw, cv::IMREAD_COLOR);
  if (pixels.empty()) throw FileError("cannot read " + file.string() + ": not a picture");
  return {pixels.cols, pixels.rows, {pixels.datastart, pixels.dataend}};
}

}  // namespace grouser
