#include "render/av_pictures.h"

#include <vector>

namespace grouser {

AvFrameHandle av_frame_of(int width, int height, AVPixelFormat format, const std::string& what) {
  AvFrameHandle frame(av_made(av_frame_alloc(), what));
  frame->format = format;
  frame->width = width;
  frame->height = height;
  av_checked(av_frame_get_buffer(frame.get(), 0), what);
  return frame;
}

AvScalerHandle av_scaler(int width, int height, AVPixelFormat from, AVPixelFormat to, const std::string& what) {
  const int exact = SWS_BICUBIC | SWS_ACCURATE_RND | SWS_BITEXACT |
                    (to == AV_PIX_FMT_BGR24 ? SWS_FULL_CHR_H_INT : SWS_FULL_CHR_H_INP);
  return AvScalerHandle(
      av_made(sws_getContext(width, height, from, width, height, to, exact, nullptr, nullptr, nullptr), what));
}

void convert(SwsContext& scaler, const Image& image, AVFrame& to) {
  constexpr std::size_t k_behind = 64;  // bytes: libswscale reads whole vectors, beyond the end of the last row
  std::vector<std::uint8_t> bgr;
  bgr.reserve(image.bgr.size() + k_behind);
  bgr.assign(image.bgr.begin(), image.bgr.end());
  bgr.resize(image.bgr.size() + k_behind);
  const std::array<const std::uint8_t*, 1> rows{bgr.data()};
  const std::array<int, 1> stride{3 * image.width};
  sws_scale(&scaler, rows.data(), stride.data(), 0, image.height, to.data, to.linesize);
}

Image converted(SwsContext& scaler, const AVFrame& from) {
  Image image{from.width, from.height, {}};
  image.bgr.resize(static_cast<std::size_t>(3 * image.width) * static_cast<std::size_t>(image.height));
  const std::array<std::uint8_t*, 1> rows{image.bgr.data()};
  const std::array<int, 1> stride{3 * image.width};
  sws_scale(&scaler, from.data, from.linesize, 0, from.height, rows.data(), stride.data());
  return image;
}

}  // namespace grouser
