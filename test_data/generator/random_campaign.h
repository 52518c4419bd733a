#pragma once
#include <cstdint>

#include "test_data/generator/campaign.h"

namespace grouser {

/// What a random rubber has that the fitted law has not. A growing yield stands in the law, but only for who chooses
/// it.
enum class OutsideMechanism { none, springpot, growing_yield, both };
inline constexpr int k_num_outside_mechanisms = 4;

/// Which of them rubber number `seed` has: they take turns.
[[nodiscard]] OutsideMechanism outside_mechanism(std::uint64_t seed);

/// A track bushing along x that nobody has seen before (I 2): spring 65 x + 20 x^3 kN (x in mm) with 15 % and 40 %
/// scatter, six stops and four Maxwell branches on grids of their own (stiffness and yield lognormal 30 %, times 50 %).
/// A springpot has 10 kN/mm at 1 Hz (30 %) and order 0.1 to 0.3; a growing yield is 30 to 100 % larger at 1 mm.
[[nodiscard]] TrueRubber random_rubber(std::uint64_t seed);

/// That rubber on the prototype's campaign: 5 amplitudes x 5 frequencies, 10 cycles of 200 samples each, and six ramps
/// at 2 mm/min up to 10 ton; with the prototype's errors of rig and specimen (I 2).
[[nodiscard]] AxisCampaign random_campaign(std::uint64_t seed);

/// Settled response of a rubber to the sine centre + amplitude sin(2 pi frequency t), without any error.
struct SteadyResponse {
  double energy = 0.0;             ///< J a cycle
  double storage_stiffness = 0.0;  ///< of the fundamental, N/m
  double loss_factor = 0.0;        ///< of the fundamental
};
/// Spring and stops are followed in 4000 steps a cycle, branches and springpot by their exact complex stiffness.
[[nodiscard]] SteadyResponse true_steady_response(const TrueRubber& rubber, double amplitude, double frequency,
                                                  double centre = 0.0);

}  // namespace grouser
