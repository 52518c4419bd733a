#pragma once
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

/// How alike two curves over time are, by the measures that validation engineers use. Both are sampled at the same
/// instants, evenly spaced; `reference` T is what the other, C, is held against. N: number of samples.
namespace grouser {

/// Overall rating of ISO/TS 18571:2014, R = 0.4 Z + 0.2 E_P + 0.2 E_M + 0.2 E_S, each between 0 (unlike) and 1 (alike).
///
/// Corridor Z: mean over the samples of 1 inside |T - C| < 0.05 T_norm, 0 outside 0.5 T_norm, and
///   ((0.5 T_norm - |T - C|) / (0.45 T_norm))^2 between, with T_norm = max |T|.
/// Phase E_P = (0.2 N - n) / (0.2 N): n is the shift of up to 0.2 N samples, either way, under which the parts of both
///   curves that overlap correlate best; the smallest of several that are equally good.
/// Magnitude E_M = (0.5 - e) / 0.5, not below 0: e = sum |C - T| / sum |T| along the warping path of least cost between
///   the shifted curves, see warping_path.
/// Slope E_S = (2 - e) / 2, not below 0: e = sum |C' - T'| / sum |T'| over the derivatives of the shifted curves
///   (central differences), each averaged over nine samples.
///
/// Made for signals of a crash at 10 kHz: what nine samples span depends on how the curves are sampled.
struct IsoRating {
  double corridor = 0.0, phase = 0.0, magnitude = 0.0, slope = 0.0;
  std::ptrdiff_t shift = 0;  ///< n with its sign: > 0 where C comes later than T
  [[nodiscard]] double overall() const { return 0.4 * corridor + 0.2 * phase + 0.2 * magnitude + 0.2 * slope; }
};

/// Of ISO/TS 18571: "excellent" above 0.94, "good" above 0.80, "fair" above 0.58, else "poor".
[[nodiscard]] const char* iso_grade(double overall);
inline constexpr double k_iso_good = 0.80;

/// Sprague and Geers (2003), with the integrals of both curves over the window: M = sqrt(CC / TT) - 1,
/// P = acos(CT / sqrt(CC TT)) / pi, combined = sqrt(M^2 + P^2).
struct SpragueGeers {
  double magnitude = 0.0, phase = 0.0;
  [[nodiscard]] double combined() const;
};

/// All measures of one pair. Empty where a measure is not defined: no shape can be told of a curve that does not
/// change.
struct Ratings {
  std::optional<IsoRating> iso;
  std::optional<SpragueGeers> sprague_geers;
  double rmse = 0.0;                  ///< sqrt(mean (C - T)^2), in the unit of the curves
  std::optional<double> nrmse;        ///< rmse over max T - min T
  std::optional<double> correlation;  ///< Pearson's, unshifted
  std::optional<double> peak_ratio;   ///< max |C| / max |T|
  std::optional<double> lag;          ///< s: the shift of the ISO rating; > 0 where C comes later
};

/// Fewest samples that can be rated: what the slope averages over.
inline constexpr std::size_t k_fewest_rated = 9;

/// Of curves of one length, at least k_fewest_rated, `step` seconds from sample to sample.
[[nodiscard]] Ratings rate(std::span<const double> reference, std::span<const double> other, double step);

// The parts, each on its own.

/// True where max - min is no more than round-off of the largest value.
[[nodiscard]] bool is_flat(std::span<const double> values);
[[nodiscard]] double corridor_score(std::span<const double> reference, std::span<const double> other);
/// Shift of best correlation, > 0 where `other` comes later; at most `most` samples either way.
[[nodiscard]] std::ptrdiff_t best_shift(std::span<const double> reference, std::span<const double> other,
                                        std::size_t most);
[[nodiscard]] SpragueGeers sprague_geers(std::span<const double> reference, std::span<const double> other);
[[nodiscard]] double slope_score(std::span<const double> reference, std::span<const double> other);

/// Dynamic time warping (Sakoe and Chiba 1978): pairs (index of `other`, of `reference`) from (0, 0) to both ends, each
/// step raising one index or both, within |i - j| < radius, of least sum of (other_i - reference_j)^2. Of equally cheap
/// steps the one that raises `other` alone, then `reference` alone, then both.
[[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> warping_path(std::span<const double> reference,
                                                                            std::span<const double> other,
                                                                            std::size_t radius);

}  // namespace grouser
