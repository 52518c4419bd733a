#pragma once
#include "model/bushing.h"
#include "tests/support/mock_run.h"

namespace grouser::mock {

inline constexpr int k_num_links = 76;
inline constexpr int k_num_stations = 6;

/// inputs/scenario.json, vehicle.json and bushing.json of a mock run.
void write_inputs(const std::filesystem::path& folder, const RunOptions& options);
/// A bushing with a straight spring on every axis.
[[nodiscard]] Bushing straight_bushing();

}  // namespace grouser::mock
