#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <vector>

/// Eight neighbouring links or joints worked on at once. Track arrays are padded so that a block may be loaded at any
/// link and at its successor without a test.
namespace grouser {

inline constexpr int k_lanes = 8;
using Lanes = Eigen::Array<double, k_lanes, 1>;

[[nodiscard]] inline Lanes load(const double* from) { return Eigen::Map<const Lanes>(from); }
inline void store(double* to, const Lanes& value) { Eigen::Map<Lanes>{to} = value; }
inline void add_to(double* to, const Lanes& value) { Eigen::Map<Lanes>{to} += value; }

/// Three-vectors of eight links.
struct Lanes3 {
  Lanes x, y, z;
};
[[nodiscard]] inline Lanes3 operator+(const Lanes3& a, const Lanes3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
[[nodiscard]] inline Lanes3 operator-(const Lanes3& a, const Lanes3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
template <typename Scale>
[[nodiscard]] inline Lanes3 operator*(const Scale& s, const Lanes3& a) {
  return {s * a.x, s * a.y, s * a.z};
}
[[nodiscard]] inline Lanes dot(const Lanes3& a, const Lanes3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
[[nodiscard]] inline Lanes3 cross(const Lanes3& a, const Lanes3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

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

}  // namespace grouser
