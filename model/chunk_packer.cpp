#include "model/chunk_packer.h"

#include <algorithm>
#include <bit>
#include <new>
#include <stdexcept>

namespace grouser {
namespace {

static_assert(std::endian::native == std::endian::little, "datasets are declared little-endian");

/// Byte b of every number together: HDF5's filter "shuffle".
template <std::size_t number_size>
void shuffle(std::span<const unsigned char> bytes, std::vector<unsigned char>& shuffled) {
  const std::size_t count = bytes.size() / number_size;
  shuffled.resize(bytes.size());
  for (std::size_t b = 0; b < number_size; ++b) {
    unsigned char* to = shuffled.data() + b * count;
    for (std::size_t i = 0; i < count; ++i) to[i] = bytes[number_size * i + b];
  }
}

}  // namespace

ChunkPacker::ChunkPacker() {
  constexpr int k_fastest = 1, k_zlib_head = 15, k_most_memory = 9;
  if (deflateInit2(&stream_, k_fastest, Z_DEFLATED, k_zlib_head, k_most_memory, Z_RLE) != Z_OK) throw std::bad_alloc();
}

ChunkPacker::~ChunkPacker() { deflateEnd(&stream_); }

std::span<const unsigned char> ChunkPacker::pack(const Channel& channel, std::size_t chunk_rows,
                                                 std::span<const double> rows, std::size_t row_size,
                                                 std::size_t first) {
  if (!channel.single_precision) {
    const auto bytes = take_columns(doubles_, chunk_rows, rows, row_size, first, channel.size());
    if (!channel.deflated) return bytes;
    shuffle<sizeof(double)>(bytes, shuffled_);
  } else {
    const auto bytes = take_columns(singles_, chunk_rows, rows, row_size, first, channel.size());
    if (!channel.deflated) return bytes;
    shuffle<sizeof(float)>(bytes, shuffled_);
  }
  return deflated(shuffled_);
}

template <typename Number>
std::span<const unsigned char> ChunkPacker::take_columns(std::vector<Number>& chunk, std::size_t chunk_rows,
                                                         std::span<const double> rows, std::size_t row_size,
                                                         std::size_t first, std::size_t width) {
  chunk.resize(chunk_rows * width);
  const std::size_t count = rows.size() / row_size;
  for (std::size_t r = 0; r < count; ++r) {
    const double* from = rows.data() + r * row_size + first;
    std::transform(from, from + width, chunk.data() + r * width, [](double x) { return static_cast<Number>(x); });
  }
  std::fill(chunk.begin() + static_cast<std::ptrdiff_t>(count * width), chunk.end(), Number{0});
  return {reinterpret_cast<const unsigned char*>(chunk.data()), chunk.size() * sizeof(Number)};
}

std::span<const unsigned char> ChunkPacker::deflated(std::span<const unsigned char> bytes) {
  deflateReset(&stream_);
  deflated_.resize(deflateBound(&stream_, bytes.size()));
  stream_.next_in = const_cast<unsigned char*>(bytes.data());  // zlib only reads
  stream_.avail_in = static_cast<uInt>(bytes.size());
  stream_.next_out = deflated_.data();
  stream_.avail_out = static_cast<uInt>(deflated_.size());
  if (deflate(&stream_, Z_FINISH) != Z_STREAM_END) throw std::logic_error("deflateBound promised too little");
  return {deflated_.data(), stream_.total_out};
}

}  // namespace grouser
