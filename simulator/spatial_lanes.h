#pragma once
#include <array>
#include <cstdint>

#include "simulator/lanes.h"

/// Matrices and spatial vectors of eight bodies.
namespace grouser {

using Vector6d = Eigen::Matrix<double, 6, 1>;

/// 3 x 3 matrices by their columns.
struct LaneMatrix {
  Lanes3 x, y, z;
};
[[nodiscard]] inline Lanes3 operator*(const LaneMatrix& m, const Lanes3& v) {
  return v.x * m.x + v.y * m.y + v.z * m.z;
}
[[nodiscard]] inline Lanes3 transposed_times(const LaneMatrix& m, const Lanes3& v) {
  return {dot(m.x, v), dot(m.y, v), dot(m.z, v)};
}
inline void operator+=(LaneMatrix& a, const LaneMatrix& b) {
  a.x = a.x + b.x;
  a.y = a.y + b.y;
  a.z = a.z + b.z;
}
/// m - a b^T
[[nodiscard]] inline LaneMatrix less_product(const LaneMatrix& m, const Lanes3& a, const Lanes3& b) {
  return {m.x - b.x * a, m.y - b.y * a, m.z - b.z * a};
}

/// Symmetric 3 x 3 matrices: xx, yy, zz and, beside the diagonal, yz, xz, xy.
struct LaneTensor {
  Lanes3 diagonal, beside;
};
[[nodiscard]] inline Lanes3 operator*(const LaneTensor& t, const Lanes3& v) {
  const auto& [d, b] = t;
  return {d.x * v.x + b.z * v.y + b.y * v.z, b.z * v.x + d.y * v.y + b.x * v.z, b.y * v.x + b.x * v.y + d.z * v.z};
}
inline void operator+=(LaneTensor& a, const LaneTensor& b) {
  a.diagonal = a.diagonal + b.diagonal;
  a.beside = a.beside + b.beside;
}
/// t - a b^T, for a parallel to b
[[nodiscard]] inline LaneTensor less_product(const LaneTensor& t, const Lanes3& a, const Lanes3& b) {
  return {t.diagonal - Lanes3{a.x * b.x, a.y * b.y, a.z * b.z}, t.beside - Lanes3{a.y * b.z, a.x * b.z, a.x * b.y}};
}
/// R t R^T
[[nodiscard]] inline LaneTensor turned(const LaneMatrix& R, const LaneTensor& t) {
  const auto& [d, b] = t;
  const Lanes3 x = R * Lanes3{d.x, b.z, b.y}, y = R * Lanes3{b.z, d.y, b.x}, z = R * Lanes3{b.y, b.x, d.z};
  return {{x.x * R.x.x + y.x * R.y.x + z.x * R.z.x, x.y * R.x.y + y.y * R.y.y + z.y * R.z.y,
           x.z * R.x.z + y.z * R.y.z + z.z * R.z.z},
          {x.y * R.x.z + y.y * R.y.z + z.y * R.z.z, x.x * R.x.z + y.x * R.y.z + z.x * R.z.z,
           x.x * R.x.y + y.x * R.y.y + z.x * R.z.y}};
}

/// Spatial vectors: motions (angular; linear) or forces (moment; force).
struct LaneSpatial {
  Lanes3 angular, linear;
};
[[nodiscard]] inline LaneSpatial operator+(const LaneSpatial& a, const LaneSpatial& b) {
  return {a.angular + b.angular, a.linear + b.linear};
}
[[nodiscard]] inline LaneSpatial operator-(const LaneSpatial& a, const LaneSpatial& b) {
  return {a.angular - b.angular, a.linear - b.linear};
}
[[nodiscard]] inline LaneSpatial operator*(const Lanes& s, const LaneSpatial& a) {
  return {s * a.angular, s * a.linear};
}
[[nodiscard]] inline Lanes dot(const LaneSpatial& a, const LaneSpatial& b) {
  return dot(a.angular, b.angular) + dot(a.linear, b.linear);
}
/// v x m of motions
[[nodiscard]] inline LaneSpatial cross_motion(const LaneSpatial& v, const LaneSpatial& m) {
  return {cross(v.angular, m.angular), cross(v.linear, m.angular) + cross(v.angular, m.linear)};
}
/// v x* f of a motion and a force
[[nodiscard]] inline LaneSpatial cross_force(const LaneSpatial& v, const LaneSpatial& f) {
  return {cross(v.angular, f.angular) + cross(v.linear, f.linear), cross(v.angular, f.linear)};
}

/// Symmetric spatial matrices [rotation, coupling; coupling^T, translation] from motion to force.
struct LaneInertia {
  LaneTensor rotation;
  LaneMatrix coupling;
  LaneTensor translation;
};
[[nodiscard]] inline LaneSpatial operator*(const LaneInertia& I, const LaneSpatial& v) {
  return {I.rotation * v.angular + I.coupling * v.linear,
          transposed_times(I.coupling, v.angular) + I.translation * v.linear};
}
/// In place: a compiler copies such large values through memory.
inline void operator+=(LaneInertia& a, const LaneInertia& b) {
  a.rotation += b.rotation;
  a.coupling += b.coupling;
  a.translation += b.translation;
}
/// I - a b^T, for a parallel to b
[[nodiscard]] inline LaneInertia less_product(const LaneInertia& I, const LaneSpatial& a, const LaneSpatial& b) {
  return {less_product(I.rotation, a.angular, b.angular), less_product(I.coupling, a.angular, b.linear),
          less_product(I.translation, a.linear, b.linear)};
}

[[nodiscard]] inline Eigen::Vector3d in_lane(int lane, const Lanes3& v) { return {v.x[lane], v.y[lane], v.z[lane]}; }
/// One lane's vector in all lanes. Read number by number: a vector put together in memory to be broadcast from there
/// would have to wait for its own stores.
[[nodiscard]] inline Lanes3 spread(int lane, const Lanes3& v) { return {v.x[lane], v.y[lane], v.z[lane]}; }
inline void set_lane(int lane, const Eigen::Vector3d& from, Lanes3& v) {
  v.x.set(lane, from.x());
  v.y.set(lane, from.y());
  v.z.set(lane, from.z());
}
/// Adds the sums over `from`'s lanes to one lane.
inline void add_sums_in_lane(int lane, const Lanes3& from, Lanes3& v) {
  v.x.set(lane, v.x[lane] + from.x.sum());
  v.y.set(lane, v.y[lane] + from.y.sum());
  v.z.set(lane, v.z[lane] + from.z.sum());
}
[[nodiscard]] inline Vector6d in_lane(int lane, const LaneSpatial& v) {
  Vector6d result;
  result << in_lane(lane, v.angular), in_lane(lane, v.linear);
  return result;
}
/// The sums of eight numbers' lanes at once: that of v[k] in lane k. Halves the count of vectors three times.
[[nodiscard]] inline Lanes sums_of_lanes(const std::array<Lanes, k_lanes>& v) {
  using Places [[gnu::vector_size(sizeof(Lanes))]] = std::int64_t;
  const auto fold = [](const Lanes& a, const Lanes& b, const Places& first, const Places& second) -> Lanes {
    return __builtin_shuffle(a.values(), b.values(), first) + __builtin_shuffle(a.values(), b.values(), second);
  };
  std::array<Lanes, 4> pairs;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    pairs[k] = fold(v[2 * k], v[2 * k + 1], Places{0, 8, 2, 10, 4, 12, 6, 14}, Places{1, 9, 3, 11, 5, 13, 7, 15});
  }
  std::array<Lanes, 2> fours;
  for (std::size_t k = 0; k < fours.size(); ++k) {
    fours[k] =
        fold(pairs[2 * k], pairs[2 * k + 1], Places{0, 1, 8, 9, 4, 5, 12, 13}, Places{2, 3, 10, 11, 6, 7, 14, 15});
  }
  return fold(fours[0], fours[1], Places{0, 1, 2, 3, 8, 9, 10, 11}, Places{4, 5, 6, 7, 12, 13, 14, 15});
}

}  // namespace grouser
