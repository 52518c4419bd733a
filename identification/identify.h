#pragma once
#include "model/bushing.h"
#include "model/fit.h"
#include "model/progress.h"
#include "model/rig.h"

namespace grouser {

struct IdentifyOptions {
  int threads = 1;  ///< axes are fitted side by side
};

struct IdentifyResult {
  Bushing bushing;
  FitRecord fit;
  std::vector<Bushing> draws;  ///< whole physical bushings, as likely as the fitted one in the light of the data
};

/// Fits one axis law per tested axis to all its tests together (DESIGN 5). Axes without a test get no law and a
/// warning. Throws NumericalError when a fit does not reach optimality, InputError when the data cannot be used at all.
[[nodiscard]] IdentifyResult identify(const RigRecord& rig, const IdentifyOptions& options = {},
                                      const Progress& progress = {});

}  // namespace grouser
