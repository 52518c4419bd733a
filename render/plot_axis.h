#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

namespace grouser {

/// Values to a share 0..1 of an axis.
struct PlotAxis {
  double low = 0.0, high = 1.0;
  bool logarithmic = false;
  /// Outside 0..1 for values outside; NaN where a logarithm does not exist.
  [[nodiscard]] double share(double value) const;
};

/// Smallest and largest finite value met; of a logarithmic axis, positive value.
class ValueRange {
 public:
  explicit ValueRange(bool logarithmic) : logarithmic_(logarithmic) {}
  void add(double value);
  /// An axis that shows all values with `padding` (share of the range) at both ends; down to 0 when all values are on
  /// one side and 0 is near. `wanted` replaces it.
  [[nodiscard]] PlotAxis axis(double padding, const std::optional<std::array<double, 2>>& wanted) const;

 private:
  bool logarithmic_;
  bool any_ = false;
  double low_ = 0.0, high_ = 0.0;
};

struct Tick {
  double value = 0.0;
  std::string label;
};
struct Ticks {
  std::vector<Tick> major;
  std::vector<double> minor;  ///< of a logarithmic axis
  std::string factor;         ///< "×10^{−6}" that all labels share; may be empty
};

/// At most about `count` ticks at 1, 2 or 5 times a power of ten (logarithmic: at decades), labels with a true minus
/// sign.
[[nodiscard]] Ticks make_ticks(const PlotAxis& axis, double count);

}  // namespace grouser
