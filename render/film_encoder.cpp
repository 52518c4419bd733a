#include "render/film_encoder.h"

#include "model/replace_file.h"
#include "render/av_pictures.h"
#include "render/film_reader.h"

namespace grouser {
namespace {

namespace fs = std::filesystem;

/// x264: 14 ms of processor a frame of 1280 x 720 in place of 33 with its default preset, for files a tenth larger.
constexpr const char* k_preset = "veryfast";
constexpr const char* k_quality = "22";  ///< CRF, 18 looks lossless, 23 is the default
constexpr int k_longest_gap = 250;       ///< frames between key frames

std::string not_writable(const fs::path& file) { return "cannot write " + file.string(); }

int checked(int code, const fs::path& file) { return av_checked(code, not_writable(file)); }

template <typename T>
T* made(T* pointer, const fs::path& file) {
  return av_made(pointer, not_writable(file));
}

/// An MP4 file with one stream.
class Mp4Writer {
 public:
  explicit Mp4Writer(const fs::path& file) : file_(file) {
    checked(avformat_alloc_output_context2(&context_, nullptr, "mp4", av_file_url(file).c_str()), file);
    context_->flags |= AVFMT_FLAG_BITEXACT;  // no version of the library in the file
    stream_ = avformat_new_stream(context_, nullptr);
  }
  ~Mp4Writer() {
    if (context_ == nullptr) return;
    avio_closep(&context_->pb);
    avformat_free_context(context_);
  }
  Mp4Writer(const Mp4Writer&) = delete;
  Mp4Writer& operator=(const Mp4Writer&) = delete;

  void describe(const std::string& comment) {
    checked(av_dict_set(&context_->metadata, "comment", comment.c_str(), 0), file_);
  }
  [[nodiscard]] AVStream& stream() { return *made(stream_, file_); }
  void begin() {
    require_own_file(file_);
    checked(avio_open(&context_->pb, av_file_url(file_).c_str(), AVIO_FLAG_WRITE), file_);
    checked(avformat_write_header(context_, nullptr), file_);
  }
  /// Takes the packet's content.
  void write(AVPacket& packet) { checked(av_interleaved_write_frame(context_, &packet), file_); }
  void finish() {
    checked(av_write_trailer(context_), file_);
    checked(avio_closep(&context_->pb), file_);
  }

 private:
  fs::path file_;
  AVFormatContext* context_ = nullptr;
  AVStream* stream_ = nullptr;
};

std::string not_readable(const fs::path& film) { return "cannot read " + film.string(); }

AvInputHandle open_film(const fs::path& film) {
  AvInputHandle in = av_opened<DamagedFilm>(film, not_readable(film));
  if (in->nb_streams != 1) throw DamagedFilm(not_readable(film) + ": expected one stream");
  return in;
}

/// False at the end.
bool read_packet(AVFormatContext& in, AVPacket& packet, const fs::path& film) {
  const int code = av_read_frame(&in, &packet);
  return code != AVERROR_EOF && av_checked<DamagedFilm>(code, not_readable(film)) >= 0;
}

/// How long each frame of a stretch is shown, in its time base: the same for all. (av_read_frame() guesses it, and
/// leaves it at 0 from 1000 fields a second on.)
std::int64_t duration_of_frame(const AVStream& stream, const fs::path& film) {
  if (stream.nb_frames <= 0 || stream.duration <= 0 || stream.duration % stream.nb_frames != 0)
    throw DamagedFilm(not_readable(film) + ": expected frames of one duration");
  return stream.duration / stream.nb_frames;
}

AvCodecHandle open_x264(const fs::path& file, int width, int height, double fps) {
  const AVCodec* x264 = made(avcodec_find_encoder_by_name("libx264"), file);
  AvCodecHandle codec(made(avcodec_alloc_context3(x264), file));
  codec->width = width;
  codec->height = height;
  codec->framerate = av_d2q(fps, 100000);
  codec->time_base = av_inv_q(codec->framerate);
  codec->pix_fmt = AV_PIX_FMT_YUV420P;
  codec->color_range = AVCOL_RANGE_MPEG;
  codec->color_primaries = AVCOL_PRI_BT709;
  codec->color_trc = AVCOL_TRC_BT709;
  codec->colorspace = AVCOL_SPC_BT709;
  codec->gop_size = k_longest_gap;
  codec->thread_count = 1;                      // the bytes would depend on the number
  codec->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;  // as avc1 wants it
  codec->flags |= AV_CODEC_FLAG_CLOSED_GOP;
  codec->log_level_offset = AV_LOG_INFO;  // what fails is thrown
  AVDictionary* options = nullptr;
  av_dict_set(&options, "preset", k_preset, 0);
  av_dict_set(&options, "crf", k_quality, 0);
  const int opened = avcodec_open2(codec.get(), x264, &options);
  av_dict_free(&options);
  checked(opened, file);
  return codec;
}

}  // namespace

struct FilmEncoder::Impl {
  fs::path file;
  AvCodecHandle codec;
  Mp4Writer out;
  AvFrameHandle frame;
  AvPacketHandle packet;
  AvScalerHandle to_yuv;
  std::int64_t count = 0;

  Impl(const fs::path& path, int width, int height, double fps)
      : file(path),
        codec(open_x264(path, width, height, fps)),
        out(path),
        frame(av_frame_of(width, height, codec->pix_fmt, not_writable(path))),
        packet(made(av_packet_alloc(), path)),
        to_yuv(av_scaler(width, height, AV_PIX_FMT_BGR24, codec->pix_fmt, not_writable(path))) {
    const int* bt709 = sws_getCoefficients(SWS_CS_ITU709);
    sws_setColorspaceDetails(to_yuv.get(), bt709, 1, bt709, 0, 0, 1 << 16, 1 << 16);
    AVStream& stream = out.stream();
    checked(avcodec_parameters_from_context(stream.codecpar, codec.get()), file);
    stream.time_base = codec->time_base;
    stream.avg_frame_rate = codec->framerate;
    out.begin();
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  /// Null: no frame follows.
  void encode(const AVFrame* next) {
    checked(avcodec_send_frame(codec.get(), next), file);
    while (true) {
      const int code = avcodec_receive_packet(codec.get(), packet.get());
      if (code == AVERROR(EAGAIN) || code == AVERROR_EOF) return;
      checked(code, file);
      packet->duration = 1;
      av_packet_rescale_ts(packet.get(), codec->time_base, out.stream().time_base);
      out.write(*packet);
    }
  }
};

FilmEncoder::FilmEncoder(const fs::path& file, int width, int height, double fps)
    : impl_(std::make_unique<Impl>(file, width, height, fps)) {}

FilmEncoder::~FilmEncoder() = default;

void FilmEncoder::add(const Image& image) {
  AVFrame& frame = *impl_->frame;
  checked(av_frame_make_writable(&frame), impl_->file);
  convert(*impl_->to_yuv, image, frame);
  frame.pts = impl_->count++;
  impl_->encode(&frame);
}

void FilmEncoder::finish() {
  impl_->encode(nullptr);
  impl_->out.finish();
}

void join_films(const std::vector<fs::path>& stretches, const fs::path& file, const std::string& comment) {
  Mp4Writer out(file);
  out.describe(comment);
  const AvPacketHandle packet(made(av_packet_alloc(), file));
  std::int64_t start = 0, last = INT64_MIN;  // of a stretch; of the packets so far: in the time base of the result
  for (const fs::path& stretch : stretches) {
    const AvInputHandle in = open_film(stretch);
    const AVStream& from = *in->streams[0];
    if (start == 0) {
      checked(avcodec_parameters_copy(out.stream().codecpar, from.codecpar), file);
      out.stream().time_base = from.time_base;
      out.stream().avg_frame_rate = from.avg_frame_rate;
      out.begin();
    }
    const std::int64_t shown = duration_of_frame(from, stretch);
    std::int64_t count = 0;
    for (; read_packet(*in, *packet, stretch); ++count) {
      packet->duration = shown;
      av_packet_rescale_ts(packet.get(), from.time_base, out.stream().time_base);
      packet->pts += start;
      packet->dts += start;
      packet->pos = -1;
      if (packet->dts <= last) throw DamagedFilm(not_readable(stretch) + ": expected frames in their order");
      last = packet->dts;
      out.write(*packet);
    }
    if (count != from.nb_frames) throw DamagedFilm(not_readable(stretch) + ": expected all of its frames");
    start += av_rescale_q(shown * from.nb_frames, from.time_base, out.stream().time_base);
  }
  out.finish();
}

}  // namespace grouser
