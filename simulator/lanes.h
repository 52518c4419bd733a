#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

/// Eight neighbouring links or joints worked on at once. Track arrays are padded so that a block may be loaded at any
/// link and at its successor without a test.
namespace grouser {

inline constexpr int k_lanes = 8;
using Lanes = Eigen::Array<double, k_lanes, 1>;

[[nodiscard]] inline Lanes load(const double* from) { return Eigen::Map<const Lanes>(from); }
inline void store(double* to, const Lanes& value) { Eigen::Map<Lanes>{to} = value; }
inline void add_to(double* to, const Lanes& value) { Eigen::Map<Lanes>{to} += value; }

/// Yes or no for each of eight lanes: all bits of a lane set or none. Compared and chosen by the compiler's own
/// vectors, for Eigen 3.4 takes such arrays apart lane by lane.
class LaneMask {
 public:
  /// Yes for the lanes from 0 to count - 1.
  [[nodiscard]] static LaneMask first(int count) {
    return LaneMask(Bits{0, 1, 2, 3, 4, 5, 6, 7} < Bits{} + static_cast<std::int64_t>(count));
  }
  [[nodiscard]] static LaneMask less(const Lanes& a, const Lanes& b) { return LaneMask(values(a) < values(b)); }
  [[nodiscard]] static LaneMask less_equal(const Lanes& a, const Lanes& b) { return LaneMask(values(a) <= values(b)); }
  friend LaneMask operator&(const LaneMask& a, const LaneMask& b) { return LaneMask(a.bits() & b.bits()); }
  friend LaneMask operator|(const LaneMask& a, const LaneMask& b) { return LaneMask(a.bits() | b.bits()); }
  friend LaneMask operator!(const LaneMask& a) { return LaneMask(~a.bits()); }
  /// `yes` where the mask says so, else `no`.
  friend Lanes choose(const LaneMask& mask, const Lanes& yes, const Lanes& no) {
    const Values chosen = mask.bits() ? values(yes) : values(no);
    Lanes result;
    std::memcpy(result.data(), &chosen, sizeof(Lanes));
    return result;
  }
  /// Bit k of the result stands for lane k.
  friend unsigned bits_of(const LaneMask& mask) {
    const Bits set = mask.bits() & Bits{1, 2, 4, 8, 16, 32, 64, 128};
    std::int64_t sum = 0;
    for (int lane = 0; lane < k_lanes; ++lane) sum |= set[lane];
    return static_cast<unsigned>(sum);
  }

 private:
  using Values [[gnu::vector_size(sizeof(Lanes))]] = double;
  using Bits [[gnu::vector_size(sizeof(Lanes))]] = std::int64_t;
  explicit LaneMask(const Bits& bits) { std::memcpy(lane_.data(), &bits, sizeof(Lanes)); }
  [[nodiscard]] static Values values(const Lanes& x) {
    Values result;
    std::memcpy(&result, x.data(), sizeof(Lanes));
    return result;
  }
  [[nodiscard]] Bits bits() const {
    Bits result;
    std::memcpy(&result, lane_.data(), sizeof(Lanes));
    return result;
  }
  alignas(Lanes) std::array<std::int64_t, k_lanes> lane_;
};

[[nodiscard]] inline LaneMask less(const Lanes& a, const Lanes& b) { return LaneMask::less(a, b); }
[[nodiscard]] inline LaneMask less_equal(const Lanes& a, const Lanes& b) { return LaneMask::less_equal(a, b); }

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
[[nodiscard]] inline Lanes3 in_all_lanes(const Eigen::Vector3d& v) {
  return {Lanes::Constant(v.x()), Lanes::Constant(v.y()), Lanes::Constant(v.z())};
}
[[nodiscard]] inline Eigen::Vector3d sum_of_lanes(const Lanes3& v) { return {v.x.sum(), v.y.sum(), v.z.sum()}; }

/// `components` arrays of equal padded length, one after the other: component c of element i stands at data[c * length
/// + i].
class Field {
 public:
  Field() = default;
  Field(int components, int length) : length_(length), data_(static_cast<std::size_t>(components) * length, 0.0) {}
  [[nodiscard]] double* operator[](int component) {
    return data_.data() + static_cast<std::size_t>(component) * length_;
  }
  [[nodiscard]] const double* operator[](int component) const {
    return data_.data() + static_cast<std::size_t>(component) * length_;
  }
  [[nodiscard]] int length() const { return length_; }
  [[nodiscard]] int components() const { return length_ == 0 ? 0 : static_cast<int>(data_.size()) / length_; }
  [[nodiscard]] std::vector<double>& data() { return data_; }
  [[nodiscard]] const std::vector<double>& data() const { return data_; }
  void fill(double value) { std::fill(data_.begin(), data_.end(), value); }

 private:
  int length_ = 0;
  std::vector<double> data_;
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
