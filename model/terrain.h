#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "model/geometry.h"

namespace grouser {

/// One side of the vehicle's way, y > 0 left and y < 0 right in W, or both when empty.
using GroundSide = std::optional<Side>;
[[nodiscard]] inline bool covers(const GroundSide& part, Side side) { return !part || *part == side; }

[[nodiscard]] inline Side side_of(double y) { return y >= 0.0 ? Side::left : Side::right; }

/// Stretch of the way with a friction of its own.
struct FrictionZone {
  GroundSide side;
  double from = 0.0, to = 0.0;  ///< m along x in W, from < to
  double friction = 0.7;        ///< coefficient, link against ground
};

/// Height along x, each side its own; level beyond its ends. Both heights are of the same length as `distance`.
struct GroundProfile {
  std::vector<double> distance;                         ///< m along x in W, strictly increasing, at least 2
  std::array<std::vector<double>, k_num_sides> height;  ///< m
};

/// Random profile of ISO 8608:2016: one-sided displacement spectrum G_d(n) = G_d(n_0) (n / n_0)^-2, n_0 = 0.1 1/m,
/// with G_d(n_0) = 16, 64, 256, ... e-6 m^3 for class A, B, C, ... (geometric means).
struct RandomRoad {
  char road_class = 'C';   ///< A .. H
  std::uint64_t seed = 1;  ///< the same seed gives the same road on every machine
  double start = 0.0;      ///< m along x in W
  double length = 200.0;   ///< m, at least 20
};

/// Half a cylinder across the way, or a bank with straight ramps.
enum class ObstacleKind { half_round, trapezoid };
struct Obstacle {
  ObstacleKind kind = ObstacleKind::half_round;
  GroundSide side;
  double position = 0.0;         ///< m along x in W, of its middle
  double height = 0.0;           ///< m; the radius of a half round
  double base = 0.0, top = 0.0;  ///< m along x, of a trapezoid
};

/// Rigid ground: a plane through W's origin, with a profile, a random road and obstacles added to its height.
struct Terrain {
  double friction = 0.7;            ///< coefficient, link against ground, where no zone says otherwise
  std::vector<FrictionZone> zones;  ///< the last that holds a place counts there
  double slope = 0.0;               ///< rise over run along x; 0.3 is 30 % uphill
  double cross_slope = 0.0;         ///< rise over run along y; > 0: the left side stands higher
  double median = 1.0;              ///< m, width about y = 0 over which left passes into right
  std::optional<GroundProfile> profile;
  std::optional<RandomRoad> road;
  std::vector<Obstacle> obstacles;

  /// The plane z = 0 and nothing else (its friction may vary).
  [[nodiscard]] bool level() const {
    return slope == 0.0 && cross_slope == 0.0 && !profile && !road && obstacles.empty();
  }
};

/// The profile that a random road is, for two wheel tracks `tread` [m] apart.
///   h(x) = sum_i sqrt(2 G_d(n_i) dn) cos(2 pi n_i x + phi_i),   n_i from 0.011 to 2.83 1/m   (Shinozuka & Jan 1972,
///   J. Sound Vib. 25:111; the band over which ISO 8608 states the spectrum)
/// Left and right are as alike as on an isotropic surface: coherence k tread K_1(k tread), k = 2 pi n (Kamash & Robson
/// 1978, J. Sound Vib. 57:89, for the exponent 2). Faded in and out over 5 m at its ends, 0.05 m between points.
[[nodiscard]] GroundProfile random_profile(const RandomRoad& road, double tread);

/// G_d(n) [m^3] of a class at spatial frequency n [1/m].
[[nodiscard]] double road_spectrum(char road_class, double n);

}  // namespace grouser
