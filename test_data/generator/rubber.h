#pragma once
#include <cstdint>
#include <vector>

#include "model/bushing.h"

namespace grouser {

/// Random numbers that are the same on every platform: the standard's distributions are not.
class PortableRandom {
 public:
  explicit PortableRandom(std::uint64_t seed) : state_(seed) {}
  [[nodiscard]] double uniform();  ///< in (0, 1)
  [[nodiscard]] double normal();   ///< mean 0, deviation 1

 private:
  std::uint64_t state_;
};

/// One axis of synthetic rubber, on purpose richer than the law that is fitted to it:
///   F = k1 x + k3 x^3 + eight stops + six Maxwell branches + a fractional element (springpot) C d^a x / dt^a.
/// SI (N, m, s or N m, rad, s).
struct TrueRubber {
  double k1 = 0.0, k3 = 0.0;  ///< monotone stiffening spring, N/m and N/m^3
  std::vector<FrictionStop> stops;
  std::vector<MaxwellBranch> branches;
  double springpot = 0.0;        ///< C, N s^a / m; 0: the rubber has none
  double springpot_order = 0.0;  ///< a, 0..1
  double yield_growth = 0.0;     ///< b, 1/m^2: every stop slips at yield (1 + b x^2)
  double clearance = 0.0;        ///< play of the joint: the spring k1, k3 starts at |x| = clearance, m or rad
  /// Beyond |x| = hard_stop an extra stiffness, N/m or N m/rad, which rubber rounds over hard_stop_width; 0: there is
  /// none.
  double hard_stop = 0.0, hard_stop_width = 0.0, hard_stop_stiffness = 0.0;

  /// The springpot as a Prony series (eight branches a decade over 1e-5..1e4 s): its power-law relaxation C t^-a /
  /// Gamma(1-a) is a continuous spectrum of Maxwell branches, cut where no test of the campaign can see.
  [[nodiscard]] std::vector<MaxwellBranch> springpot_series() const;
  [[nodiscard]] double elastic(double x) const;
};

/// The rubber's shape at unit size, scaled to `stiffness` (N/m at about half stroke) and `stroke` (m, where stiffening
/// shows); places and sizes of all elements scatter by 10 % with the seed, so no axis shares a grid with another.
[[nodiscard]] TrueRubber make_rubber(double stiffness, double stroke, std::uint64_t seed);

/// Force history of the rubber, from rest.
class RubberState {
 public:
  explicit RubberState(const TrueRubber& rubber);
  /// Moves to displacement x in time h at constant rate; returns the force.
  double advance(double x, double h);

 private:
  TrueRubber rubber_;
  std::vector<MaxwellBranch> branches_;  ///< those of the rubber and the springpot's
  std::vector<double> deflection_, branch_force_, decay_, gain_;
  double x_ = 0.0, step_ = -1.0;
};

}  // namespace grouser
