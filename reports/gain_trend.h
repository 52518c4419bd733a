#pragma once
#include <optional>
#include <vector>

#include "model/fit.h"

namespace grouser {

/// A slope and the half width of its 95 % interval.
struct Trend {
  double per_decade = 0.0, half_width = 0.0;  ///< fraction of the force a decade of frequency or amplitude
  [[nodiscard]] bool is_real() const { return per_decade > half_width || per_decade < -half_width; }
};

/// Gain residuals of the cyclic tests regressed on log10 of frequency and of amplitude together, by least squares with
/// Student's t. A trend over frequency = a missing Maxwell branch, over amplitude = a missing stop (I 5.10). Absent
/// where the tests do not vary the quantity, or leave fewer than three degrees of freedom.
struct GainTrends {
  std::optional<Trend> frequency, amplitude;
};
[[nodiscard]] GainTrends gain_trends(const std::vector<const TestFit*>& tests);

}  // namespace grouser
