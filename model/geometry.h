#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>

/// Vectors and poses in monogram notation: X_WB is the pose of B in W, p_AB_W the vector from A to B expressed in W.
namespace grouser {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

inline constexpr double k_pi = 3.14159265358979323846;
inline constexpr double k_standard_gravity = 9.80665;  ///< m/s^2 (CGPM 1901)

enum class Side { left, right };
inline constexpr int k_num_sides = 2;
[[nodiscard]] inline const char* name_of(Side side) { return side == Side::left ? "left" : "right"; }
[[nodiscard]] inline int index_of(Side side) { return side == Side::left ? 0 : 1; }

/// Cross-product matrix: skew(a) * b == a.cross(b).
[[nodiscard]] inline Matrix3d skew(const Vector3d& a) {
  Matrix3d m;
  m << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return m;
}

/// Unit quaternion of the rotation vector `angle` [rad].
[[nodiscard]] inline Quaterniond quaternion_exp(const Vector3d& angle) {
  const double magnitude = angle.norm();
  if (magnitude < 1e-10) return Quaterniond(1.0, 0.5 * angle.x(), 0.5 * angle.y(), 0.5 * angle.z());
  const double s = std::sin(0.5 * magnitude) / magnitude;
  return Quaterniond(std::cos(0.5 * magnitude), s * angle.x(), s * angle.y(), s * angle.z());
}

}  // namespace grouser
