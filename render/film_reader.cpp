#include "render/film_reader.h"

#include "render/av_handles.h"

namespace grouser {
namespace {

AvInputHandle opened(const std::filesystem::path& file, const std::string& what) {
  AVFormatContext* input = nullptr;
  av_checked<DamagedFilm>(avformat_open_input(&input, av_file_url(file).c_str(), nullptr, nullptr), what);
  return AvInputHandle(input);
}

}  // namespace

struct FilmReader::Impl {
  std::string what;  ///< begins every message
  AvInputHandle input;
  AvCodecHandle codec;
  AvFrameHandle frame{av_made(av_frame_alloc(), what)};
  AvPacketHandle packet{av_made(av_packet_alloc(), what)};

  explicit Impl(const std::filesystem::path& file) : what("cannot read " + file.string()), input(opened(file, what)) {
    if (input->nb_streams != 1 || input->streams[0]->codecpar->codec_id != AV_CODEC_ID_H264)
      throw DamagedFilm(what + ": expected one stream in H.264");
    codec.reset(av_made(avcodec_alloc_context3(avcodec_find_decoder(AV_CODEC_ID_H264)), what));
    av_checked<DamagedFilm>(avcodec_parameters_to_context(codec.get(), input->streams[0]->codecpar), what);
    av_checked<DamagedFilm>(avcodec_open2(codec.get(), nullptr, nullptr), what);
  }

  /// Hands the next packet to the decoder, or that there is none.
  void feed() {
    const int code = av_read_frame(input.get(), packet.get());
    if (code != AVERROR_EOF) av_checked<DamagedFilm>(code, what);
    av_checked<DamagedFilm>(avcodec_send_packet(codec.get(), code == AVERROR_EOF ? nullptr : packet.get()), what);
    av_packet_unref(packet.get());
  }
};

FilmReader::FilmReader(const std::filesystem::path& file) : impl_(std::make_unique<Impl>(file)) {}

FilmReader::~FilmReader() = default;

bool FilmReader::next() {
  while (true) {
    const int code = avcodec_receive_frame(impl_->codec.get(), impl_->frame.get());
    if (code == AVERROR_EOF) return false;
    if (code != AVERROR(EAGAIN)) return av_checked<DamagedFilm>(code, impl_->what) == 0;
    impl_->feed();
  }
}

Image FilmReader::frame() const {
  const AVFrame& from = *impl_->frame;
  Image image{from.width, from.height, {}};
  image.bgr.resize(static_cast<std::size_t>(3 * image.width) * static_cast<std::size_t>(image.height));
  const auto format = static_cast<AVPixelFormat>(from.format);
  constexpr int k_exact = SWS_BICUBIC | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INT | SWS_BITEXACT;
  const AvScalerHandle scaler(av_made(sws_getContext(from.width, from.height, format, from.width, from.height,
                                                     AV_PIX_FMT_BGR24, k_exact, nullptr, nullptr, nullptr),
                                      impl_->what));
  const int* bt709 = sws_getCoefficients(SWS_CS_ITU709);
  sws_setColorspaceDetails(scaler.get(), bt709, 0, bt709, 1, 0, 1 << 16, 1 << 16);
  const std::array<std::uint8_t*, 1> rows{image.bgr.data()};
  const std::array<int, 1> stride{3 * image.width};
  sws_scale(scaler.get(), from.data, from.linesize, 0, from.height, rows.data(), stride.data());
  return image;
}

}  // namespace grouser
