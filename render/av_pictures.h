#pragma once
#include "render/av_handles.h"
#include "render/image.h"

/// Pictures in FFmpeg's arrangements of pixels. `what` begins the message of a FileError.
namespace grouser {

/// A frame with room for a picture.
[[nodiscard]] AvFrameHandle av_frame_of(int width, int height, AVPixelFormat format, const std::string& what);

/// Converts pictures of one size from one arrangement to another, to the same bytes on every processor. Where the
/// picture is in colours and the other side in luminance and chrominance, each pixel has its own colour.
[[nodiscard]] AvScalerHandle av_scaler(int width, int height, AVPixelFormat from, AVPixelFormat to,
                                       const std::string& what);

/// By a scaler from AV_PIX_FMT_BGR24.
void convert(SwsContext& scaler, const Image& image, AVFrame& to);
/// By a scaler to AV_PIX_FMT_BGR24.
[[nodiscard]] Image converted(SwsContext& scaler, const AVFrame& from);

}  // namespace grouser
