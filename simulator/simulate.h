#pragma once
#include <filesystem>

#include "model/progress.h"
#include "model/run.h"
#include "model/scenario.h"

namespace grouser {

/// Assembles, settles and runs a scenario; writes folder/run.h5 and folder/checkpoint while it goes and folder/run.json
/// at the end, also when the run fails or is stopped. Returns the summary that stands in run.json. Throws InputError /
/// NumericalError when assembly is impossible.
[[nodiscard]] RunSummary simulate(const Scenario& scenario, const std::filesystem::path& folder,
                                  const Progress& progress = {});

/// Goes on with the run of a folder, from its last checkpoint, to the bytes of a run that was never stopped (wall times
/// apart); one that was killed before its first checkpoint begins anew. Throws InputError with the reason when it
/// cannot: no checkpoint, a damaged one, one of another program or other inputs, a run that came to its end.
[[nodiscard]] RunSummary resume(const Scenario& scenario, const std::filesystem::path& folder,
                                const Progress& progress = {});

}  // namespace grouser
