#pragma once
#include <limits>
#include <string>
#include <vector>

/// Two curves over time, each with its own sampling, brought to the same instants.
namespace grouser {

/// A curve over rising times [s].
struct TimeSeries {
  std::vector<double> time, value;
};

/// The part of the run's clock to look at [s].
struct TimeSpan {
  double from, to;
};
inline constexpr TimeSpan k_all_time{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};

/// Both curves at begin, begin + step, ...
struct CommonBase {
  double begin = 0.0, step = 0.0;  ///< s
  std::vector<double> reference, other;
  std::string remark;   ///< what of the window was left out, and why; may be empty
  std::string problem;  ///< why there is no common base; then there are no samples

  [[nodiscard]] std::vector<double> time() const;
  [[nodiscard]] double end() const { return begin + step * static_cast<double>(reference.size() - 1); }
};

/// Fewest instants of a common base, and most: a rating costs their square.
inline constexpr std::size_t k_fewest_instants = 20, k_most_instants = 8000;

/// Over what both curves and `window` cover. A spacing of more than five times the median one is a gap: nothing is
/// known inside, so the longest piece without one is taken. The instants are as far apart as the samples of the curve
/// that is sampled less often (median spacing), further only where there would be more than k_most_instants. A curve
/// with two samples or more from instant to instant is averaged between the middles of neighbouring instants, so that
/// what the instants cannot show does not come out as something else; other curves are interpolated on straight lines.
[[nodiscard]] CommonBase common_base(const TimeSeries& reference, const TimeSeries& other, const TimeSpan& window);

}  // namespace grouser
