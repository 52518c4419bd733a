#pragma once
#include <cstdint>
#include <map>
#include <string>

#include "test_data/generator/campaign.h"

namespace grouser {

/// Name and bytes of every file of the reference campaign: rig.json, truth.json and one CSV a test. Translations are
/// written as a rig records them, in volts of two LVDTs and a load cell with their calibration records; torsion in
/// degrees and N m.
[[nodiscard]] std::map<std::string, std::string> campaign_files(std::uint64_t seed = k_campaign_seed);

}  // namespace grouser
