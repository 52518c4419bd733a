#pragma once
#ifdef __AVX512DQ__
#include <immintrin.h>
#endif

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

/// Eight neighbouring links or joints worked on at once. Track arrays are padded so that a block may be loaded at any
/// link and at its successor without a test.
namespace grouser {

inline constexpr int k_lanes = 8;
inline constexpr unsigned k_all_lanes = 0xff;  ///< of bits_of(mask)

/// Eight doubles in the compiler's own vector type, which it keeps in registers; arrays of a linear algebra library are
/// aggregates that GCC 12 spills at every loop. Where AVX-512 has one instruction that the compiler does not find, it
/// is named.
class Lanes {
 public:
  using Values [[gnu::vector_size(k_lanes * sizeof(double))]] = double;

  Lanes() = default;
  Lanes(const Values& values) : values_(values) {}
  /// The same number in every lane.
  Lanes(double v) : values_{v, v, v, v, v, v, v, v} {}
  [[nodiscard]] const Values& values() const { return values_; }
  [[nodiscard]] double operator[](int lane) const { return values_[lane]; }
  void set(int lane, double value) { values_[lane] = value; }

  friend Lanes operator+(const Lanes& a, const Lanes& b) { return a.values_ + b.values_; }
  friend Lanes operator-(const Lanes& a, const Lanes& b) { return a.values_ - b.values_; }
  friend Lanes operator*(const Lanes& a, const Lanes& b) { return a.values_ * b.values_; }
  friend Lanes operator/(const Lanes& a, const Lanes& b) { return a.values_ / b.values_; }
  friend Lanes operator-(const Lanes& a) { return -a.values_; }
  Lanes& operator+=(const Lanes& b) { return values_ += b.values_, *this; }
  Lanes& operator-=(const Lanes& b) { return values_ -= b.values_, *this; }
  Lanes& operator*=(const Lanes& b) { return values_ *= b.values_, *this; }
  Lanes& operator/=(const Lanes& b) { return values_ /= b.values_, *this; }

  [[nodiscard]] Lanes square() const { return values_ * values_; }
  [[nodiscard]] Lanes inverse() const { return 1.0 / values_; }
#ifdef __AVX512DQ__
  [[nodiscard]] Lanes min(const Lanes& b) const { return Values(_mm512_min_pd(values_, b.values_)); }
  [[nodiscard]] Lanes max(const Lanes& b) const { return Values(_mm512_max_pd(values_, b.values_)); }
  [[nodiscard]] Lanes abs() const { return Values(_mm512_abs_pd(values_)); }
  [[nodiscard]] Lanes sqrt() const { return Values(_mm512_sqrt_pd(values_)); }
  /// To the nearest whole number, halves to the even one.
  [[nodiscard]] Lanes rint() const { return Values(_mm512_roundscale_pd(values_, _MM_FROUND_TO_NEAREST_INT)); }
  [[nodiscard]] Lanes floor() const { return Values(_mm512_roundscale_pd(values_, _MM_FROUND_TO_NEG_INF)); }
#else
  /// The second of both where one is no number, as processors do.
  [[nodiscard]] Lanes min(const Lanes& b) const { return values_ < b.values_ ? values_ : b.values_; }
  [[nodiscard]] Lanes max(const Lanes& b) const { return values_ > b.values_ ? values_ : b.values_; }
  [[nodiscard]] Lanes abs() const {
    return each([](double x) { return std::abs(x); });
  }
  [[nodiscard]] Lanes sqrt() const {
    return each([](double x) { return std::sqrt(x); });
  }
  /// To the nearest whole number, halves to the even one.
  [[nodiscard]] Lanes rint() const {
    return each([](double x) { return std::rint(x); });
  }
  [[nodiscard]] Lanes floor() const {
    return each([](double x) { return std::floor(x); });
  }
#endif
  /// Lane k plus lane k + 4.
  using Half [[gnu::vector_size(k_lanes / 2 * sizeof(double))]] = double;
  [[nodiscard]] Half sum_of_halves() const { return lower() + upper(); }
  [[nodiscard]] double sum() const {
    const Half four = sum_of_halves();
    return (four[0] + four[2]) + (four[1] + four[3]);
  }
  [[nodiscard]] double min_lane() const { return -(-*this).max_lane(); }
  [[nodiscard]] double max_lane() const {
    const Half a = lower(), b = upper(), four = a > b ? a : b;
    return std::max(std::max(four[0], four[1]), std::max(four[2], four[3]));
  }

 private:
  [[nodiscard]] Half lower() const { return __builtin_shufflevector(values_, values_, 0, 1, 2, 3); }
  [[nodiscard]] Half upper() const { return __builtin_shufflevector(values_, values_, 4, 5, 6, 7); }
  template <typename Function>
  [[nodiscard]] Lanes each(Function f) const {
    Lanes result;
    for (int lane = 0; lane < k_lanes; ++lane) result.values_[lane] = f(values_[lane]);
    return result;
  }
  Values values_;
};

/// Eight numbers at any place of an array.
[[nodiscard]] inline Lanes load(const double* from) {
  Lanes::Values values;
  std::memcpy(&values, from, sizeof(values));
  return values;
}
/// One number from each of eight places of an array.
[[nodiscard]] inline Lanes gather(const double* from, const std::array<int, k_lanes>& at) {
  return Lanes::Values{from[at[0]], from[at[1]], from[at[2]], from[at[3]],
                       from[at[4]], from[at[5]], from[at[6]], from[at[7]]};
}
inline void store(double* to, const Lanes& value) { std::memcpy(to, &value.values(), sizeof(Lanes)); }
inline void add_to(double* to, const Lanes& value) { store(to, load(to) + value); }
/// Four numbers, in both halves of the lanes: for what four links meet twice.
[[nodiscard]] inline Lanes load_twice(const double* from) {
#ifdef __AVX512DQ__
  return Lanes::Values(_mm512_broadcast_f64x4(_mm256_loadu_pd(from)));
#else
  return Lanes::Values{from[0], from[1], from[2], from[3], from[0], from[1], from[2], from[3]};
#endif
}
/// Adds both halves to four numbers.
inline void add_halves_to(double* to, const Lanes& value) {
  Lanes::Half four;
  std::memcpy(&four, to, sizeof(four));
  four += value.sum_of_halves();
  std::memcpy(to, &four, sizeof(four));
}

/// The lanes one place further: the last of `before`, then all of `now` but its last.
[[nodiscard]] inline Lanes one_behind(const Lanes& before, const Lanes& now) {
  return Lanes::Values(__builtin_shufflevector(before.values(), now.values(), 7, 8, 9, 10, 11, 12, 13, 14));
}

/// Yes or no for each of eight lanes.
class LaneMask {
 public:
#ifdef __AVX512DQ__
  using Bits = __mmask8;
#else
  using Bits [[gnu::vector_size(sizeof(Lanes))]] = std::int64_t;
#endif
  explicit LaneMask(const Bits& bits) : bits_(bits) {}
  /// Yes for the lanes from 0 to count - 1.
  [[nodiscard]] static LaneMask first(int count);
  /// Yes for the lanes whose bit is set.
  [[nodiscard]] static LaneMask of_bits(unsigned bits);
  [[nodiscard]] const Bits& bits() const { return bits_; }

 private:
  Bits bits_;
};

#ifdef __AVX512DQ__
inline LaneMask LaneMask::of_bits(unsigned bits) { return LaneMask(static_cast<Bits>(bits)); }
[[nodiscard]] inline LaneMask operator<(const Lanes& a, const Lanes& b) {
  return LaneMask(_mm512_cmp_pd_mask(a.values(), b.values(), _CMP_LT_OQ));
}
[[nodiscard]] inline LaneMask operator<=(const Lanes& a, const Lanes& b) {
  return LaneMask(_mm512_cmp_pd_mask(a.values(), b.values(), _CMP_LE_OQ));
}
[[nodiscard]] inline LaneMask operator&(const LaneMask& a, const LaneMask& b) {
  return LaneMask(_kand_mask8(a.bits(), b.bits()));
}
[[nodiscard]] inline LaneMask operator|(const LaneMask& a, const LaneMask& b) {
  return LaneMask(_kor_mask8(a.bits(), b.bits()));
}
[[nodiscard]] inline LaneMask operator!(const LaneMask& a) { return LaneMask(_knot_mask8(a.bits())); }
/// `yes` where the mask says so, else `no`.
[[nodiscard]] inline Lanes choose(const LaneMask& mask, const Lanes& yes, const Lanes& no) {
  return Lanes::Values(_mm512_mask_blend_pd(mask.bits(), no.values(), yes.values()));
}
/// Bit k of the result stands for lane k.
[[nodiscard]] inline unsigned bits_of(const LaneMask& mask) { return mask.bits(); }
#else
inline LaneMask LaneMask::of_bits(unsigned bits) {
  const Bits of_lane{1, 2, 4, 8, 16, 32, 64, 128};
  return LaneMask((of_lane & static_cast<std::int64_t>(bits)) == of_lane);
}
[[nodiscard]] inline LaneMask operator<(const Lanes& a, const Lanes& b) { return LaneMask(a.values() < b.values()); }
[[nodiscard]] inline LaneMask operator<=(const Lanes& a, const Lanes& b) { return LaneMask(a.values() <= b.values()); }
[[nodiscard]] inline LaneMask operator&(const LaneMask& a, const LaneMask& b) { return LaneMask(a.bits() & b.bits()); }
[[nodiscard]] inline LaneMask operator|(const LaneMask& a, const LaneMask& b) { return LaneMask(a.bits() | b.bits()); }
[[nodiscard]] inline LaneMask operator!(const LaneMask& a) { return LaneMask(~a.bits()); }
/// `yes` where the mask says so, else `no`.
[[nodiscard]] inline Lanes choose(const LaneMask& mask, const Lanes& yes, const Lanes& no) {
  return mask.bits() ? yes.values() : no.values();
}
/// Bit k of the result stands for lane k.
[[nodiscard]] inline unsigned bits_of(const LaneMask& mask) {
  const LaneMask::Bits set = mask.bits() & LaneMask::Bits{1, 2, 4, 8, 16, 32, 64, 128};
  std::int64_t sum = 0;
  for (int lane = 0; lane < k_lanes; ++lane) sum |= set[lane];
  return static_cast<unsigned>(sum);
}
#endif
[[nodiscard]] inline LaneMask operator>(const Lanes& a, const Lanes& b) { return b < a; }
[[nodiscard]] inline LaneMask operator>=(const Lanes& a, const Lanes& b) { return b <= a; }
inline LaneMask LaneMask::first(int count) {
  return Lanes(Lanes::Values{0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0}) < Lanes(count);
}

/// Begins where a line of the cache does, so that a block of eight numbers at a multiple of eight stands in one.
using AlignedNumbers = std::vector<double, Eigen::aligned_allocator<double>>;

/// Rows of numbers that are looked up at eight places at once. Column 0 rises and says where a row begins.
template <std::size_t columns>
class LaneTable {
 public:
  LaneTable() = default;
  explicit LaneTable(const std::vector<std::array<double, columns>>& rows)
      : length_(std::bit_ceil(std::max<std::size_t>(rows.size(), k_lanes))), values_(columns * length_, 0.0) {
    std::fill_n(values_.begin(), length_, std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      for (std::size_t c = 0; c < columns; ++c) values_[c * length_ + i] = rows[i][c];
    }
  }
  /// The rows that x stand in; the first one holds below its beginning, too.
  [[nodiscard]] std::array<Lanes, columns> at(const Lanes& x) const {
    return length_ == k_lanes       ? at<k_lanes>(x, k_lanes)
           : length_ == 2 * k_lanes ? at<2 * k_lanes>(x, 2 * k_lanes)
                                    : at<0>(x, length_);
  }

 private:
  using Places [[gnu::vector_size(sizeof(Lanes))]] = std::int64_t;
  /// `at` for a table whose length is known when this is compiled, or not (0).
  template <std::size_t known>
  [[nodiscard]] std::array<Lanes, columns> at(const Lanes& x, std::size_t length) const {
    const std::size_t n = known > 0 ? known : length;
    // Bisection. The first two looks go to one place and to one of two, which need no permutation.
    const auto half_way = static_cast<std::int64_t>(n / 2), quarter = static_cast<std::int64_t>(n / 4);
    const LaneMask second_half = Lanes(values_.data()[n / 2]) <= x;
    const LaneMask second_quarter =
        grouser::choose(second_half, values_.data()[n / 2 + n / 4], values_.data()[n / 4]) <= x;
    Places place = choose(second_half, Places{} + half_way, Places{});
    place = choose(second_quarter, place + quarter, place);
    for (auto half = quarter / 2; half > 0; half /= 2) {
      const Places further = place + half;
      place = choose(look_up(0, n, further) <= x, further, place);
    }
    std::array<Lanes, columns> row;
    for (std::size_t c = 0; c < columns; ++c) row[c] = look_up(c, n, place);
    return row;
  }
#ifdef __AVX512DQ__
  [[nodiscard]] static Places choose(const LaneMask& mask, const Places& yes, const Places& no) {
    return Places(_mm512_mask_blend_epi64(mask.bits(), __m512i(no), __m512i(yes)));
  }
  [[nodiscard]] Lanes look_up(std::size_t column, std::size_t length, const Places& place) const {
    const double* from = values_.data() + column * length;
    if (length == k_lanes) return Lanes::Values(_mm512_permutexvar_pd(__m512i(place), load(from).values()));
    const auto among_sixteen = [&](const double* at) {
      return Lanes::Values(_mm512_permutex2var_pd(load(at).values(), __m512i(place), load(at + k_lanes).values()));
    };
    Lanes found = among_sixteen(from);
    for (std::size_t first = 2 * k_lanes; first < length; first += 2 * k_lanes) {
      const auto reached = place >= static_cast<std::int64_t>(first);
      found = Lanes::Values(reached ? among_sixteen(from + first) : found.values());
    }
    return found;
  }
#else
  [[nodiscard]] static Places choose(const LaneMask& mask, const Places& yes, const Places& no) {
    return mask.bits() ? yes : no;
  }
  [[nodiscard]] Lanes look_up(std::size_t column, std::size_t length, const Places& place) const {
    const double* from = values_.data() + column * length;
    Lanes found;
    for (int lane = 0; lane < k_lanes; ++lane) found.set(lane, from[place[lane]]);
    return found;
  }
#endif
  std::size_t length_ = 0;  ///< of a column
  AlignedNumbers values_;
};

/// Three-vectors of eight links.
struct Lanes3 {
  Lanes x, y, z;
};
[[nodiscard]] inline Lanes3 operator+(const Lanes3& a, const Lanes3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
[[nodiscard]] inline Lanes3 operator-(const Lanes3& a, const Lanes3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
[[nodiscard]] inline Lanes3 operator-(const Lanes3& a) { return {-a.x, -a.y, -a.z}; }
template <typename Scale>
[[nodiscard]] inline Lanes3 operator*(const Scale& s, const Lanes3& a) {
  return {s * a.x, s * a.y, s * a.z};
}
[[nodiscard]] inline Lanes dot(const Lanes3& a, const Lanes3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
[[nodiscard]] inline Lanes3 cross(const Lanes3& a, const Lanes3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

[[nodiscard]] inline Lanes3 choose(const LaneMask& mask, const Lanes3& yes, const Lanes3& no) {
  return {choose(mask, yes.x, no.x), choose(mask, yes.y, no.y), choose(mask, yes.z, no.z)};
}
/// The same vector in every lane.
[[nodiscard]] inline Lanes3 in_all_lanes(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
[[nodiscard]] inline Eigen::Vector3d sum_of_lanes(const Lanes3& v) { return {v.x.sum(), v.y.sum(), v.z.sum()}; }

/// `components` arrays of equal padded length, one after the other: component c of element i stands at data[c * length
/// + i].
class Field {
 public:
  using Values = AlignedNumbers;
  Field() = default;
  Field(int components, int length)
      : components_(components), length_(length), data_(static_cast<std::size_t>(components) * length, 0.0) {}
  [[nodiscard]] double* operator[](int component) {
    return data_.data() + static_cast<std::size_t>(component) * length_;
  }
  [[nodiscard]] const double* operator[](int component) const {
    return data_.data() + static_cast<std::size_t>(component) * length_;
  }
  [[nodiscard]] int length() const { return length_; }
  [[nodiscard]] int components() const { return components_; }
  [[nodiscard]] Values& data() { return data_; }
  [[nodiscard]] const Values& data() const { return data_; }
  void fill(double value);  // in state.cpp

 private:
  int components_ = 0, length_ = 0;
  Values data_;
};

[[nodiscard]] inline Lanes3 load3(const Field& field, int first, int i) {
  return {load(field[first] + i), load(field[first + 1] + i), load(field[first + 2] + i)};
}
[[nodiscard]] inline Lanes3 load3(const Field& field, int i) { return load3(field, 0, i); }
inline void store3(Field& field, int i, const Lanes3& value) {
  store(field[0] + i, value.x);
  store(field[1] + i, value.y);
  store(field[2] + i, value.z);
}

inline void add_to3(Field& field, int i, const Lanes3& value) {
  add_to(field[0] + i, value.x);
  add_to(field[1] + i, value.y);
  add_to(field[2] + i, value.z);
}

}  // namespace grouser
