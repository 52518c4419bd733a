#pragma once
#include "model/rig.h"

namespace grouser {

/// Writes a campaign of one bushing as `grouser.rig/1`: folder/rig.json and folder/<RigTest::file> for every test, in
/// SI, each number in its shortest form that reads back the same. Of a test it keeps name, axis, kind, preset,
/// discarded cycles and, where `time_measured`, the times; without them its rate is unknown. `bushings_in_series` is 1,
/// and there is no compliance, no sensor and no correction: displacement and force are those of the bushing itself.
void write_rig(const RigRecord& rig, const std::filesystem::path& folder);

}  // namespace grouser
