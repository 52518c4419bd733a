#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "reports/measurement.h"
#include "reports/rating_block.h"
#include "reports/report.h"

/// The page of a run held against a measurement.
namespace grouser {

/// Every measured channel against the run's.
[[nodiscard]] std::vector<RatedChannel> rate_against(const RunFolder& run, const Measurement& measurement,
                                                     const ReportOptions& options);
/// Facts of the template "against": verdict and ratings first, then overlays, cross plots, the channels with their
/// signs and frames, and how to repeat it.
[[nodiscard]] nlohmann::json against_facts(const RunFolder& run, const Measurement& measurement,
                                           const std::vector<RatedChannel>& rated, const RatingLimits& limits,
                                           const ReportOptions& options, const std::string& id, int level);

}  // namespace grouser
