#include "identification/joint_limits.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace grouser {
namespace {

constexpr double k_better_than_cubic = 0.5;  // rms error of the pieces over that of a cubic
constexpr double k_stiffness_ratio = 4.0;
constexpr double k_corner = 0.1;        // of the range: a shorter piece in the middle is a corner that rubber rounds
constexpr double k_least_ratio = 1e-3;  // soft over stiff: an infinity is no ratio
constexpr Eigen::Index k_fewest_stations = 8;
constexpr int k_finer = 8;  // breaks are searched at the stations, then so much finer

struct Curve {
  Eigen::VectorXd x, force;
};

struct Pieces {
  double first = 0.0, second = 0.0;  // breaks
  Eigen::Vector3d slope = Eigen::Vector3d::Zero();
  double squared_error = -1.0;
};

double squared_error(const Eigen::MatrixXd& columns, const Eigen::VectorXd& force, Eigen::VectorXd& coefficients) {
  coefficients = columns.colPivHouseholderQr().solve(force);
  return (force - columns * coefficients).squaredNorm();
}

void try_breaks(const Curve& curve, double first, double second, Pieces& best) {
  Eigen::MatrixXd columns(curve.x.size(), 4);  // continuous: a ramp more at every break
  columns << Eigen::VectorXd::Ones(curve.x.size()), curve.x, (curve.x.array() - first).cwiseMax(0.0).matrix(),
      (curve.x.array() - second).cwiseMax(0.0).matrix();
  Eigen::VectorXd c;
  const double error = squared_error(columns, curve.force, c);
  if (best.squared_error >= 0.0 && error >= best.squared_error) return;
  best = {first, second, {c(1), c(1) + c(2), c(1) + c(2) + c(3)}, error};
}

Pieces three_pieces(const Curve& curve) {
  const Eigen::Index n = curve.x.size();
  const double spacing = curve.x(1) - curve.x(0);
  Pieces best;
  for (Eigen::Index i = 1; i + 2 < n; ++i) {
    for (Eigen::Index j = i + 1; j + 1 < n; ++j) try_breaks(curve, curve.x(i), curve.x(j), best);
  }
  const Pieces coarse = best;
  for (int i = -k_finer; i <= k_finer; ++i) {
    for (int j = -k_finer; j <= k_finer; ++j) {
      const double first = coarse.first + spacing * i / k_finer, second = coarse.second + spacing * j / k_finer;
      const bool apart = first > curve.x(0) && second < curve.x(n - 1) && second - first > 0.5 * spacing;
      if (apart) try_breaks(curve, first, second, best);
    }
  }
  return best;
}

double cubic_error(const Curve& curve) {
  const Eigen::ArrayXd u = (curve.x.array() - curve.x.mean()) / (curve.x(curve.x.size() - 1) - curve.x(0));
  Eigen::MatrixXd columns(curve.x.size(), 4);
  columns << Eigen::VectorXd::Ones(curve.x.size()), u.matrix(), u.square().matrix(), u.cube().matrix();
  Eigen::VectorXd c;
  return squared_error(columns, curve.force, c);
}

struct Limits {
  std::optional<Clearance> clearance;
  std::vector<HardStop> stops;
};

// A stop where two neighbouring pieces differ enough.
void add_stop(Limits& limits, double at, double one, double other) {
  const double soft = std::min(one, other), stiff = std::max(one, other);
  if (stiff <= k_stiffness_ratio * soft) return;
  limits.stops.push_back({at, stiff / std::max(soft, k_least_ratio * stiff)});
}

// Without one the slope between two breaks is anybody's: all pairs about a sharp corner fit alike.
bool has_station_between(const Curve& curve, double low, double high) {
  const double least = 1e-6 * (curve.x(1) - curve.x(0));
  return ((curve.x.array() > low + least) && (curve.x.array() < high - least)).any();
}

// What the strongest two breaks of the curve say.
Limits strongest(const Curve& curve) {
  Limits limits;
  const Eigen::Index n = curve.x.size();
  if (n < k_fewest_stations) return limits;
  const Pieces pieces = three_pieces(curve);
  if (!(pieces.squared_error < k_better_than_cubic * k_better_than_cubic * cubic_error(curve))) return limits;

  const double before = pieces.slope(0), inside = pieces.slope(1), after = pieces.slope(2);
  const double range = curve.x(n - 1) - curve.x(0), width = pieces.second - pieces.first;
  const bool rounded = width < k_corner * range && (before < inside) == (inside < after);
  if (rounded || !has_station_between(curve, pieces.first, pieces.second)) {  // one corner
    const double at = (before * pieces.first + inside * width - after * pieces.second) / (before - after);
    add_stop(limits, at, before, after);
  } else if (width < 0.5 * range && std::min(before, after) > k_stiffness_ratio * inside) {
    limits.clearance = Clearance{pieces.first, pieces.second, std::max(inside, 0.0) / std::min(before, after)};
  } else {
    add_stop(limits, pieces.first, before, inside);
    add_stop(limits, pieces.second, inside, after);
  }
  return limits;
}

// Stations strictly between low and high, which are one station's width away from a break.
Curve between(const Curve& curve, double low, double high) {
  std::vector<Eigen::Index> inside;
  for (Eigen::Index i = 0; i < curve.x.size(); ++i) {
    if (curve.x(i) > low && curve.x(i) < high) inside.push_back(i);
  }
  return {curve.x(inside), curve.force(inside)};
}

}  // namespace

void find_joint_limits(AxisFit& fit) {
  const auto n = static_cast<Eigen::Index>(fit.backbone.size());
  if (n < k_fewest_stations) return;
  Curve curve{Eigen::VectorXd(n), Eigen::VectorXd(n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    curve.x(i) = fit.backbone[static_cast<std::size_t>(i)].x;
    curve.force(i) = fit.backbone[static_cast<std::size_t>(i)].value;
  }
  Limits limits = strongest(curve);
  const double spacing = curve.x(1) - curve.x(0), low = curve.x(0) - spacing, high = curve.x(n - 1) + spacing;
  if (!limits.stops.empty()) {  // play lies between the stops
    double from = low, to = high;
    for (const HardStop& stop : limits.stops) {
      if (stop.at < 0.5 * (low + high))
        from = stop.at + spacing;
      else
        to = stop.at - spacing;
    }
    limits.clearance = strongest(between(curve, from, to)).clearance;
  }
  if (limits.clearance) {  // stops lie beyond the play, and are placed better without it
    limits.stops.clear();
    for (const Curve& outer : {between(curve, low, limits.clearance->low - spacing),
                               between(curve, limits.clearance->high + spacing, high)}) {
      for (const HardStop& stop : strongest(outer).stops) limits.stops.push_back(stop);
    }
  }
  fit.clearance = limits.clearance;
  fit.hard_stops = std::move(limits.stops);
}

}  // namespace grouser
