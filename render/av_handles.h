#pragma once
extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libswscale/swscale.h>
}

#include <array>
#include <cerrno>
#include <filesystem>
#include <memory>
#include <string>

#include "model/errors.h"

namespace grouser {

/// FFmpeg's objects, released where they end.
template <auto release>
struct AvRelease {
  template <typename T>
  void operator()(T* pointer) const {
    release(&pointer);
  }
};
using AvCodecHandle = std::unique_ptr<AVCodecContext, AvRelease<avcodec_free_context>>;
using AvFrameHandle = std::unique_ptr<AVFrame, AvRelease<av_frame_free>>;
using AvPacketHandle = std::unique_ptr<AVPacket, AvRelease<av_packet_free>>;
using AvInputHandle = std::unique_ptr<AVFormatContext, AvRelease<avformat_close_input>>;
struct AvScalerRelease {
  void operator()(SwsContext* scaler) const { sws_freeContext(scaler); }
};
using AvScalerHandle = std::unique_ptr<SwsContext, AvScalerRelease>;

/// What FFmpeg answered unless it is an error; throws Error("`what`: reason") then, or FileError where the system's
/// memory, descriptors or disk are to blame, and no file's content.
template <typename Error = FileError>
int av_checked(int code, const std::string& what) {
  if (code >= 0) return code;
  std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
  av_strerror(code, text.data(), text.size());
  const std::string reason = what + ": " + text.data();
  constexpr int k_last_errno = 4095;  // FFmpeg's own codes are further from 0
  if (code >= -k_last_errno && code != AVERROR(EINVAL)) throw FileError(reason);
  throw Error(reason);
}

template <typename T>
T* av_made(T* pointer, const std::string& what) {
  if (pointer == nullptr) throw FileError(what + ": no memory, or not part of this FFmpeg");
  return pointer;
}

/// A file's name as FFmpeg takes it for nothing else: "http:" or "concat:" at its beginning would not name a file.
inline std::string av_file_url(const std::filesystem::path& file) { return "file:" + file.string(); }

/// A file to be read. Throws Error.
template <typename Error>
AvInputHandle av_opened(const std::filesystem::path& file, const std::string& what) {
  AVFormatContext* input = nullptr;
  av_checked<Error>(avformat_open_input(&input, av_file_url(file).c_str(), nullptr, nullptr), what);
  return AvInputHandle(input);
}

}  // namespace grouser
