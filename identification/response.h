#pragma once
#include <vector>

#include "model/bushing.h"

namespace grouser {

/// Settled response of a law to the sine centre + amplitude sin(2 pi frequency t): first harmonic of the force.
struct HarmonicResponse {
  double storage_stiffness = 0.0;  ///< K', in phase, N/m or N m/rad
  double loss_stiffness = 0.0;     ///< K'', in quadrature; energy a cycle = pi K'' amplitude^2, exact for a sine
};

/// Spring and stops of a law followed along one settled sine; they do not know the frequency.
[[nodiscard]] HarmonicResponse rate_independent_response(const AxisLaw& law, double amplitude, double centre);

/// Branches and damper at one frequency [Hz], by their complex stiffness; they do not know the amplitude.
[[nodiscard]] HarmonicResponse viscoelastic_response(const AxisLaw& law, double frequency);

/// Mean of the loading and the unloading force of a law on a settled triangle between low and high, `period` seconds a
/// cycle, at num_intervals + 1 equal stations. The force is 0 at displacement 0 of the law's spring.
[[nodiscard]] std::vector<double> backbone_of(const AxisLaw& law, double low, double high, double period,
                                              int num_intervals);

}  // namespace grouser
