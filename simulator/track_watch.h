#pragma once
#include <array>
#include <optional>
#include <string>

#include "simulator/workspace.h"

/// Looks at the whole track now and then: tension of the upper run, thrown track, skipped teeth. Detects, never
/// prevents.
namespace grouser {

/// Mean, least and greatest tension [N] of the joints between sprocket and idler above their axles (P 2: "rest tension"
/// is this mean).
struct SpanTension {
  double mean = 0.0, low = 0.0, high = 0.0;
  int joints = 0;
};
[[nodiscard]] SpanTension upper_run_tension(const System& system, const State& state, const Workspace& work, Side side);

/// Links passed at the sprocket less teeth passed, since watching began [teeth]: a jump shows as a change by one (P 4).
class ToothCounter {
 public:
  ToothCounter(const System& system, const State& state, Side side);
  void update(const System& system, const State& state);
  [[nodiscard]] double skipped() const { return links_ - teeth_; }
  /// Its memory, for a checkpoint.
  template <typename Archive>
  void archive(Archive& a) {
    a(last_index_, links_, teeth_, start_angle_);
  }

 private:
  [[nodiscard]] std::optional<double> pin_index(const System& system, const State& state) const;
  Side side_;
  double last_index_ = 0.0, links_ = 0.0, teeth_ = 0.0, start_angle_ = 0.0;
};

/// A link further than this from the middle of a wheel it meets has left the guide for good (P 4: crossed 1.7 s before
/// the blow-up).
inline constexpr double k_thrown_offset = 0.1;  // m

}  // namespace grouser
