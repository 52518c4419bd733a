#pragma once
#include <vector>

#include "model/terrain.h"

namespace grouser {

/// Height of the ground and its slopes at one place.
struct GroundHeight {
  double z = 0.0;                       ///< m, W
  double slope_x = 0.0, slope_y = 0.0;  ///< dz/dx, dz/dy
};

/// Height over distance as a C1 piecewise cubic (Fritsch & Carlson 1980: no bump between points that they do not have),
/// level beyond its ends.
class ProfileCurve {
 public:
  ProfileCurve(std::vector<double> distance, std::vector<double> height);
  /// Value and slope at x, added to `z` and `slope`.
  void add(double x, double& z, double& slope) const;
  [[nodiscard]] const std::vector<double>& distance() const { return distance_; }

 private:
  std::vector<double> distance_, height_, slope_;
  double cells_per_metre_ = 0.0;
  std::vector<int> cell_interval_;  ///< first interval that may hold a place of the cell
};

/// Terrain made ready for looking up. The surface is z = slope x + cross_slope y + left and right courses (profile,
/// road, trapezoids), which pass into one another over the median, C1 everywhere; half rounds stand on it as bodies of
/// their own, for their sides are upright.
class GroundSurface {
 public:
  GroundSurface() = default;
  /// Two wheel tracks `tread` [m] apart, for the random road.
  GroundSurface(const Terrain& terrain, double tread);

  [[nodiscard]] bool level() const { return level_; }
  /// The C1 surface, without half rounds.
  [[nodiscard]] GroundHeight at(double x, double y) const;
  /// One coefficient of friction holds everywhere.
  [[nodiscard]] bool even_friction() const { return zones_.empty(); }
  /// Coefficient of friction at a place.
  [[nodiscard]] double friction(double x, double y) const { return zones_.empty() ? friction_ : zoned_friction(x, y); }
  /// Half a cylinder along y, its axis in the surface.
  struct HalfRound {
    double x = 0.0, radius = 0.0;   ///< m
    double z = 0.0, slope_y = 0.0;  ///< axis at y = 0 [m] and its rise over y
    GroundSide side;
  };
  [[nodiscard]] const std::vector<HalfRound>& half_rounds() const { return half_rounds_; }
  /// Height of the topmost ground, half rounds included.
  [[nodiscard]] double top(double x, double y) const;
  /// No ground within k_reach of (x, y), in x and y each, is higher than this.
  static constexpr double k_reach = 0.5;  ///< m
  [[nodiscard]] double highest_near(double x, double y) const;
  /// Begin and end along x [m] of all that stands on the plane; equal where nothing does.
  [[nodiscard]] std::array<double, 2> extent() const { return {begin_, end_}; }

 private:
  struct Bank {
    double position, half_base, ramp, slope;
    GroundSide side;
  };
  [[nodiscard]] double zoned_friction(double x, double y) const;
  void course(Side side, double x, double& z, double& slope) const;
  void tabulate_highest();

  bool level_ = true;
  double slope_ = 0.0, cross_slope_ = 0.0, half_median_ = 0.5, friction_ = 0.7;
  std::vector<FrictionZone> zones_;
  std::array<std::vector<ProfileCurve>, k_num_sides> curves_;
  std::vector<Bank> banks_;
  std::vector<HalfRound> half_rounds_;
  double begin_ = 0.0, end_ = 0.0;  ///< m, beyond which courses are level and bare
  std::vector<double> highest_;     ///< of both courses and half rounds about each cell, without the plane [m]
};

}  // namespace grouser
