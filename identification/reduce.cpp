#include "identification/reduce.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace grouser {
namespace {

constexpr double k_jump = 5.0;  // of the usual time step
constexpr double k_samples_per_cycle = 400.0;
constexpr double k_short_swing = 0.1;  // the record's short swings decide, so that they keep their samples too

std::vector<std::size_t> breaks_of(const Signals& record, const std::vector<std::size_t>& parts,
                                   std::vector<std::size_t>& swings) {
  std::vector<std::size_t> breaks;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const std::size_t begin = parts[p], end = p + 1 < parts.size() ? parts[p + 1] : record.displacement.size();
    const auto turns = turning_points(std::span(record.displacement).subspan(begin, end - begin));
    for (std::size_t k = 0; k < turns.size(); ++k) {
      breaks.push_back(begin + turns[k]);
      if (k > 1 && k + 1 < turns.size()) swings.push_back(turns[k] - turns[k - 1]);  // neither cut by the record
    }
    if (breaks.back() != end - 1) breaks.push_back(end - 1);
  }
  return breaks;
}

class Averager {
 public:
  explicit Averager(const Signals& from)
      : from_{&from.time, &from.displacement, &from.force, &from.temperature},
        to_{&result.time, &result.displacement, &result.force, &result.temperature} {}

  void sample(std::size_t i) {
    each([&](const std::vector<double>& from, std::vector<double>& to) { to.push_back(from[i]); });
  }

  void swing(std::size_t begin, std::size_t end, std::size_t bin) {
    const std::size_t inside = end - begin - 1, bins = (inside + bin / 2) / bin;
    if (bins < 2) {
      if (inside > 0) mean(begin + 1, end);
      return sample(end);
    }
    for (std::size_t k = 0; k + 1 < bins; ++k) mean(begin + 1 + k * bin, begin + 1 + (k + 1) * bin);
    const std::size_t rest = begin + 1 + (bins - 1) * bin;
    mean(rest, end);
    const double width = 0.5 * static_cast<double>(bin + end - rest), ahead = 0.5 * static_cast<double>(end - rest + 1);
    each([&](const std::vector<double>&, std::vector<double>& to) {
      const double last = to.back(), before = to[to.size() - 2];
      to.push_back(last + (last - before) / width * ahead);
    });
  }

  Signals result;

 private:
  void mean(std::size_t begin, std::size_t end) {
    each([&](const std::vector<double>& from, std::vector<double>& to) {
      double sum = 0.0;
      for (std::size_t i = begin; i < end; ++i) sum += from[i];
      to.push_back(sum / static_cast<double>(end - begin));
    });
  }

  template <typename Visit>
  void each(Visit visit) {
    for (std::size_t c = 0; c < from_.size(); ++c) {
      if (!from_[c]->empty()) visit(*from_[c], *to_[c]);
    }
  }

  std::array<const std::vector<double>*, 4> from_;
  std::array<std::vector<double>*, 4> to_;
};

}  // namespace

std::vector<std::size_t> parts_of(const std::vector<double>& time) {
  std::vector<std::size_t> parts{0};
  const double limit = k_jump * median_step(time);
  for (std::size_t i = 1; limit > 0.0 && i < time.size(); ++i) {
    if (time[i] - time[i - 1] > limit || time[i] < time[i - 1]) parts.push_back(i);
  }
  return parts;
}

ReducedRecord reduce(Signals record, std::vector<std::size_t> parts) {
  std::vector<std::size_t> swings;
  const std::vector<std::size_t> breaks = breaks_of(record, parts, swings);
  std::size_t bin = 1;
  if (!swings.empty()) {
    const auto at = swings.begin() + static_cast<std::ptrdiff_t>(k_short_swing * static_cast<double>(swings.size()));
    std::nth_element(swings.begin(), at, swings.end());
    bin = static_cast<std::size_t>(std::lround(2.0 * static_cast<double>(*at) / k_samples_per_cycle));
  }
  if (bin < 2) return {std::move(record), std::move(parts)};
  Averager averager(record);
  auto part = parts.begin();
  for (std::size_t k = 0; k < breaks.size(); ++k) {
    if (part != parts.end() && breaks[k] == *part) {
      *part++ = averager.result.time.size();
      averager.sample(breaks[k]);
    } else {
      averager.swing(breaks[k - 1], breaks[k], bin);
    }
  }
  return {std::move(averager.result), std::move(parts)};
}

}  // namespace grouser
