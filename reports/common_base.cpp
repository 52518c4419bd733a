#include "reports/common_base.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "reports/number_text.h"

namespace grouser {
namespace {

constexpr double k_gap = 5.0;  // median spacings

/// First sample at or behind t.
std::size_t index_at(const TimeSeries& curve, double t) {
  return static_cast<std::size_t>(std::ranges::lower_bound(curve.time, t) - curve.time.begin());
}

/// Median spacing of the samples in a span; none when there are fewer than two.
std::optional<double> median_spacing(const TimeSeries& curve, const TimeSpan& span) {
  std::vector<double> spacings;
  for (std::size_t i = index_at(curve, span.from) + 1; i < curve.time.size() && curve.time[i] <= span.to; ++i)
    spacings.push_back(curve.time[i] - curve.time[i - 1]);
  if (spacings.empty()) return std::nullopt;
  const auto middle = spacings.begin() + static_cast<std::ptrdiff_t>(spacings.size() / 2);
  std::ranges::nth_element(spacings, middle);
  return *middle;
}

/// Adds the spans between samples that stand too far apart.
void add_gaps(const TimeSeries& curve, const TimeSpan& span, double spacing, std::vector<TimeSpan>& gaps) {
  for (std::size_t i = std::max<std::size_t>(index_at(curve, span.from), 1); i < curve.time.size(); ++i) {
    if (curve.time[i - 1] >= span.to) return;
    if (curve.time[i] - curve.time[i - 1] > k_gap * spacing)
      gaps.push_back({std::max(curve.time[i - 1], span.from), std::min(curve.time[i], span.to)});
  }
}

/// The longest part of a span outside all gaps.
TimeSpan longest_piece(const TimeSpan& span, std::vector<TimeSpan> gaps) {
  std::ranges::sort(gaps, {}, &TimeSpan::from);
  gaps.push_back({span.to, span.to});
  TimeSpan longest{span.from, span.from};
  double begin = span.from;
  for (const TimeSpan& gap : gaps) {
    if (gap.from - begin > longest.to - longest.from) longest = {begin, gap.from};
    begin = std::max(begin, gap.to);
  }
  return longest;
}

/// A curve on straight lines between its samples, and its integral.
class Line {
 public:
  explicit Line(const TimeSeries& curve) : curve_(curve), integral_(curve.time.size(), 0.0) {
    for (std::size_t i = 1; i < integral_.size(); ++i)
      integral_[i] =
          integral_[i - 1] + 0.5 * (curve.time[i] - curve.time[i - 1]) * (curve.value[i] + curve.value[i - 1]);
  }
  [[nodiscard]] double at(double t) const {
    const std::size_t i = piece(t);
    const double share = (t - curve_.time[i]) / (curve_.time[i + 1] - curve_.time[i]);
    return curve_.value[i] + share * (curve_.value[i + 1] - curve_.value[i]);
  }
  /// Over [from, to], as far as there are samples.
  [[nodiscard]] double mean(double from, double to) const {
    from = std::max(from, curve_.time.front());
    to = std::min(to, curve_.time.back());
    return (integral_to(to) - integral_to(from)) / (to - from);
  }

 private:
  [[nodiscard]] std::size_t piece(double t) const {
    const auto after = std::ranges::upper_bound(curve_.time, t) - curve_.time.begin();
    return static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(after - 1, 0, static_cast<std::ptrdiff_t>(curve_.time.size()) - 2));
  }
  [[nodiscard]] double integral_to(double t) const {
    const std::size_t i = piece(t);
    return integral_[i] + 0.5 * (t - curve_.time[i]) * (curve_.value[i] + at(t));
  }
  const TimeSeries& curve_;
  std::vector<double> integral_;
};

std::vector<double> sampled(const TimeSeries& curve, double spacing, double begin, double step, std::size_t count) {
  const Line line(curve);
  const bool average = 2.0 * spacing <= step;
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double t = begin + step * static_cast<double>(i);
    values[i] = average ? line.mean(t - 0.5 * step, t + 0.5 * step) : line.at(t);
  }
  return values;
}

std::string span_text(const TimeSpan& span) {
  return fmt::format("{} to {}", quantity_text(span.from, "s"), quantity_text(span.to, "s"));
}

CommonBase without(const std::string& problem) {
  CommonBase base;
  base.problem = problem;
  return base;
}

}  // namespace

std::vector<double> CommonBase::time() const {
  std::vector<double> instants(reference.size());
  for (std::size_t i = 0; i < instants.size(); ++i) instants[i] = begin + step * static_cast<double>(i);
  return instants;
}

CommonBase common_base(const TimeSeries& reference, const TimeSeries& other, const TimeSpan& window) {
  if (reference.time.size() < 2 || other.time.size() < 2) return without("there are fewer than two samples");
  const TimeSpan covered{std::max({reference.time.front(), other.time.front(), window.from}),
                         std::min({reference.time.back(), other.time.back(), window.to})};
  const std::string own =
      fmt::format("one curve covers {}, the other {}", span_text({reference.time.front(), reference.time.back()}),
                  span_text({other.time.front(), other.time.back()}));
  const std::optional<double> reference_spacing = median_spacing(reference, covered),
                              other_spacing = median_spacing(other, covered);
  if (!(covered.from < covered.to) || !reference_spacing || !other_spacing)
    return without("they share no time in the window: " + own);

  std::vector<TimeSpan> gaps;
  add_gaps(reference, covered, *reference_spacing, gaps);
  add_gaps(other, covered, *other_spacing, gaps);
  const TimeSpan piece = longest_piece(covered, gaps);
  const double length = piece.to - piece.from;
  CommonBase base;
  base.begin = piece.from;
  base.step = std::max({*reference_spacing, *other_spacing, length / static_cast<double>(k_most_instants - 1)});
  constexpr double k_round_off = 1e-9;
  const auto count = static_cast<std::size_t>(length / base.step + k_round_off) + 1;
  if (count < k_fewest_instants) return without(fmt::format("they share only {} samples: {}", count, own));
  if (!gaps.empty())
    base.remark = fmt::format("{} in the samples; rated is the longest piece without one, {}",
                              gaps.size() == 1 ? "a gap" : fmt::format("{} gaps", gaps.size()), span_text(piece));
  base.reference = sampled(reference, *reference_spacing, base.begin, base.step, count);
  base.other = sampled(other, *other_spacing, base.begin, base.step, count);
  return base;
}

}  // namespace grouser
