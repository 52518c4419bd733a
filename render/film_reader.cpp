#include "render/film_reader.h"

#include "render/av_pictures.h"

namespace grouser {
struct FilmReader::Impl {
  std::string what;  ///< begins every message
  AvInputHandle input;
  AvCodecHandle codec;
  AvFrameHandle frame{av_made(av_frame_alloc(), what)};
  AvPacketHandle packet{av_made(av_packet_alloc(), what)};

  explicit Impl(const std::filesystem::path& file)
      : what("cannot read " + file.string()), input(av_opened<DamagedFilm>(file, what)) {
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

double FilmReader::duration() const {
  const AVStream& stream = *impl_->input->streams[0];
  return static_cast<double>(stream.duration) * av_q2d(stream.time_base);
}

Image FilmReader::frame() const {
  const AVFrame& from = *impl_->frame;
  const AvScalerHandle scaler =
      av_scaler(from.width, from.height, static_cast<AVPixelFormat>(from.format), AV_PIX_FMT_BGR24, impl_->what);
  const int* bt709 = sws_getCoefficients(SWS_CS_ITU709);
  sws_setColorspaceDetails(scaler.get(), bt709, 0, bt709, 1, 0, 1 << 16, 1 << 16);
  return converted(*scaler, from);
}

}  // namespace grouser
