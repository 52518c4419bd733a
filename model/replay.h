#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "model/fit.h"

namespace grouser {

/// What the virtual rig found (replay.json): every test of a campaign driven on the bushing of a simulation.
struct ReplayRecord {
  std::string specimen;  ///< of the campaign
  std::string bushing;   ///< name of the law that was driven
  /// `fitted` of a test, its cycles and its curve is what the virtual rig read.
  std::vector<TestFit> tests;
  std::vector<FitWarning> warnings;            ///< "outside_valid_range", "rate_unknown", and what made a test unusable
  std::vector<AppliedCorrection> corrections;  ///< of the measurement, before it was driven
  Provenance provenance;                       ///< `synthetic` says which of campaign and bushing are generated
};

/// Reads `grouser.replay/1`; throws InputError with every finding.
[[nodiscard]] ReplayRecord read_replay(const std::filesystem::path& file);
/// Writes whole or not at all.
void write_replay(const ReplayRecord& replay, const std::filesystem::path& file);

}  // namespace grouser
