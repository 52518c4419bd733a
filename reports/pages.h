#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "model/fit.h"
#include "model/replay.h"
#include "model/run.h"
#include "reports/common_base.h"
#include "reports/input_differences.h"
#include "reports/rating_limits.h"

/// The facts of a page, ready for its template and for its machine-readable twin: every number stands as `text` in the
/// form that the page shows, beside its `value` in SI. Keys with k_payload_prefix hold base64 and only go to the page.
namespace grouser {

/// WebP quality of rendered pictures in pages.
inline constexpr int k_photograph_quality = 88;

/// A fit folder opened for a report.
struct FitFolder {
  std::filesystem::path path;
  FitRecord fit;
  Bushing bushing;
};
/// Reads DIR/fit.json and DIR/bushing.json. Throws InputError / FileError.
[[nodiscard]] FitFolder open_fit(const std::filesystem::path& folder);

/// A folder of the virtual rig opened for a report.
struct RigFolder {
  std::filesystem::path path;
  ReplayRecord replay;
};

/// `id` prefixes every element id of this part, so that several parts share a page; `level` is the level of its own
/// heading.
[[nodiscard]] nlohmann::json run_facts(const RunFolder& run, const std::string& id, int level);
[[nodiscard]] nlohmann::json fit_facts(const FitFolder& folder, const std::string& id, int level);
[[nodiscard]] nlohmann::json rig_facts(const RigFolder& folder, const std::string& id, int level);
/// {pass, partial, text}: whether the simulator's bushing agrees with the measurement; `partial`: not with all tests.
[[nodiscard]] nlohmann::json rig_verdict(const ReplayRecord& replay);
[[nodiscard]] nlohmann::json rig_headline(const ReplayRecord& replay);
/// {pass, partial, text}: whether the fit reached what it must, in one sentence; `partial`: it did, but not with all
/// tests.
[[nodiscard]] nlohmann::json fit_verdict(const FitRecord& fit);
/// The few numbers of a fit that a reader looks for first.
[[nodiscard]] nlohmann::json fit_headline(const FitRecord& fit);
/// Warnings of one code together, with what to do about them, in the order in which the codes first appear.
[[nodiscard]] nlohmann::json warning_facts(const std::vector<FitWarning>& warnings);
[[nodiscard]] nlohmann::json correction_facts(const std::vector<AppliedCorrection>& corrections);
/// {pass, partial, text} of a run; `partial` is always false.
[[nodiscard]] nlohmann::json run_verdict(const RunSummary& summary);
/// The few numbers of a run that a reader looks for first.
[[nodiscard]] nlohmann::json run_headline(const RunSummary& summary);
/// The one number in which at least three runs differ, each having its own; none when they differ in another way.
[[nodiscard]] std::optional<InputDifference> study_parameter(const std::vector<RunFolder>& runs);
/// What follows that number, which `runs` rise with: two sentences, small multiples and a table.
[[nodiscard]] nlohmann::json study_facts(const std::vector<RunFolder>& runs, const InputDifference& parameter,
                                         const std::string& id, int level);
/// How the channels of runs are held against those of the first one.
struct ComparisonOptions {
  TimeSpan window = k_all_time;
  RatingLimits limits;
};
/// Several runs side by side: the inputs in which they differ, every result with its difference from the first run, the
/// checks of all, how like the first run's channels theirs are, and overlaid figures.
[[nodiscard]] nlohmann::json comparison_facts(const std::vector<RunFolder>& runs, const ComparisonOptions& options,
                                              const std::string& id, int level);

/// {title, findings[], paper} on what the rubber of one bushing carries, of two runs of which one has single and the
/// other double pins; else false.
[[nodiscard]] nlohmann::json connection_facts(const std::vector<RunFolder>& runs);

/// Several fits side by side, axis by axis: overlaid responses with their bands, and a table of the differences from
/// the first fit against the intervals of both.
[[nodiscard]] nlohmann::json fit_comparison_facts(const std::vector<FitFolder>& fits, const std::string& id, int level);

/// Inputs with hashes, options, version and the commands that repeat the result.
[[nodiscard]] nlohmann::json provenance_facts(const Provenance& provenance, const std::vector<std::string>& commands);

/// Moving picture of a run for the page's 3D player: {frames_text, payload_*}; false when the run holds no poses.
[[nodiscard]] nlohmann::json playback_facts(const RunFolder& run);

/// {value, text} of a value in SI.
[[nodiscard]] nlohmann::json quantity_facts(double value, const std::string& unit, int digits = 4);
/// Columns in which so many headline tiles stand well: the last row is nearly full.
[[nodiscard]] int tile_columns(std::size_t num_tiles);
/// {label, value, text} of one line of a table or one headline tile.
[[nodiscard]] nlohmann::json labelled_quantity(const std::string& label, double value, const std::string& unit,
                                               int digits = 4);

}  // namespace grouser
