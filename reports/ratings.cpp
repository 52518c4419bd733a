#include "reports/ratings.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

namespace grouser {
namespace {

using Curve = std::span<const double>;
using Eigen::VectorXd;

// ISO/TS 18571:2014, its recommended parameters.
constexpr double k_inner_corridor = 0.05, k_outer_corridor = 0.5;  // of max |T|
constexpr double k_largest_shift = 0.2;                            // of the samples
constexpr double k_warping_window = 0.1;                           // of the samples
constexpr double k_worst_magnitude = 0.5, k_worst_slope = 2.0;     // errors that score nothing
constexpr std::size_t k_smoothed = 9;                              // samples

/// A copy in Eigen's own memory: where it sums a curve that lies anywhere, the order, and the last digit, follow the
/// address.
VectorXd vector_of(Curve curve) {
  return Eigen::Map<const VectorXd>(curve.data(), static_cast<Eigen::Index>(curve.size()));
}

double largest(Curve curve) { return vector_of(curve).cwiseAbs().maxCoeff(); }

/// Sums of a curve's first n values and of their squares, for every n.
class RunningSums {
 public:
  explicit RunningSums(const VectorXd& values) : sums_{{0.0, 0.0}} {
    for (const double v : values) sums_.push_back({sums_.back()[0] + v, sums_.back()[1] + v * v});
  }
  [[nodiscard]] double sum(std::size_t from, std::size_t to) const { return sums_[to][0] - sums_[from][0]; }
  [[nodiscard]] double squares(std::size_t from, std::size_t to) const { return sums_[to][1] - sums_[from][1]; }

 private:
  std::vector<std::array<double, 2>> sums_;
};

/// Correlation of parts of two curves, from what does not hang on the pair.
class Correlator {
 public:
  Correlator(Curve a, Curve b) : a_(centred(a)), b_(centred(b)), sums_a_(a_), sums_b_(b_) {}

  /// Of a[from_a, from_a + n) with b[from_b, from_b + n); -1 where one of them is constant.
  [[nodiscard]] double of(std::size_t from_a, std::size_t from_b, std::size_t n) const {
    const auto count = static_cast<double>(n);
    const double sum_a = sums_a_.sum(from_a, from_a + n), sum_b = sums_b_.sum(from_b, from_b + n);
    const double spread_a = sums_a_.squares(from_a, from_a + n) - sum_a * sum_a / count;
    const double spread_b = sums_b_.squares(from_b, from_b + n) - sum_b * sum_b / count;
    constexpr double k_round_off = 1e-14;
    if (spread_a <= k_round_off * a_.squaredNorm() || spread_b <= k_round_off * b_.squaredNorm()) return -1.0;
    const auto length = static_cast<Eigen::Index>(n);
    const double product = a_.segment(static_cast<Eigen::Index>(from_a), length)
                               .dot(b_.segment(static_cast<Eigen::Index>(from_b), length));
    return (product - sum_a * sum_b / count) / std::sqrt(spread_a * spread_b);
  }

 private:
  static VectorXd centred(Curve curve) { return vector_of(curve).array() - vector_of(curve).mean(); }
  VectorXd a_, b_;
  RunningSums sums_a_, sums_b_;
};

/// 1 without error, 0 from `worst` on, on a line between.
double linear_score(double error, double worst) { return std::clamp((worst - error) / worst, 0.0, 1.0); }

/// Derivative but for the factor 1 / step, which cancels in the score, averaged over nine samples; over fewer at the
/// ends, as many as fit on both sides.
VectorXd smoothed_slope(Curve curve) {
  const auto n = static_cast<Eigen::Index>(curve.size());
  VectorXd slope(n), smooth(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index before = std::max<Eigen::Index>(i - 1, 0), after = std::min(i + 1, n - 1);
    slope[i] = (curve[static_cast<std::size_t>(after)] - curve[static_cast<std::size_t>(before)]) /
               static_cast<double>(after - before);
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index half = std::min({i, n - 1 - i, static_cast<Eigen::Index>(k_smoothed / 2)});
    smooth[i] = slope.segment(i - half, 2 * half + 1).mean();
  }
  return smooth;
}

/// What `error` is of `whole`, as a share; nothing of nothing is no error.
double share(double error, double whole) {
  if (whole > 0.0) return error / whole;
  return error > 0.0 ? std::numeric_limits<double>::infinity() : 0.0;
}

double magnitude_score(Curve reference, Curve other) {
  const auto radius = static_cast<std::size_t>(std::ceil(k_warping_window * static_cast<double>(reference.size())));
  double error = 0.0, whole = 0.0;
  for (const auto& [i, j] : warping_path(reference, other, std::max<std::size_t>(radius, 1))) {
    error += std::abs(other[i] - reference[j]);
    whole += std::abs(reference[j]);
  }
  return linear_score(share(error, whole), k_worst_magnitude);
}

IsoRating iso_rating(Curve reference, Curve other) {
  const double most = k_largest_shift * static_cast<double>(reference.size());
  IsoRating rating;
  rating.corridor = corridor_score(reference, other);
  rating.shift = best_shift(reference, other, static_cast<std::size_t>(most));
  rating.phase = linear_score(static_cast<double>(std::abs(rating.shift)), most);
  const auto n = static_cast<std::size_t>(std::abs(rating.shift)), kept = reference.size() - n;
  const Curve shifted_reference = reference.subspan(rating.shift > 0 ? 0 : n, kept);
  const Curve shifted_other = other.subspan(rating.shift > 0 ? n : 0, kept);
  rating.magnitude = magnitude_score(shifted_reference, shifted_other);
  rating.slope = slope_score(shifted_reference, shifted_other);
  return rating;
}

}  // namespace

const char* iso_grade(double overall) {
  return overall > 0.94 ? "excellent" : overall > k_iso_good ? "good" : overall > 0.58 ? "fair" : "poor";
}

double SpragueGeers::combined() const { return std::hypot(magnitude, phase); }

bool is_flat(Curve values) {
  constexpr double k_round_off = 1e-12;
  const auto [low, high] = std::ranges::minmax(values);
  return high - low <= k_round_off * std::max(std::abs(low), std::abs(high));
}

double corridor_score(Curve reference, Curve other) {
  const double norm = largest(reference), inner = k_inner_corridor * norm, outer = k_outer_corridor * norm;
  double sum = 0.0;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    const double distance = std::abs(reference[i] - other[i]);
    if (distance < inner)
      sum += 1.0;
    else if (distance < outer)
      sum += std::pow((outer - distance) / (outer - inner), 2);
  }
  return sum / static_cast<double>(reference.size());
}

std::ptrdiff_t best_shift(Curve reference, Curve other, std::size_t most) {
  const Correlator correlation(reference, other);
  const std::size_t n = reference.size();
  double best = correlation.of(0, 0, n);
  std::ptrdiff_t shift = 0;
  constexpr double k_round_off = 1e-10;  // periodic curves correlate as well one period on
  const auto take = [&](double candidate, std::ptrdiff_t of) {
    if (!(candidate > best + k_round_off)) return;
    best = candidate;
    shift = of;
  };
  for (std::size_t m = 1; m <= most; ++m) {
    take(correlation.of(0, m, n - m), static_cast<std::ptrdiff_t>(m));
    take(correlation.of(m, 0, n - m), -static_cast<std::ptrdiff_t>(m));
  }
  return shift;
}

SpragueGeers sprague_geers(Curve reference, Curve other) {
  const auto t = vector_of(reference), c = vector_of(other);
  const double tt = t.squaredNorm(), cc = c.squaredNorm(), ct = c.dot(t);
  const double cosine = cc > 0.0 ? ct / std::sqrt(cc * tt) : 0.0;
  return {std::sqrt(cc / tt) - 1.0, std::acos(std::clamp(cosine, -1.0, 1.0)) / std::numbers::pi};
}

double slope_score(Curve reference, Curve other) {
  const VectorXd t = smoothed_slope(reference), c = smoothed_slope(other);
  return linear_score(share((c - t).lpNorm<1>(), t.lpNorm<1>()), k_worst_slope);
}

std::vector<std::pair<std::size_t, std::size_t>> warping_path(Curve reference, Curve other, std::size_t radius) {
  enum Came : std::uint8_t { other_alone, reference_alone, both };
  constexpr double k_far = std::numeric_limits<double>::infinity();
  const std::size_t n = reference.size(), width = 2 * radius - 1;
  // Column k of row i is the pair (i, i + k - (radius - 1)): along a row the reference, one row on it moves by one.
  std::vector<double> above(width, k_far), row(width, k_far);
  std::vector<Came> came(n * width, both);
  for (std::size_t i = 0; i < n; ++i) {
    std::ranges::fill(row, k_far);
    for (std::size_t k = i + 1 < radius ? radius - 1 - i : 0; k < width && i + k < n + radius - 1; ++k) {
      const double cost = std::pow(other[i] - reference[i + k + 1 - radius], 2);
      const double from_above = k + 1 < width ? above[k + 1] : k_far;
      const double from_left = k > 0 ? row[k - 1] : k_far;
      double least = from_above;
      Came& from = came[i * width + k] = other_alone;
      if (from_left < least) {
        least = from_left;
        from = reference_alone;
      }
      if (above[k] < least) {
        least = above[k];
        from = both;
      }
      row[k] = cost + (i == 0 && k + 1 == radius ? 0.0 : least);
    }
    std::swap(row, above);
  }
  std::vector<std::pair<std::size_t, std::size_t>> path{{n - 1, n - 1}};
  while (path.back().first > 0 || path.back().second > 0) {
    auto [i, j] = path.back();
    const Came from = came[i * width + j + radius - 1 - i];
    if (from != reference_alone) --i;
    if (from != other_alone) --j;
    path.emplace_back(i, j);
  }
  std::ranges::reverse(path);
  return path;
}

Ratings rate(Curve reference, Curve other, double step) {
  Ratings ratings;
  const auto t = vector_of(reference), c = vector_of(other);
  ratings.rmse = std::sqrt((c - t).squaredNorm() / static_cast<double>(reference.size()));
  if (const double peak = largest(reference); peak > 0.0) {
    ratings.peak_ratio = largest(other) / peak;
    ratings.sprague_geers = sprague_geers(reference, other);
  }
  if (is_flat(reference)) return ratings;
  ratings.nrmse = ratings.rmse / (t.maxCoeff() - t.minCoeff());
  if (is_flat(other)) return ratings;
  ratings.correlation = Correlator(reference, other).of(0, 0, reference.size());
  ratings.iso = iso_rating(reference, other);
  ratings.lag = static_cast<double>(ratings.iso->shift) * step;
  return ratings;
}

}  // namespace grouser
