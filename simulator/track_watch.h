#pragma once
#include <array>
#include <optional>
#include <string>

#include "simulator/step.h"

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

/// Ditto of the joints that hang free between the sprocket and the road wheel next to it. This span goes slack when a
/// sprocket at the rear brakes, or one in front drives; pins climb the teeth where it does (P 4).
[[nodiscard]] SpanTension sprocket_span_tension(const System& system, const State& state, const Workspace& work,
                                                Side side);

/// Links passed at the sprocket less teeth passed, since watching began [teeth]: a jump shows as a change by one (P 4).
class ToothCounter {
 public:
  ToothCounter(const System& system, const State& state, Side side);
  void update(const System& system, const State& state);
  [[nodiscard]] double skipped() const { return links_ - teeth_; }
  [[nodiscard]] double teeth() const { return teeth_; }
  /// Link (array index) whose pin stood outermost on the sprocket when last seen.
  [[nodiscard]] int link(const System& system) const;
  /// Its memory, for a checkpoint.
  template <typename Archive>
  void archive(Archive& a) {
    a(seen_, last_index_, links_, teeth_, start_angle_);
  }

 private:
  [[nodiscard]] std::optional<double> pin_index(const System& system, const State& state) const;
  Side side_;
  bool seen_ = false;  ///< a pin was in reach since the start
  double last_index_ = 0.0, links_ = 0.0, teeth_ = 0.0, start_angle_ = 0.0;
};

/// A link further than this from the middle of a wheel it meets has left the guide for good (P 4: crossed 1.7 s before
/// the blow-up).
inline constexpr double k_thrown_offset = 0.1;  // m

/// Pins seat within a sixth of a pitch of their gaps, driving or braking; further than this one has passed a tooth's
/// tip and seats in the next gap.
inline constexpr double k_skipped_tooth = 0.75;

/// When the span at the sprocket first carried nothing, and by how much the idler had given way.
struct SlackSpan {
  double time = -1.0;      ///< s; < 0: it never did
  double given_way = 0.0;  ///< m, the way round the running gear is shorter by this than at rest
};

/// The last time that it carried nothing: from here on, until the sprocket had turned by half its teeth without. What
/// stands on the sprocket ran up while it lasted.
struct SlackSpell {
  SlackSpan begun;
  double last_teeth = 0.0;  ///< turned by the sprocket, when it was last seen slack
};

/// Ends a run whose track leaves its guide or skips a tooth, and remembers what led to it.
class TrackWatch {
 public:
  TrackWatch(const System& system, const State& rest);

  /// One accepted step. Returns time, side, link and likely cause when a track is thrown or has skipped a tooth.
  [[nodiscard]] std::optional<std::string> update(const Stepper& stepper);
  [[nodiscard]] double skipped_teeth(Side side) const { return at(side).counter.skipped(); }
  [[nodiscard]] const SlackSpan& slack(Side side) const { return at(side).slack; }

  /// Its memory, for a checkpoint.
  template <typename Archive>
  void archive(Archive& a) {
    a(steps_);
    for (OneTrack& track : tracks_) a(track.counter, track.slack, track.spell);
  }

 private:
  struct OneTrack {
    ToothCounter counter;
    double length_at_rest = 0.0;  ///< m, of the way round the running gear with the idler where it stood
    SlackSpan slack;              ///< the first
    SlackSpell spell;
  };
  [[nodiscard]] const OneTrack& at(Side side) const { return tracks_[static_cast<std::size_t>(index_of(side))]; }
  void note_slack(const Stepper& stepper, Side side);
  /// The last spell was half a turn of the sprocket ago at most.
  [[nodiscard]] bool lately_slack(Side side) const;
  [[nodiscard]] std::string slack_story(Side side) const;
  [[nodiscard]] std::string thrown(const Stepper& stepper, Side side) const;
  [[nodiscard]] std::string skipped(const Stepper& stepper, Side side) const;

  const System& system_;
  std::array<OneTrack, k_num_sides> tracks_;
  long steps_ = 0;
};

}  // namespace grouser
