#include "render/plot_axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace grouser {
namespace {

constexpr const char* k_minus = "\u2212";
constexpr const char* k_thin_space = "\u2009";

std::string power_of_ten(int exponent) {
  return fmt::format("10^{{{}{}}}", exponent < 0 ? k_minus : "", std::abs(exponent));
}

/// Fixed decimals, thousands apart from five digits on.
std::string number_text(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", std::abs(value), decimals);
  const std::size_t whole = std::min(text.find('.'), text.size());
  for (std::size_t i = whole; whole > 4 && i > 3; i -= 3) text.insert(i - 3, k_thin_space);
  const bool zero = text.find_first_not_of("0.") == std::string::npos;
  return (value < 0.0 && !zero ? k_minus : "") + text;
}

/// The step of 1, 2 or 5 times a power of ten nearest to count steps a range.
double nice_step(double range, double count) {
  const double rough = range / std::max(count, 1.0), magnitude = std::pow(10.0, std::floor(std::log10(rough)));
  const double multiple = rough / magnitude;
  return magnitude * (multiple < 1.5 ? 1.0 : multiple < 3.2 ? 2.0 : multiple < 7.1 ? 5.0 : 10.0);
}

Ticks linear_ticks(const PlotAxis& axis, double count) {
  Ticks ticks;
  const double step = nice_step(axis.high - axis.low, count);
  const double largest = std::max(std::abs(axis.low), std::abs(axis.high));
  int exponent = 0;
  if (largest >= 1e5 || largest < 1e-2) {  // powers of a thousand keep the unit readable
    exponent = 3 * static_cast<int>(std::floor(std::log10(largest) / 3.0 + 1e-9));
    ticks.factor = "×" + power_of_ten(exponent);
  }
  const double scale = std::pow(10.0, exponent);
  const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step / scale) + 1e-9)));
  const auto first = static_cast<long>(std::ceil(axis.low / step - 1e-9));
  const auto last = static_cast<long>(std::floor(axis.high / step + 1e-9));
  for (long i = first; i <= last; ++i) {
    const double value = static_cast<double>(i) * step;
    ticks.major.push_back({value, number_text(value / scale, decimals)});
  }
  return ticks;
}

Ticks logarithmic_ticks(const PlotAxis& axis, double count) {
  Ticks ticks;
  const double low = std::log10(axis.low), high = std::log10(axis.high);
  const auto label = [](double value, int exponent) {
    return exponent >= -3 && exponent <= 4 ? number_text(value, std::max(0, -exponent)) : power_of_ten(exponent);
  };
  const int every = std::max(1, static_cast<int>(std::lround((high - low) / std::max(count, 1.0))));
  const bool few = high - low < 1.6;  // too few decades: label 2 and 5 as well
  for (int e = static_cast<int>(std::floor(low)); e <= static_cast<int>(std::ceil(high)); ++e) {
    for (int digit = 1; digit < 10; ++digit) {
      const double value = digit * std::pow(10.0, e);
      if (value < axis.low * (1.0 - 1e-9) || value > axis.high * (1.0 + 1e-9)) continue;
      const bool labelled = (digit == 1 && e % every == 0) || (few && (digit == 2 || digit == 5));
      if (labelled) {
        ticks.major.push_back({value, digit == 1 ? label(value, e) : number_text(value, std::max(0, -e))});
      } else if (every == 1 || digit == 1) {
        ticks.minor.push_back(value);
      }
    }
  }
  return ticks;
}

}  // namespace

double PlotAxis::share(double value) const {
  if (!logarithmic) return (value - low) / (high - low);
  return (std::log10(value) - std::log10(low)) / (std::log10(high) - std::log10(low));
}

void ValueRange::add(double value) {
  if (!std::isfinite(value) || (logarithmic_ && value <= 0.0)) return;
  low_ = any_ ? std::min(low_, value) : value;
  high_ = any_ ? std::max(high_, value) : value;
  any_ = true;
}

PlotAxis ValueRange::axis(double padding, const std::optional<std::array<double, 2>>& wanted) const {
  PlotAxis axis{low_, high_, logarithmic_};
  if (wanted) {
    axis.low = (*wanted)[0];
    axis.high = (*wanted)[1];
  } else if (logarithmic_) {
    if (!any_) return {1.0, 10.0, true};
    // Values that nearly agree stand in the middle, not on the frame.
    const double factor = std::max(std::pow(high_ / low_, padding), high_ > 1.2 * low_ ? 1.0 : 2.0);
    axis.low = low_ / factor;
    axis.high = high_ * factor;
  } else if (any_) {
    const double range = high_ - low_, magnitude = std::max(std::abs(low_), std::abs(high_));
    // All values equal (to round-off): room on both sides instead of a magnified round-off.
    const double pad = range > 1e-9 * magnitude ? padding * range : 0.1 * magnitude;
    if (padding > 0.0 || range <= 1e-9 * magnitude) {
      axis.low = low_ - pad;
      axis.high = high_ + pad;
      if (padding > 0.0 && low_ >= 0.0 && low_ < 0.35 * high_) axis.low = 0.0;
      if (padding > 0.0 && high_ <= 0.0 && high_ > 0.35 * low_) axis.high = 0.0;
    }
  }
  if (!(axis.high > axis.low)) axis.high = axis.low + 1.0;
  return axis;
}

Ticks make_ticks(const PlotAxis& axis, double count) {
  if (!axis.logarithmic) return linear_ticks(axis, count);
  const Ticks ticks = logarithmic_ticks(axis, count);
  // Within one decade the marks 1, 2, 5 may all be missed.
  return ticks.major.size() < 2 ? linear_ticks(axis, count) : ticks;
}

}  // namespace grouser
