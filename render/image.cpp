#include "render/image.h"

#include <cstring>

#include "model/errors.h"
#include "model/provenance.h"
#include "render/av_pictures.h"

namespace grouser {
namespace {

/// One picture by one of FFmpeg's codecs. `options`: as av_dict_parse_string() takes them.
std::vector<std::uint8_t> encoded(const Image& image, const char* codec_name, AVPixelFormat format,
                                  const std::string& options) {
  const std::string what = std::string("cannot encode a picture with ") + codec_name;
  const AVCodec* encoder = av_made(avcodec_find_encoder_by_name(codec_name), what);
  const AvCodecHandle codec(av_made(avcodec_alloc_context3(encoder), what));
  codec->width = image.width;
  codec->height = image.height;
  codec->pix_fmt = format;
  codec->time_base = {1, 1};
  codec->thread_count = 1;
  AVDictionary* dictionary = nullptr;
  av_dict_parse_string(&dictionary, options.c_str(), "=", ":", 0);
  const int opened = avcodec_open2(codec.get(), encoder, &dictionary);
  av_dict_free(&dictionary);
  av_checked(opened, what);
  const AvFrameHandle frame = av_frame_of(image.width, image.height, format, what);
  convert(*av_scaler(image.width, image.height, AV_PIX_FMT_BGR24, format, what), image, *frame);
  const AvPacketHandle packet(av_made(av_packet_alloc(), what));
  av_checked(avcodec_send_frame(codec.get(), frame.get()), what);
  av_checked(avcodec_send_frame(codec.get(), nullptr), what);
  av_checked(avcodec_receive_packet(codec.get(), packet.get()), what);
  return {packet->data, packet->data + packet->size};
}

}  // namespace

std::vector<std::uint8_t> encode_png(const Image& image, int level) {
  return encoded(image, "png", AV_PIX_FMT_RGB24, "pred=mixed:compression_level=" + std::to_string(level));
}

std::vector<std::uint8_t> encode_webp(const Image& image, int quality) {
  return encoded(image, "libwebp", AV_PIX_FMT_YUV420P, "quality=" + std::to_string(quality));
}

void write_png(const Image& image, const std::filesystem::path& file) {
  const std::vector<std::uint8_t> bytes = encode_png(image);
  write_whole(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

Image read_png(const std::filesystem::path& file) {
  const std::string bytes = read_whole(file), what = "cannot read " + file.string() + ": not a picture";
  const AVCodec* decoder = av_made(avcodec_find_decoder(AV_CODEC_ID_PNG), what);
  const AvCodecHandle codec(av_made(avcodec_alloc_context3(decoder), what));
  codec->log_level_offset = AV_LOG_INFO;  // what fails is thrown
  av_checked(avcodec_open2(codec.get(), decoder, nullptr), what);
  const AvPacketHandle packet(av_made(av_packet_alloc(), what));
  av_checked(av_new_packet(packet.get(), static_cast<int>(bytes.size())), what);
  std::memcpy(packet->data, bytes.data(), bytes.size());
  const AvFrameHandle frame(av_made(av_frame_alloc(), what));
  av_checked(avcodec_send_packet(codec.get(), packet.get()), what);
  av_checked(avcodec_receive_frame(codec.get(), frame.get()), what);
  if (frame->format != AV_PIX_FMT_RGB24) throw FileError(what + " of three colours with eight bits each");
  Image image{frame->width, frame->height, {}};
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* row = frame->data[0] + y * frame->linesize[0];
    for (int x = 0; x < image.width; ++x, row += 3) image.bgr.insert(image.bgr.end(), {row[2], row[1], row[0]});
  }
  return image;
}

}  // namespace grouser
