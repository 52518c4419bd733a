#pragma once
#include <filesystem>

#include "model/progress.h"
#include "model/run.h"
#include "model/scenario.h"

namespace grouser {

/// Assembles, settles and runs a scenario; writes folder/run.h5 while it goes and folder/run.json at the end, also when
/// the run fails or is stopped. Returns the summary that stands in run.json. Throws InputError / NumericalError when
/// assembly is impossible.
[[nodiscard]] RunSummary simulate(const Scenario& scenario, const std::filesystem::path& folder,
                                  const Progress& progress = {});

}  // namespace grouser
