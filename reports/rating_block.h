#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "render/figure.h"
#include "reports/common_base.h"
#include "reports/rating_limits.h"
#include "reports/ratings.h"
#include "reports/run_channels.h"

/// Rated curves as parts of a page, for measurements and for runs held against a first one.
namespace grouser {

/// Two curves of one channel and what was found.
struct RatedChannel {
  std::string name, unit, meaning;
  TimeSeries reference, other;  ///< in SI, as they were given
  CommonBase base;
  Ratings ratings;      ///< of `base`; meaningless where it has a problem
  std::string unrated;  ///< why nothing can be judged; empty when something can
};
[[nodiscard]] RatedChannel rate_channel(const RunChannel& channel, TimeSeries reference, TimeSeries other,
                                        const TimeSpan& window);

/// "Sprocket torque left" of "probes_sprocket_torque_left".
[[nodiscard]] std::string channel_label(const std::string& name);

/// True where every measure that has a limit is defined and meets it.
[[nodiscard]] bool meets_limits(const RatedChannel& rated, const RatingLimits& limits);
/// "pass"; "fails ISO rating, Correlation"; why it cannot be rated.
[[nodiscard]] std::string rating_verdict(const RatedChannel& rated, const RatingLimits& limits);

/// {heads[] {key, label, limit}, rows[] {label, name, cells[], parts[], rated, pass, verdict, window, points},
/// sources[]} for the template "ratings". `judged`: the cells are marked by their limits, as of a measurement; two runs
/// that differ are no failure.
[[nodiscard]] nlohmann::json ratings_facts(const std::vector<RatedChannel>& rated, const RatingLimits& limits,
                                           bool judged);

/// All curves of one channel, and the difference of each other one from the reference, which they share, on its common
/// base. `others` names them, in the order of `rated`; the curves are drawn as far as `shown` goes.
[[nodiscard]] Figure overlay_figure(const std::vector<const RatedChannel*>& rated, const std::string& reference,
                                    const std::vector<std::string>& others, const TimeSpan& shown = k_all_time);
/// What was rated, and a tenth more on either side; everything where nothing was.
[[nodiscard]] TimeSpan rated_span(const RatedChannel& rated);
/// Both curves over a few instants round their largest difference; none where they are short enough to be seen whole.
[[nodiscard]] std::optional<Figure> close_figure(const RatedChannel& rated, const std::string& reference,
                                                 const std::string& other);
/// Every pair of samples, the second curve over the first, for each channel that has a common base.
[[nodiscard]] Figure cross_figure(const std::vector<RatedChannel>& rated, const std::string& reference,
                                  const std::string& other);

}  // namespace grouser
