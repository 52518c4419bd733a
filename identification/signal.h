#pragma once
#include <cstddef>
#include <span>
#include <vector>

namespace grouser {

/// Standard deviation of white noise on a smooth signal, from the median of its third differences (I 4); any unit.
[[nodiscard]] double noise_level(std::span<const double> signal);

/// Median of |x[i] - x[i - 1]|.
[[nodiscard]] double median_step(std::span<const double> signal);

/// Width of the band that holds the central 99 % of the samples.
[[nodiscard]] double central_range(std::span<const double> signal);

/// Zero-phase Savitzky-Golay smoothing with a cubic over `window` samples (odd; < 5 returns the signal). The ends and
/// the samples `kept` (ascending) stay as they are, and no window reaches across one.
[[nodiscard]] std::vector<double> smooth(const std::vector<double>& signal, int window,
                                         const std::vector<std::size_t>& kept = {});

/// Indices of the turning points, first and last sample included; swings below `hysteresis` are noise.
[[nodiscard]] std::vector<std::size_t> reversals(std::span<const double> signal, double hysteresis);

/// Reversals of a displacement record; swings below 2 % of the range or 8 sigma of its noise are none (I 4).
[[nodiscard]] std::vector<std::size_t> turning_points(std::span<const double> displacement);

/// Samples begin..end (both included) form one closed turn; `end` is the begin of the next.
struct CycleSpan {
  std::size_t begin = 0, end = 0;
};

/// Closed cycles of a displacement record (I 4). A record that starts at one of its extremes is cut at these extremes
/// (ramps); any other where it rises through the middle of its own swing, which survives drift, preload and amplitude
/// steps.
[[nodiscard]] std::vector<CycleSpan> find_cycles(std::span<const double> displacement);

/// offset + drift t + amplitude sin(2 pi frequency t + phase), by Gauss-Newton from a first guess of the frequency.
struct SineFit {
  double frequency = 0.0;  ///< Hz
  double amplitude = 0.0;
  double relative_residual = 0.0;  ///< rms residual over rms sine
};
[[nodiscard]] SineFit fit_sine(const std::vector<double>& time, const std::vector<double>& signal, CycleSpan range,
                               double first_frequency);

}  // namespace grouser
