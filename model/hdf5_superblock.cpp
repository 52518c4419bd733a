#include "model/hdf5_superblock.h"

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <fstream>

#include "model/errors.h"

namespace grouser {
namespace {

constexpr std::size_t k_size = 48, k_flags_at = 11, k_end_of_file_at = 28, k_checksum_at = 44;
using Superblock = std::array<char, k_size>;

/// Jenkins' lookup3 (public domain, 2006) of whole 32-bit words: the checksum of HDF5's metadata.
std::uint32_t lookup3(const std::uint32_t* word, std::size_t count) {
  std::uint32_t a = 0xdeadbeefU + static_cast<std::uint32_t>(4 * count), b = a, c = a;
  for (; count > 3; count -= 3, word += 3) {
    a += word[0], b += word[1], c += word[2];
    a -= c, a ^= std::rotl(c, 4), c += b;
    b -= a, b ^= std::rotl(a, 6), a += c;
    c -= b, c ^= std::rotl(b, 8), b += a;
    a -= c, a ^= std::rotl(c, 16), c += b;
    b -= a, b ^= std::rotl(a, 19), a += c;
    c -= b, c ^= std::rotl(b, 4), b += a;
  }
  if (count > 2) c += word[2];
  if (count > 1) b += word[1];
  if (count > 0) a += word[0];
  c ^= b, c -= std::rotl(b, 14);
  a ^= c, a -= std::rotl(c, 11);
  b ^= a, b -= std::rotl(a, 25);
  c ^= b, c -= std::rotl(b, 16);
  a ^= c, a -= std::rotl(c, 4);
  b ^= a, b -= std::rotl(a, 14);
  c ^= b, c -= std::rotl(b, 24);
  return c;
}

std::uint32_t checksum_of(const Superblock& block) {
  std::array<std::uint32_t, k_checksum_at / 4> words{};
  std::memcpy(words.data(), block.data(), k_checksum_at);
  return lookup3(words.data(), words.size());
}

}  // namespace

void make_superblock_readable(const std::filesystem::path& file) {
  std::fstream stream(file, std::ios::binary | std::ios::in | std::ios::out);
  Superblock block{};
  stream.read(block.data(), k_size);
  std::uint32_t stored = 0;
  std::memcpy(&stored, block.data() + k_checksum_at, 4);
  // Anything but the superblock we know is left alone: the single-writer mode can still read it.
  if (!stream || block[8] != 3 || stored != checksum_of(block)) return;
  const std::uint64_t length = std::filesystem::file_size(file);
  block[k_flags_at] = 0;
  std::memcpy(block.data() + k_end_of_file_at, &length, 8);
  const std::uint32_t checksum = checksum_of(block);
  std::memcpy(block.data() + k_checksum_at, &checksum, 4);
  stream.seekp(0).write(block.data(), k_size).flush();
  if (!stream) throw FileError("cannot write " + file.string());
}

}  // namespace grouser
